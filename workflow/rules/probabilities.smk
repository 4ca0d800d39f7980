"""Probabilities of events: calibrated and scored, with alarms chosen without the test series."""

from burstcast_workflow.alarms import alarm_records

# What tables of probabilities read, beside what is their own.
PROBABILITIES = (
    "random_seed bootstrap classification.prediction_times_lt classification.window_lt "
    "classification.resolution_lt"
)


def probability_rows(*paths):
    """Whose files tables of probabilities are made from, and who raises alarms."""
    return {
        "rows": campaign.keys(campaign.forecasters),
        "cases": campaign.of_each_case("case.event_threshold", *paths),
        "alarms": alarm_records(campaign, campaign.case_names),
    }


@of_job
def calibration_forecasts(wildcards):
    """Forecasts of the calibration set by all forecasters of a case."""
    return of_forecasters("calibration_forecast.nc", campaign.select(case=wildcards.case))


rule calibration_set:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        time_unit=time_unit,
    output:
        calibration_set=f"{CASE}/calibration_set.nc",
    log:
        f"{LOGS}/calibration_set/{{case}}.log",
    benchmark:
        f"{TIMES}/calibration_set/{{case}}.tsv"
    group:
        "case"
    conda:
        ENVIRONMENT
    resources:
        **needs("data"),
    params:
        **reads(
            "probabilities/calibration_set.py",
            "SYSTEM TIME OBSERVED WINDOWS washout_lt case.test_series "
            "probability.calibration_series probability.start_spacing_lt",
        ),
    message:
        "{wildcards.case}: starting points of the calibration"
    script:
        "../scripts/probabilities/calibration_set.py"


rule calibration_forecast:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        forecaster=f"{FORECASTER}/forecaster.nc",
        calibration_set=f"{CASE}/calibration_set.nc",
        time_unit=time_unit,
    output:
        forecast=f"{FORECASTER}/calibration_forecast.nc",
    log:
        f"{LOGS}/calibration_forecast/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/calibration_forecast/{{case}}/{{forecaster}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("leave_one_out", cached=True),
    params:
        **reads(
            "probabilities/calibration_forecast.py",
            "FORECASTER OBSERVED WINDOWS washout_lt probability.calibration_series",
        ),
    message:
        "{wildcards.case}, {wildcards.forecaster}: forecast the calibration set out of sample"
    script:
        "../scripts/probabilities/calibration_forecast.py"


rule calibrate:
    input:
        calibration_set=f"{CASE}/calibration_set.nc",
        forecasts=calibration_forecasts,
        time_unit=time_unit,
    output:
        calibration=f"{CASE}/calibration.json",
    log:
        f"{LOGS}/calibrate/{{case}}.log",
    benchmark:
        f"{TIMES}/calibrate/{{case}}.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        settings=settings_of_calibration,
        code=code_of_calibration,
    message:
        "{wildcards.case}: calibrate the probabilities, choose the thresholds of alarms"
    script:
        "../scripts/probabilities/calibrate.py"

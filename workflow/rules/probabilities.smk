"""Probabilities of events: calibrated and scored, with alarms chosen without the test series."""


def who_votes(case, by_members=None):
    """Forecasters that vote in the committees of a case that are shown: all, or of one sort."""
    return [
        one
        for alarm in shown_committees(campaign, case)
        if by_members in (None, alarm.by_members)
        for one in alarm.members
    ]


stage(
    "data/calibration_set",
    "starting points of the calibration",
    inputs=files("ensemble time_unit"),
    outputs={"calibration_set": f"{CASE}/calibration_set.nc"},
    settings="SYSTEM TIME OBSERVED WINDOWS washout_lt case.test_series "
    "probability.calibration_series probability.start_spacing_lt",
    cost="data",
)
stage(
    "evaluation/calibration_forecast",
    "forecast the calibration set out of sample",
    inputs=files("ensemble forecaster calibration_set time_unit"),
    outputs={"calibration_forecast": f"{FORECASTER}/calibration_forecast.nc"},
    settings="FORECASTER forecaster.divergence_bound OBSERVED WINDOWS washout_lt "
    "probability.calibration_series",
    cost="leave_one_out",
    cached=True,
)
stage(
    "evaluation/calibration_member_forecast",
    "forecast the calibration set out of sample with all members",
    inputs=files("ensemble forecaster calibration_set time_unit"),
    outputs={
        "calibration_member_forecast": f"{FORECASTER}/calibration_member_forecast.nc"
    },
    settings="FORECASTER OBSERVED WINDOWS washout_lt probability.calibration_series",
    cost="leave_one_out",
    cached=True,
)
stage(
    "probabilities/calibrate",
    "calibrate the probabilities, choose the thresholds of alarms",
    inputs={
        "calibration_forecasts": files_in_case("calibration_forecast.nc"),
        "calibration_member_forecasts": files_in_case(
            "calibration_member_forecast.nc", campaign.ensemble_forecasters
        ),
        **files("calibration_set time_unit"),
    },
    outputs={"calibration": f"{CASE}/calibration.json"},
    settings="TIME case.event_threshold classification.prediction_times_lt "
    "classification.window_lt classification.resolution_lt "
    "probability.prior_forecasts probability.threshold_factors",
    rows=in_case(campaign.forecasters, campaign.keys),
    ensemble_rows=in_case(campaign.ensemble_forecasters, campaign.keys),
    alarms=alarms_of_case,
)

stage(
    # of those who are shown: members of the example's ensemble, and of other ensembles
    "probabilities/committee_event",
    "an event as committees see it",
    inputs={
        **files("ensemble evaluation_set calibration time_unit"),
        "forecasters": of_job(
            lambda wildcards: of_forecasters("forecaster.nc", who_votes(wildcards.case))
        ),
        "forecasts": of_job(
            lambda wildcards: of_forecasters(
                "forecast.nc", who_votes(wildcards.case, by_members=False)
            )
        ),
        "member_forecasts": of_job(
            lambda wildcards: of_forecasters(
                "member_forecast.nc", who_votes(wildcards.case, by_members=True)
            )
        ),
    },
    outputs={"committee_event": f"{CASE}/committee_event.nc"},
    settings="SYSTEM TIME WINDOWS case.event_threshold case.training.series "
    "classification.prediction_times_lt",
    cost="gather",
    committees=of_job(
        lambda wildcards: records_of(
            campaign, shown_committees(campaign, wildcards["case"])
        )
    ),
    rows=of_job(
        lambda wildcards: campaign.keys(who_votes(wildcards["case"], by_members=False))
    ),
    ensemble_rows=of_job(
        lambda wildcards: campaign.keys(who_votes(wildcards["case"], by_members=True))
    ),
    who=of_job(
        lambda wildcards: [
            {
                "identity": one.identity,
                "by_members": one in who_votes(wildcards["case"], by_members=True),
                "settings": campaign.settings(["forecaster.options"], one.identity, {}),
            }
            for one in who_votes(wildcards["case"])
        ]
    ),
)

# What tables of probabilities are made from.
PROBABILITIES = {
    "forecasts": files_in_case("forecast.nc"),
    "member_forecasts": files_in_case(
        "member_forecast.nc", campaign.ensemble_forecasters
    ),
    **files("evaluation_set calibration"),
}
ALARMS = {
    "rows": in_case(campaign.forecasters, campaign.keys),
    "ensemble_rows": in_case(campaign.ensemble_forecasters, campaign.keys),
    "alarms": alarms_of_case,
}

stage(
    "probabilities/probability_scores",
    "score the probabilities",
    inputs=PROBABILITIES,
    outputs={
        "table": f"{TABLES_OF_CASE}/probability_scores.csv",
        "differences": f"{TABLES_OF_CASE}/probability_differences.csv",
    },
    settings="SCORED case.event_threshold probability.bins",
    cost="bootstrap",
    **ALARMS,
)
stage(
    "probabilities/probability_diagrams",
    "reliability, economic value, curves over all thresholds",
    inputs=PROBABILITIES,
    outputs={
        "reliability": f"{TABLES_OF_CASE}/reliability.csv",
        "value": f"{TABLES_OF_CASE}/economic_value.csv",
        "curves": f"{TABLES_OF_CASE}/alarm_curves.csv",
    },
    settings="SCORED case.event_threshold probability.bins probability.cost_loss_ratios",
    cost="bootstrap",
    **ALARMS,
)
stage(
    "probabilities/lead_times",
    "how early events were warned of",
    inputs={**files("ensemble"), **PROBABILITIES},
    outputs={"table": f"{TABLES_OF_CASE}/lead_times.csv"},
    settings="SCORED case.event_threshold case.training.series "
    "classification.start_spacing_lt",
    cost="bootstrap",
    **ALARMS,
)
stage(
    "probabilities/threshold_sweep",
    "score alarms for other event thresholds",
    inputs=PROBABILITIES,
    outputs={"table": f"{TABLES_OF_CASE}/threshold_sweep.csv"},
    settings="SCORED case.event_threshold probability.bins probability.threshold_factors",
    cost="bootstrap",
    **ALARMS,
)

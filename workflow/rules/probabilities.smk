"""Probabilities of events: calibrated and scored, with alarms chosen without the test series."""

from functools import partial

from burstcast_workflow.alarms import (
    alarm_records,
    committee_records,
    shown_voters,
    voter_records,
)

# Who raises alarms, and whose forecasts they are made of.
ALARMS = {
    "rows": in_case(campaign.forecasters, campaign.keys),
    "ensemble_rows": in_case(campaign.ensemble_forecasters, campaign.keys),
    "alarms": of_case(alarm_records),
}

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
    **ALARMS,
)
stage(
    # of those who are shown: members of the example's ensemble, and of other ensembles
    "probabilities/committee_event",
    "an event as committees see it",
    inputs={
        **files("ensemble evaluation_set calibration time_unit"),
        "forecasters": files_in_case("forecaster.nc", shown_voters),
        "forecasts": files_in_case(
            "forecast.nc", partial(shown_voters, by_members=False)
        ),
        "member_forecasts": files_in_case(
            "member_forecast.nc", partial(shown_voters, by_members=True)
        ),
    },
    outputs={"committee_event": f"{CASE}/committee_event.nc"},
    settings="SYSTEM TIME WINDOWS case.event_threshold case.training.series "
    "classification.prediction_times_lt",
    cost="gather",
    committees=of_case(committee_records),
    rows=of_case(partial(voter_records, by_members=False)),
    ensemble_rows=of_case(partial(voter_records, by_members=True)),
)

# What tables of probabilities are made from.
PROBABILITIES = {
    "forecasts": files_in_case("forecast.nc"),
    "member_forecasts": files_in_case(
        "member_forecast.nc", campaign.ensemble_forecasters
    ),
    **files("evaluation_set calibration"),
}

table_stage(
    "probabilities/probability_scores",
    "score the probabilities",
    inputs=PROBABILITIES,
    settings="SCORED case.event_threshold probability.bins",
    cost="bootstrap",
    **ALARMS,
)
table_stage(
    "probabilities/probability_diagrams",
    "reliability, economic value, curves over all thresholds",
    inputs=PROBABILITIES,
    settings="SCORED case.event_threshold probability.bins probability.cost_loss_ratios",
    cost="bootstrap",
    **ALARMS,
)
table_stage(
    "probabilities/lead_times",
    "how early events were warned of",
    inputs={**files("ensemble"), **PROBABILITIES},
    settings="SCORED case.event_threshold case.training.series "
    "classification.start_spacing_lt",
    cost="bootstrap",
    **ALARMS,
)
table_stage(
    "probabilities/threshold_sweep",
    "score alarms for other event thresholds",
    inputs=PROBABILITIES,
    settings="SCORED case.event_threshold probability.bins probability.threshold_factors",
    cost="bootstrap",
    **ALARMS,
)

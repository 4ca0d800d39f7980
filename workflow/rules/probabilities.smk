"""Probabilities of events: calibrated and scored, with alarms chosen without the test series."""

stage(
    "data/calibration_set",
    "starting points of the calibration",
    inputs=files("ensemble"),
    outputs={"calibration_set": f"{CASE}/calibration_set.nc"},
    settings="SYSTEM TIME OBSERVED WINDOWS washout_lt case.test_series "
    "probability.calibration_series probability.start_spacing_lt",
    cost="data",
)
stage(
    "evaluation/calibration_forecast",
    "forecast the calibration set out of sample",
    inputs=files("ensemble forecaster calibration_set scheduled"),
    outputs={"calibration_forecast": f"{FORECASTER}/calibration_forecast.nc"},
    settings="FORECASTER forecaster.divergence_bound OBSERVED WINDOWS washout_lt "
    "probability.calibration_series",
    cost="leave_one_out",
    cached=True,
    constraints={"forecaster": f"{NO_CLASSIFIER}[^/]+"},
)
stage(
    "data/training_set",
    "starting points that classifiers learn from",
    inputs=files("ensemble"),
    outputs={"training_set": f"{CASE}/training_set.nc"},
    settings="SYSTEM TIME OBSERVED WINDOWS washout_lt forecasters.classifiers.start_spacing_lt",
    cost="data",
)
stage(
    "evaluation/event_probabilities",
    "train a classifier, probabilities of events",
    inputs=files("training_set evaluation_set calibration_set"),
    outputs={
        "forecaster": f"{FORECASTER}/forecaster.nc",
        "forecast": f"{FORECASTER}/forecast.nc",
        "calibration_forecast": f"{FORECASTER}/calibration_forecast.nc",
    },
    settings="FORECASTER random_seed case.event_threshold classification.prediction_times_lt "
    "classification.window_lt classification.resolution_lt probability.calibration_series "
    "forecasters.classifiers.folds",
    cost="classifiers",
    cached=True,
    constraints={"forecaster": CLASSIFIERS},
)
stage(
    "probabilities/calibrate",
    "calibrate the probabilities, choose the thresholds of alarms",
    inputs={
        "calibration_forecasts": files_in_case(
            "calibration_forecast.nc", campaign.fitted_forecasters
        ),
        **files("calibration_set"),
    },
    outputs={"calibration": f"{CASE}/calibration.json"},
    settings="TIME case.event_threshold classification.prediction_times_lt "
    "classification.window_lt classification.resolution_lt "
    "probability.prior_forecasts",
    uncalibrated=of_case(Campaign.alarm_thresholds),
)
# What tables of probabilities are made from.
PROBABILITIES = {
    "forecasts": files_in_case("forecast.nc"),
    **files("evaluation_set calibration"),
}

table_stage(
    "probability_scores",
    "score the probabilities",
    inputs=PROBABILITIES,
    settings="KEYS SCORED case.event_threshold probability.bins",
    cost="bootstrap",
)
table_stage(
    "probability_diagrams",
    "reliability, curves over all thresholds",
    inputs=PROBABILITIES,
    settings="KEYS SCORED case.event_threshold probability.bins",
    cost="bootstrap",
)
table_stage(
    "ranking_table",
    "rank the starting points of flows that are encoded",
    inputs=PROBABILITIES,
    settings="KEYS SCORED SYSTEM case.event_threshold",
    cost="bootstrap",
)
table_stage(
    "lead_times",
    "how early events were warned of",
    inputs={**files("ensemble"), **PROBABILITIES},
    settings="KEYS SCORED case.event_threshold case.training.series "
    "classification.start_spacing_lt",
    cost="bootstrap",
)

"""Probabilities of events: calibrated and scored, with alarms chosen without the test series."""

from burstcast.base.declared import gathered


rule calibration_set:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
    output:
        calibration_set="<results>/{case}/calibration_set.nc",
    log:
        "<logs>/calibration_set/{case}.log",
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.parameters",
            "case.system",
            "case.test_series",
            "case.training.noise",
            "case.training.series",
            "classification.longest_prediction_time_lt",
            "classification.resolution_lt",
            "classification.window_lt",
            "probability.calibration_series",
            "probability.start_spacing_lt",
            "random_seed",
            "washout_lt",
        ),
    script:
        "../scripts/data/calibration_set.py"


rule calibration_forecast:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
        calibration_set="<results>/{case}/calibration_set.nc",
        scheduled=stages.scheduled,
    output:
        calibration_forecast="<results>/{case}/{family}/{forecaster}/calibration_forecast.nc",
    log:
        "<logs>/calibration_forecast/{case}/{family}/{forecaster}.log",
    group:
        "forecaster"
    resources:
        **resources_of("training"),
    params:
        settings=settings(
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.parameters",
            "case.system",
            "case.training.noise",
            "case.training.series",
            "classification.longest_prediction_time_lt",
            "classification.resolution_lt",
            "classification.window_lt",
            "forecaster.divergence_bound",
            "forecaster.options",
            "forecaster.source",
            "probability.calibration_series",
            "random_seed",
            "washout_lt",
        ),
    script:
        "../scripts/evaluation/calibration_forecast.py"


rule consistency:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
        calibration_set="<results>/{case}/calibration_set.nc",
        evaluation_set="<results>/{case}/evaluation_set.nc",
    output:
        consistency="<results>/{case}/{family}/{forecaster}/consistency.nc",
    log:
        "<logs>/consistency/{case}/{family}/{forecaster}.log",
    group:
        "forecaster"
    resources:
        **resources_of("training"),
    params:
        settings=settings(
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.parameters",
            "case.system",
            "case.training.noise",
            "case.training.series",
            "forecaster.divergence_bound",
            "forecaster.options",
            "forecaster.source",
            "probability.calibration_series",
            "random_seed",
        ),
    script:
        "../scripts/evaluation/consistency.py"


rule training_set:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
    output:
        training_set="<results>/{case}/training_set.nc",
    log:
        "<logs>/training_set/{case}.log",
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.parameters",
            "case.system",
            "case.training.noise",
            "case.training.series",
            "classification.longest_prediction_time_lt",
            "classification.resolution_lt",
            "classification.window_lt",
            "forecasters.classifiers.start_spacing_lt",
            "random_seed",
            "washout_lt",
        ),
    script:
        "../scripts/data/training_set.py"


rule event_probabilities:
    input:
        time_unit="<results>/{case}/time_unit.json",
        event_threshold="<results>/{case}/event_threshold.json",
        training_set="<results>/{case}/training_set.nc",
        evaluation_set="<results>/{case}/evaluation_set.nc",
        calibration_set="<results>/{case}/calibration_set.nc",
    output:
        forecaster="<results>/{case}/classifiers/{forecaster}/forecaster.nc",
        forecast="<results>/{case}/classifiers/{forecaster}/forecast.nc",
        calibration_forecast="<results>/{case}/classifiers/{forecaster}/calibration_forecast.nc",
    log:
        "<logs>/event_probabilities/{case}/{forecaster}.log",
    wildcard_constraints:
        forecaster=MODEL,
    group:
        "forecaster"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.parameters",
            "case.system",
            "classification.prediction_times_lt",
            "classification.resolution_lt",
            "classification.window_lt",
            "forecaster.divergence_bound",
            "forecaster.options",
            "forecaster.source",
            "probability.calibration_series",
            "random_seed",
        ),
    script:
        "../scripts/evaluation/event_probabilities.py"


rule calibrate:
    input:
        event_threshold="<results>/{case}/event_threshold.json",
        time_unit="<results>/{case}/time_unit.json",
        calibration_forecasts=stages.declared(
            gathered("forecasters/calibration_forecast.nc")
        ),
        calibration_set="<results>/{case}/calibration_set.nc",
    output:
        calibration="<results>/{case}/calibration.json",
    log:
        "<logs>/calibrate/{case}.log",
    group:
        "tables"
    resources:
        **resources_of("short"),
    params:
        settings=settings(
            "classification.prediction_times_lt",
            "classification.resolution_lt",
            "classification.window_lt",
            "probability.prior_forecasts",
        ),
    script:
        "../scripts/probabilities/calibrate.py"

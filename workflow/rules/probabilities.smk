"""Probabilities of events: calibrated and scored, with alarms chosen without the test series."""

from burstcast.base.declared import gathered


rule calibration_set:
    input:
        **computed_settings_files("calibration_set"),
        ensemble="<results>/{case}/ensemble.nc",
    output:
        calibration_set="<results>/{case}/calibration_set.nc",
    log:
        "<logs>/calibration_set/{case}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/calibration_set.py"),
    script:
        "../scripts/data/calibration_set.py"


rule calibration_forecast:
    input:
        **computed_settings_files("calibration_forecast"),
        ensemble="<results>/{case}/ensemble.nc",
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
        calibration_set="<results>/{case}/calibration_set.nc",
        scheduled=stages.scheduled,
    output:
        calibration_forecast="<results>/{case}/{family}/{forecaster}/calibration_forecast.nc",
    log:
        "<logs>/calibration_forecast/{case}/{family}/{forecaster}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("training"),
    params:
        *of_script("evaluation/calibration_forecast.py"),
    script:
        "../scripts/evaluation/calibration_forecast.py"


rule training_set:
    input:
        **computed_settings_files("training_set"),
        ensemble="<results>/{case}/ensemble.nc",
    output:
        training_set="<results>/{case}/training_set.nc",
    log:
        "<logs>/training_set/{case}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/training_set.py"),
    script:
        "../scripts/data/training_set.py"


rule event_probabilities:
    input:
        **computed_settings_files("event_probabilities"),
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
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("evaluation/event_probabilities.py"),
    script:
        "../scripts/evaluation/event_probabilities.py"


rule calibrate:
    input:
        **computed_settings_files("calibrate"),
        calibration_forecasts=stages.declared(
            gathered("forecasters/calibration_forecast.nc")
        ),
        calibration_set="<results>/{case}/calibration_set.nc",
    output:
        calibration="<results>/{case}/calibration.json",
    log:
        "<logs>/calibrate/{case}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("short"),
    params:
        *of_script("probabilities/calibrate.py"),
    script:
        "../scripts/probabilities/calibrate.py"

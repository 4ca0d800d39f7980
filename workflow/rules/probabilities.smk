"""Probabilities of events: calibrated and scored, with alarms chosen without the test series."""


rule calibration_set:
    input:
        **unknowns_of("calibration_set"),
        ensemble=f"{CASE}/ensemble.nc",
    output:
        calibration_set=f"{CASE}/calibration_set.nc",
    log:
        f"{LOGS}/calibration_set/{{case}}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/calibration_set.py"),
    script:
        "../scripts/data/calibration_set.py"


rule calibration_forecast:
    input:
        **unknowns_of("calibration_forecast"),
        ensemble=f"{CASE}/ensemble.nc",
        forecaster=f"{FORECASTER}/forecaster.nc",
        calibration_set=f"{CASE}/calibration_set.nc",
        scheduled=stages.scheduled,
    output:
        calibration_forecast=f"{FORECASTER}/calibration_forecast.nc",
    log:
        f"{LOGS}/calibration_forecast/{{case}}/{{forecaster}}.log",
    wildcard_constraints:
        forecaster=f"{NO_CLASSIFIER}[^/]+",
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
        **unknowns_of("training_set"),
        ensemble=f"{CASE}/ensemble.nc",
    output:
        training_set=f"{CASE}/training_set.nc",
    log:
        f"{LOGS}/training_set/{{case}}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/training_set.py"),
    script:
        "../scripts/data/training_set.py"


rule event_probabilities:
    input:
        **unknowns_of("event_probabilities"),
        training_set=f"{CASE}/training_set.nc",
        evaluation_set=f"{CASE}/evaluation_set.nc",
        calibration_set=f"{CASE}/calibration_set.nc",
    output:
        forecaster=f"{FORECASTER}/forecaster.nc",
        forecast=f"{FORECASTER}/forecast.nc",
        calibration_forecast=f"{FORECASTER}/calibration_forecast.nc",
    log:
        f"{LOGS}/event_probabilities/{{case}}/{{forecaster}}.log",
    wildcard_constraints:
        forecaster=CLASSIFIERS,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("evaluation/event_probabilities.py"),
    script:
        "../scripts/evaluation/event_probabilities.py"


rule calibrate:
    input:
        **unknowns_of("calibrate"),
        calibration_forecasts=files_in_case("calibration_forecast.nc"),
        calibration_set=f"{CASE}/calibration_set.nc",
    output:
        calibration=f"{CASE}/calibration.json",
    log:
        f"{LOGS}/calibrate/{{case}}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("short"),
    params:
        *of_script("probabilities/calibrate.py"),
    script:
        "../scripts/probabilities/calibrate.py"

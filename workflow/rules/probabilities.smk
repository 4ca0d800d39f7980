"""Probabilities of events: calibrated and scored, with alarms chosen without the test series."""


rule calibration_set:
    input:
        **unknowns_of("calibration_set"),
        ensemble=f"{CASE}/ensemble.nc",
    output:
        calibration_set=f"{CASE}/calibration_set.nc",
    log:
        f"{LOGS}/calibration_set/{{case}}.log",
    benchmark:
        f"{TIMES}/calibration_set/{{case}}.tsv"
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("calibration_set", "data"),
    params:
        settings=settings_of("data/calibration_set.py"),
        code=code_of("data/calibration_set.py"),
    message:
        "{wildcards.case}: starting points of the calibration"
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
    benchmark:
        f"{TIMES}/calibration_forecast/{{case}}/{{forecaster}}.tsv"
    wildcard_constraints:
        forecaster=f"{NO_CLASSIFIER}[^/]+",
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("calibration_forecast", "leave_one_out", cached=True),
    params:
        settings=settings_of("evaluation/calibration_forecast.py"),
        code=code_of("evaluation/calibration_forecast.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: forecast the calibration set out of sample"
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
    benchmark:
        f"{TIMES}/training_set/{{case}}.tsv"
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("training_set", "data"),
    params:
        settings=settings_of("data/training_set.py"),
        code=code_of("data/training_set.py"),
    message:
        "{wildcards.case}: starting points that classifiers learn from"
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
    benchmark:
        f"{TIMES}/event_probabilities/{{case}}/{{forecaster}}.tsv"
    wildcard_constraints:
        forecaster=CLASSIFIERS,
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("event_probabilities", "classifiers", cached=True),
    params:
        settings=settings_of("evaluation/event_probabilities.py"),
        code=code_of("evaluation/event_probabilities.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: train a classifier, probabilities of events"
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
    benchmark:
        f"{TIMES}/calibrate/{{case}}.tsv"
    group:
        group_of("tables")
    conda:
        ENVIRONMENT
    resources:
        **needs("calibrate", "gather"),
    params:
        settings=settings_of("probabilities/calibrate.py"),
        code=code_of("probabilities/calibrate.py"),
    message:
        "{wildcards.case}: calibrate the probabilities, choose the thresholds of alarms"
    script:
        "../scripts/probabilities/calibrate.py"

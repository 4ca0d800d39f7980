"""Time-accurate prediction: forecasts of the evaluation set, prediction horizons of events."""


rule forecast:
    input:
        **unknowns_of("forecast"),
        forecaster=f"{FORECASTER}/forecaster.nc",
        evaluation_set=f"{CASE}/evaluation_set.nc",
    output:
        forecast=f"{FORECASTER}/forecast.nc",
    log:
        f"{LOGS}/forecast/{{case}}/{{forecaster}}.log",
    wildcard_constraints:
        forecaster=f"{NO_CLASSIFIER}[^/]+",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("evaluation/forecast.py"),
    script:
        "../scripts/evaluation/forecast.py"


rule horizon:
    input:
        **unknowns_of("horizon"),
        forecaster=f"{FORECASTER}/forecaster.nc",
        events=f"{CASE}/events.nc",
        summary=f"{CASE}/dataset.json",
    output:
        horizon=f"{FORECASTER}/horizon.nc",
    log:
        f"{LOGS}/horizon/{{case}}/{{forecaster}}.log",
    wildcard_constraints:
        forecaster=f"{NO_CLASSIFIER}[^/]+",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("evaluation/horizon.py"),
    script:
        "../scripts/evaluation/horizon.py"


rule long_term:
    input:
        **unknowns_of("long_term"),
        ensemble=f"{CASE}/ensemble.nc",
        forecaster=f"{FORECASTER}/forecaster.nc",
    output:
        long_term=f"{FORECASTER}/long_term.nc",
    log:
        f"{LOGS}/long_term/{{case}}/{{forecaster}}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("evaluation/long_term.py"),
    script:
        "../scripts/evaluation/long_term.py"


rule lyapunov_spectrum:
    input:
        **unknowns_of("lyapunov_spectrum"),
        ensemble=f"{CASE}/ensemble.nc",
        forecaster=f"{FORECASTER}/forecaster.nc",
        long_term=f"{FORECASTER}/long_term.nc",
    output:
        spectrum=f"{FORECASTER}/lyapunov_spectrum.nc",
    log:
        f"{LOGS}/lyapunov_spectrum/{{case}}/{{forecaster}}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("evaluation/lyapunov_spectrum.py"),
    script:
        "../scripts/evaluation/lyapunov_spectrum.py"


rule examples:
    input:
        **unknowns_of("examples"),
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        evaluation_set=f"{CASE}/evaluation_set.nc",
        events=f"{CASE}/events.nc",
        forecaster=f"{FORECASTER}/forecaster.nc",
        forecast=f"{FORECASTER}/forecast.nc",
        horizon=f"{FORECASTER}/horizon.nc",
    output:
        examples=f"{FORECASTER}/examples.nc",
    log:
        f"{LOGS}/examples/{{case}}/{{forecaster}}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("evaluation/examples.py"),
    script:
        "../scripts/evaluation/examples.py"


rule flow_event:
    input:
        **unknowns_of("flow_event"),
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        forecaster=f"{FORECASTER}/forecaster.nc",
    output:
        event=f"{FORECASTER}/flow_event.nc",
    log:
        f"{LOGS}/flow_event/{{case}}/{{forecaster}}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("evaluation/flow_event.py"),
    script:
        "../scripts/evaluation/flow_event.py"

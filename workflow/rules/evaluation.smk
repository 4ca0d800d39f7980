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
    benchmark:
        f"{TIMES}/forecast/{{case}}/{{forecaster}}.tsv"
    wildcard_constraints:
        forecaster=f"{NO_CLASSIFIER}[^/]+",
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("forecast", "forecast", cached=True),
    params:
        settings=settings_of("evaluation/forecast.py"),
        code=code_of("evaluation/forecast.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: forecast the evaluation set"
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
    benchmark:
        f"{TIMES}/horizon/{{case}}/{{forecaster}}.tsv"
    wildcard_constraints:
        forecaster=f"{NO_CLASSIFIER}[^/]+",
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("horizon", "horizon", cached=True),
    params:
        settings=settings_of("evaluation/horizon.py"),
        code=code_of("evaluation/horizon.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: prediction horizons"
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
    benchmark:
        f"{TIMES}/long_term/{{case}}/{{forecaster}}.tsv"
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("long_term", "long_term", cached=True),
    params:
        settings=settings_of("evaluation/long_term.py"),
        code=code_of("evaluation/long_term.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: long-term runs"
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
    benchmark:
        f"{TIMES}/lyapunov_spectrum/{{case}}/{{forecaster}}.tsv"
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("lyapunov_spectrum", "spectrum", cached=True),
    params:
        settings=settings_of("evaluation/lyapunov_spectrum.py"),
        code=code_of("evaluation/lyapunov_spectrum.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: Lyapunov exponents of its own flow"
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
    benchmark:
        f"{TIMES}/examples/{{case}}/{{forecaster}}.tsv"
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("examples", "examples"),
    params:
        settings=settings_of("evaluation/examples.py"),
        code=code_of("evaluation/examples.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: example forecasts"
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
    benchmark:
        f"{TIMES}/flow_event/{{case}}/{{forecaster}}.tsv"
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("flow_event", "examples"),
    params:
        settings=settings_of("evaluation/flow_event.py"),
        code=code_of("evaluation/flow_event.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: an event whose flow is worth seeing"
    script:
        "../scripts/evaluation/flow_event.py"

"""What forecasters are judged by: forecasts, prediction horizons, long runs, their exponents."""


rule forecast:
    input:
        **computed_settings_files("forecast"),
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
        evaluation_set="<results>/{case}/evaluation_set.nc",
    output:
        forecast="<results>/{case}/{family}/{forecaster}/forecast.nc",
    log:
        "<logs>/forecast/{case}/{family}/{forecaster}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("evaluation/forecast.py"),
    script:
        "../scripts/evaluation/forecast.py"


rule horizon:
    input:
        **computed_settings_files("horizon"),
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
        events="<results>/{case}/events.nc",
        summary="<results>/{case}/dataset.json",
    output:
        horizon="<results>/{case}/{family}/{forecaster}/horizon.nc",
    log:
        "<logs>/horizon/{case}/{family}/{forecaster}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("evaluation/horizon.py"),
    script:
        "../scripts/evaluation/horizon.py"


rule long_term:
    input:
        **computed_settings_files("long_term"),
        ensemble="<results>/{case}/ensemble.nc",
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
    output:
        long_term="<results>/{case}/{family}/{forecaster}/long_term.nc",
    log:
        "<logs>/long_term/{case}/{family}/{forecaster}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("evaluation/long_term.py"),
    script:
        "../scripts/evaluation/long_term.py"


rule lyapunov_spectrum:
    input:
        **computed_settings_files("lyapunov_spectrum"),
        ensemble="<results>/{case}/ensemble.nc",
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
        long_term="<results>/{case}/{family}/{forecaster}/long_term.nc",
    output:
        spectrum="<results>/{case}/{family}/{forecaster}/lyapunov_spectrum.nc",
    log:
        "<logs>/lyapunov_spectrum/{case}/{family}/{forecaster}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("evaluation/lyapunov_spectrum.py"),
    script:
        "../scripts/evaluation/lyapunov_spectrum.py"


rule examples:
    input:
        **computed_settings_files("examples"),
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
        evaluation_set="<results>/{case}/evaluation_set.nc",
        events="<results>/{case}/events.nc",
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
        forecast="<results>/{case}/{family}/{forecaster}/forecast.nc",
        horizon="<results>/{case}/{family}/{forecaster}/horizon.nc",
    output:
        examples="<results>/{case}/{family}/{forecaster}/examples.nc",
    log:
        "<logs>/examples/{case}/{family}/{forecaster}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("evaluation/examples.py"),
    script:
        "../scripts/evaluation/examples.py"


rule flow_event:
    input:
        **computed_settings_files("flow_event"),
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
        forecaster="<results>/{case}/{family}/{forecaster}/forecaster.nc",
    output:
        event="<results>/{case}/{family}/{forecaster}/flow_event.nc",
    log:
        "<logs>/flow_event/{case}/{family}/{forecaster}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("evaluation/flow_event.py"),
    script:
        "../scripts/evaluation/flow_event.py"

"""Control of extreme events by all controllers: forecasters, committees, none, and at random."""


rule control:
    input:
        **computed_settings_files("control"),
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
        forecasters=stages.controlling,
        encoder=stages.encoder_of_observed,
        matched=stages.matched_flows,
    output:
        flows="<results>/{case}/control/{controller}/{strategy}/flows.nc",
    log:
        "<logs>/control/{case}/{controller}/{strategy}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("control/control.py"),
    script:
        "../scripts/control/control.py"


rule long_control:
    input:
        **computed_settings_files("long_control"),
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
        forecasters=stages.controlling,
        encoder=stages.encoder_of_observed,
    output:
        counts="<results>/{case}/control/{controller}/{strategy}/long_run.nc",
    log:
        "<logs>/long_control/{case}/{controller}/{strategy}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("long"),
    params:
        *of_script("control/long_control.py"),
    script:
        "../scripts/control/long_control.py"


rule suppressed_event:
    input:
        **computed_settings_files("suppressed_event"),
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
        forecasters=stages.controlling,
    output:
        event="<results>/{case}/control/{controller}/{strategy}/suppressed_event.nc",
    log:
        "<logs>/suppressed_event/{case}/{controller}/{strategy}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("control/suppressed_event.py"),
    script:
        "../scripts/control/suppressed_event.py"

"""Control of extreme events by all controllers: forecasters, committees, none, and at random."""

CONTROL = f"{CASE}/control/{{controller}}/{{strategy}}"


rule control:
    input:
        **unknowns_of("control"),
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        forecasters=stages.controlling,
        encoder=stages.encoder_of_observed,
        matched=stages.matched_flows,
    output:
        flows=f"{CONTROL}/flows.nc",
    log:
        f"{LOGS}/control/{{case}}/{{controller}}/{{strategy}}.log",
    benchmark:
        f"{TIMES}/control/{{case}}/{{controller}}/{{strategy}}.tsv"
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("control", "control", cached=True),
    params:
        settings=settings_of("control/control.py"),
        code=code_of("control/control.py"),
    message:
        "{wildcards.case}, {wildcards.controller}, {wildcards.strategy}: control"
    script:
        "../scripts/control/control.py"


rule suppressed_event:
    input:
        **unknowns_of("suppressed_event"),
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        forecasters=stages.controlling,
    output:
        event=f"{CONTROL}/suppressed_event.nc",
    log:
        f"{LOGS}/suppressed_event/{{case}}/{{controller}}/{{strategy}}.log",
    benchmark:
        f"{TIMES}/suppressed_event/{{case}}/{{controller}}/{{strategy}}.tsv"
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("suppressed_event", "control"),
    params:
        settings=settings_of("control/suppressed_event.py"),
        code=code_of("control/suppressed_event.py"),
    message:
        "{wildcards.case}, {wildcards.controller}, {wildcards.strategy}: a suppressed event"
    script:
        "../scripts/control/suppressed_event.py"

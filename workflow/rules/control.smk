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
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("control/control.py"),
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
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("control/suppressed_event.py"),
    script:
        "../scripts/control/suppressed_event.py"

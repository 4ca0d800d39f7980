"""Control of extreme events, by any forecaster and by alarms at random."""


rule control:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        time_unit=time_unit,
        forecaster=f"{FORECASTER}/forecaster.nc",
    output:
        counts=f"{FORECASTER}/control_PT{{prediction_time_lt}}.json",
        histograms=f"{FORECASTER}/control_PT{{prediction_time_lt}}.nc",
    log:
        f"{LOGS}/control/{{case}}/{{forecaster}}-PT{{prediction_time_lt}}.log",
    benchmark:
        f"{TIMES}/control/{{case}}/{{forecaster}}-PT{{prediction_time_lt}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("control", cached=True),
    params:
        **reads(
            "control/control.py",
            "CONTROL OBSERVED case.controlled_density forecaster.options",
        ),
    message:
        "{wildcards.case}, {wildcards.forecaster}: control, prediction time {wildcards.prediction_time_lt} LT"
    script:
        "../scripts/control/control.py"


rule control_random:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        time_unit=time_unit,
        rate=f"{FORECASTER}/control_PT{{prediction_time_lt}}.json",
    output:
        counts=f"{FORECASTER}/control_random_PT{{prediction_time_lt}}.json",
        histograms=f"{FORECASTER}/control_random_PT{{prediction_time_lt}}.nc",
    log:
        f"{LOGS}/control_random/{{case}}/{{forecaster}}-PT{{prediction_time_lt}}.log",
    benchmark:
        f"{TIMES}/control_random/{{case}}/{{forecaster}}-PT{{prediction_time_lt}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("integration", cached=True),
    params:
        **reads("control/control_random.py", "CONTROL case.controlled_density"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: random actuation, prediction time {wildcards.prediction_time_lt} LT"
    script:
        "../scripts/control/control_random.py"


rule suppressed_event:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        time_unit=time_unit,
        forecaster=f"{FORECASTER}/forecaster.nc",
    output:
        event=f"{FORECASTER}/suppressed_event_PT{{prediction_time_lt}}.nc",
    log:
        f"{LOGS}/suppressed_event/{{case}}/{{forecaster}}-PT{{prediction_time_lt}}.log",
    benchmark:
        f"{TIMES}/suppressed_event/{{case}}/{{forecaster}}-PT{{prediction_time_lt}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("control"),
    params:
        **reads("control/suppressed_event.py", "CONTROL OBSERVED forecaster.options"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: a suppressed event"
    script:
        "../scripts/control/suppressed_event.py"

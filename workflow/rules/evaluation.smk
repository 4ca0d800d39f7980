"""Time-accurate prediction: forecasts of the evaluation set, prediction horizons of events."""


rule forecast:
    input:
        forecaster=f"{FORECASTER}/forecaster.nc",
        evaluation_set=f"{CASE}/evaluation_set.nc",
        time_unit=time_unit,
    output:
        forecast=f"{FORECASTER}/forecast.nc",
    log:
        f"{LOGS}/forecast/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/forecast/{{case}}/{{forecaster}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("closed_loop", cached=True),
    params:
        **reads("evaluation/forecast.py", "FORECASTER WINDOWS"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: forecast the evaluation set"
    script:
        "../scripts/evaluation/forecast.py"


rule horizon:
    input:
        forecaster=f"{FORECASTER}/forecaster.nc",
        events=f"{CASE}/events.nc",
        summary=f"{CASE}/dataset.json",
        time_unit=time_unit,
    output:
        horizon=f"{FORECASTER}/horizon.nc",
    log:
        f"{LOGS}/horizon/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/horizon/{{case}}/{{forecaster}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("closed_loop", cached=True),
    params:
        **reads(
            "evaluation/horizon.py",
            "FORECASTER HORIZON case.event_threshold washout_lt",
        ),
    message:
        "{wildcards.case}, {wildcards.forecaster}: prediction horizons"
    script:
        "../scripts/evaluation/horizon.py"


rule long_term:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        forecaster=f"{FORECASTER}/forecaster.nc",
        time_unit=time_unit,
    output:
        long_term=f"{FORECASTER}/long_term.nc",
    log:
        f"{LOGS}/long_term/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/long_term/{{case}}/{{forecaster}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("closed_loop", cached=True),
    params:
        **reads(
            "evaluation/long_term.py",
            "FORECASTER random_seed case.training case.density "
            "case.laminarisation_threshold case.fixed_point washout_lt "
            "statistics.starting_points statistics.start_spacing_lt "
            "statistics.duration statistics.fixed_point_interval_lt",
        ),
    message:
        "{wildcards.case}, {wildcards.forecaster}: long-term runs"
    script:
        "../scripts/evaluation/long_term.py"


rule examples:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        evaluation_set=f"{CASE}/evaluation_set.nc",
        events=f"{CASE}/events.nc",
        time_unit=time_unit,
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
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("closed_loop"),
    params:
        **reads(
            "evaluation/examples.py",
            "FORECASTER HORIZON case.event_threshold case.training.series washout_lt "
            "classification.resolution_lt classification.window_lt "
            "classification.longest_prediction_time_lt "
            "figures.example_prediction_time_lt figures.example_horizon_lt",
        ),
    message:
        "{wildcards.case}, {wildcards.forecaster}: example forecasts"
    script:
        "../scripts/evaluation/examples.py"


rule flow_event:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        forecaster=f"{FORECASTER}/forecaster.nc",
        time_unit=time_unit,
    output:
        event=f"{FORECASTER}/flow_event.nc",
    log:
        f"{LOGS}/flow_event/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/flow_event/{{case}}/{{forecaster}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("closed_loop"),
    params:
        **reads(
            "evaluation/flow_event.py",
            "FORECASTER random_seed case.training case.test_series "
            "case.event_threshold washout_lt figures.flow_event",
        ),
    message:
        "{wildcards.case}, {wildcards.forecaster}: an event whose flow is worth seeing"
    script:
        "../scripts/evaluation/flow_event.py"

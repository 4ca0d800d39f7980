"""Data of a case: the ensemble, its exponents and statistics, what forecasters are judged on."""


rule simulate:
    output:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
    log:
        f"{LOGS}/simulate/{{case}}.log",
    benchmark:
        f"{TIMES}/simulate/{{case}}.tsv"
    group:
        "case"
    conda:
        ENVIRONMENT
    resources:
        **needs("integration", cached=True),
    params:
        **reads(
            "data/simulate.py",
            "SYSTEM random_seed case.ensemble case.laminarisation_threshold",
        ),
    message:
        "{wildcards.case}: integrate the ensemble"
    script:
        "../scripts/data/simulate.py"


rule lyapunov:
    input:
        ensemble=f"{CASE}/ensemble.nc",
    output:
        exponents=f"{CASE}/lyapunov.json",
    log:
        f"{LOGS}/lyapunov/{{case}}.log",
    benchmark:
        f"{TIMES}/lyapunov/{{case}}.tsv"
    group:
        "case"
    conda:
        ENVIRONMENT
    resources:
        **needs("tangent", cached=True),
    params:
        **reads(
            "data/lyapunov.py",
            "SYSTEM random_seed case.ensemble.time_step case.ensemble.sampling_stride "
            "case.lyapunov.series case.lyapunov.orthonormalisation_interval "
            "case.lyapunov.perturbation case.lyapunov.saturation",
        ),
    message:
        "{wildcards.case}: Lyapunov exponents"
    script:
        "../scripts/data/lyapunov.py"


rule evaluation_set:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        time_unit=time_unit,
    output:
        evaluation_set=f"{CASE}/evaluation_set.nc",
    log:
        f"{LOGS}/evaluation_set/{{case}}.log",
    benchmark:
        f"{TIMES}/evaluation_set/{{case}}.tsv"
    group:
        "case"
    conda:
        ENVIRONMENT
    resources:
        **needs("data"),
    params:
        **reads(
            "data/evaluation_set.py",
            "SYSTEM TIME OBSERVED WINDOWS case.test_series washout_lt "
            "classification.start_spacing_lt",
        ),
    message:
        "{wildcards.case}: starting points of the forecasts"
    script:
        "../scripts/data/evaluation_set.py"


rule events:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        time_unit=time_unit,
    output:
        events=f"{CASE}/events.nc",
        summary=f"{CASE}/events.json",
    log:
        f"{LOGS}/events/{{case}}.log",
    benchmark:
        f"{TIMES}/events/{{case}}.tsv"
    group:
        "case"
    conda:
        ENVIRONMENT
    resources:
        **needs("data"),
    params:
        **reads(
            "data/events.py",
            "TIME OBSERVED case.event_threshold washout_lt horizon.events "
            "horizon.longest_lead_time_lt",
        ),
    message:
        "{wildcards.case}: extreme events"
    script:
        "../scripts/data/events.py"


rule reference_statistics:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
    output:
        data=f"{CASE}/statistics_data.nc",
        training=f"{CASE}/statistics_training.nc",
        floor=f"{CASE}/statistics_floor.nc",
    log:
        f"{LOGS}/reference_statistics/{{case}}.log",
    benchmark:
        f"{TIMES}/reference_statistics/{{case}}.tsv"
    group:
        "case"
    conda:
        ENVIRONMENT
    resources:
        **needs("data"),
    params:
        **reads(
            "data/reference_statistics.py",
            "SYSTEM random_seed case.density case.training.series "
            "statistics.profile_points statistics.floor_splits",
        ),
    message:
        "{wildcards.case}: long-term statistics of the data"
    script:
        "../scripts/data/reference_statistics.py"

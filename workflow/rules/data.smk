"""Data of a case: the ensemble, its exponents and statistics, what forecasters are judged on."""


rule simulate:
    output:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
    log:
        f"{LOGS}/simulate/{{case}}.log",
    benchmark:
        f"{TIMES}/simulate/{{case}}.tsv"
    wildcard_constraints:
        case=INTEGRATED,
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("simulate", "integration", cached=True),
    params:
        settings=settings_of("data/simulate.py"),
        code=code_of("data/simulate.py"),
    message:
        "{wildcards.case}: integrate the ensemble"
    script:
        "../scripts/data/simulate.py"


rule import_data:
    input:
        sources=stages.sources_of_data,
    output:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
    log:
        f"{LOGS}/import_data/{{case}}.log",
    benchmark:
        f"{TIMES}/import_data/{{case}}.tsv"
    wildcard_constraints:
        case=IMPORTED,
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("import_data", "data"),
    params:
        settings=settings_of("data/import_data.py"),
        code=code_of("data/import_data.py"),
    message:
        "{wildcards.case}: check and copy measured series"
    script:
        "../scripts/data/import_data.py"


rule encode:
    # what sensors see of another case, or an encoder makes of it
    input:
        source=of_case(lambda case: f"{RESULTS}/{case.source.name}/ensemble.nc"),
    output:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
        encoder=f"{CASE}/encoder.nc",
    log:
        f"{LOGS}/encode/{{case}}.log",
    benchmark:
        f"{TIMES}/encode/{{case}}.tsv"
    wildcard_constraints:
        case=one_of(campaign.encoded_cases),
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("encode", "data"),
    params:
        settings=settings_of("data/encode.py"),
        code=code_of("data/encode.py"),
    message:
        "{wildcards.case}: observe and encode the series of another case"
    script:
        "../scripts/data/encode.py"


rule training_realisation:
    # the series of another case with other training series
    input:
        **unknowns_of("training_realisation"),
        source=stages.ensemble_of_source,
    output:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
    log:
        f"{LOGS}/training_realisation/{{case}}.log",
    benchmark:
        f"{TIMES}/training_realisation/{{case}}.tsv"
    wildcard_constraints:
        case=REALISED,
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("training_realisation", "data"),
    params:
        settings=settings_of("data/training_realisation.py"),
        code=code_of("data/training_realisation.py"),
    message:
        "{wildcards.case}: choose other training series"
    script:
        "../scripts/data/training_realisation.py"


rule event_threshold:
    input:
        ensemble=f"{CASE}/ensemble.nc",
    output:
        event_threshold=f"{CASE}/event_threshold.json",
    log:
        f"{LOGS}/event_threshold/{{case}}.log",
    benchmark:
        f"{TIMES}/event_threshold/{{case}}.tsv"
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("event_threshold", "data"),
    params:
        settings=settings_of("data/event_threshold.py"),
        code=code_of("data/event_threshold.py"),
    message:
        "{wildcards.case}: the event threshold, a quantile of the training series"
    script:
        "../scripts/data/event_threshold.py"


rule scheduled_series:
    # what kinds of forecasters learn from that know the parameters
    input:
        **unknowns_of("scheduled_series"),
        ensemble=f"{CASE}/ensemble.nc",
    output:
        scheduled_series=f"{CASE}/scheduled_series.nc",
    log:
        f"{LOGS}/scheduled_series/{{case}}.log",
    benchmark:
        f"{TIMES}/scheduled_series/{{case}}.tsv"
    wildcard_constraints:
        case=one_of(
            [*campaign.simulated_cases, *campaign.where(lambda case: case.known)]
        ),
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("scheduled_series", "data"),
    params:
        settings=settings_of("data/scheduled_series.py"),
        code=code_of("data/scheduled_series.py"),
    message:
        "{wildcards.case}: series with the parameters in force"
    script:
        "../scripts/data/scheduled_series.py"


rule lyapunov:
    input:
        ensemble=f"{CASE}/ensemble.nc",
    output:
        exponents=f"{CASE}/lyapunov.json",
        spectrum=f"{CASE}/lyapunov_spectrum.nc",
    log:
        f"{LOGS}/lyapunov/{{case}}.log",
    benchmark:
        f"{TIMES}/lyapunov/{{case}}.tsv"
    wildcard_constraints:
        case=SIMULATED,
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("lyapunov", "tangent", cached=True),
    params:
        settings=settings_of("data/lyapunov.py"),
        code=code_of("data/lyapunov.py"),
    message:
        "{wildcards.case}: Lyapunov exponents"
    script:
        "../scripts/data/lyapunov.py"


rule neighbour_divergence:
    input:
        ensemble=f"{CASE}/ensemble.nc",
    output:
        exponents=f"{CASE}/lyapunov.json",
    log:
        f"{LOGS}/neighbour_divergence/{{case}}.log",
    benchmark:
        f"{TIMES}/neighbour_divergence/{{case}}.tsv"
    wildcard_constraints:
        case=MEASURED,
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("neighbour_divergence", "data"),
    params:
        settings=settings_of("data/neighbour_divergence.py"),
        code=code_of("data/neighbour_divergence.py"),
    message:
        "{wildcards.case}: Lyapunov exponent, from how neighbours part"
    script:
        "../scripts/data/neighbour_divergence.py"


rule lengths:
    # what does not fit fails here at once, with one list
    input:
        **unknowns_of("lengths"),
        ensemble=f"{CASE}/ensemble.nc",
    output:
        lengths=f"{CASE}/lengths.json",
    log:
        f"{LOGS}/lengths/{{case}}.log",
    benchmark:
        f"{TIMES}/lengths/{{case}}.tsv"
    wildcard_constraints:
        case=one_of(campaign.where(lambda case: case.time_unit)),
    priority: 1
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("lengths", "data"),
    params:
        settings=settings_of("data/lengths.py"),
        code=code_of("data/lengths.py"),
    message:
        "{wildcards.case}: compare what the config needs with the lengths of the series"
    script:
        "../scripts/data/lengths.py"


rule evaluation_set:
    input:
        **unknowns_of("evaluation_set"),
        ensemble=f"{CASE}/ensemble.nc",
    output:
        evaluation_set=f"{CASE}/evaluation_set.nc",
    log:
        f"{LOGS}/evaluation_set/{{case}}.log",
    benchmark:
        f"{TIMES}/evaluation_set/{{case}}.tsv"
    wildcard_constraints:
        case=one_of({*campaign.cases} - {*campaign.switched_cases}),
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("evaluation_set", "data"),
    params:
        settings=settings_of("data/evaluation_set.py"),
        code=code_of("data/evaluation_set.py"),
    message:
        "{wildcards.case}: starting points of the forecasts"
    script:
        "../scripts/data/evaluation_set.py"


rule switched_evaluation_set:
    input:
        **unknowns_of("switched_evaluation_set"),
        ensemble=f"{CASE}/ensemble.nc",
    output:
        evaluation_set=f"{CASE}/evaluation_set.nc",
    log:
        f"{LOGS}/switched_evaluation_set/{{case}}.log",
    benchmark:
        f"{TIMES}/switched_evaluation_set/{{case}}.tsv"
    wildcard_constraints:
        case=one_of(campaign.switched_cases),
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("switched_evaluation_set", "data"),
    params:
        settings=settings_of("data/switched_evaluation_set.py"),
        code=code_of("data/switched_evaluation_set.py"),
    message:
        "{wildcards.case}: starting points of forecasts under actuation"
    script:
        "../scripts/data/switched_evaluation_set.py"


rule events:
    input:
        **unknowns_of("events"),
        ensemble=f"{CASE}/ensemble.nc",
    output:
        events=f"{CASE}/events.nc",
        events_summary=f"{CASE}/events.json",
    log:
        f"{LOGS}/events/{{case}}.log",
    benchmark:
        f"{TIMES}/events/{{case}}.tsv"
    group:
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("events", "data"),
    params:
        settings=settings_of("data/events.py"),
        code=code_of("data/events.py"),
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
        group_of("case")
    conda:
        ENVIRONMENT
    resources:
        **needs("reference_statistics", "data"),
    params:
        settings=settings_of("data/reference_statistics.py"),
        code=code_of("data/reference_statistics.py"),
    message:
        "{wildcards.case}: long-term statistics of the data"
    script:
        "../scripts/data/reference_statistics.py"

"""Data of a case: the ensemble, its exponents and statistics, what forecasters are judged on."""


rule simulate:
    output:
        ensemble=f"{CASE}/ensemble.nc",
        summary=f"{CASE}/dataset.json",
    log:
        f"{LOGS}/simulate/{{case}}.log",
    wildcard_constraints:
        case=INTEGRATED,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/simulate.py"),
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
    wildcard_constraints:
        case=IMPORTED,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/import_data.py"),
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
    wildcard_constraints:
        case=one_of(campaign.encoded_cases),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/encode.py"),
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
    wildcard_constraints:
        case=REALISED,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/training_realisation.py"),
    script:
        "../scripts/data/training_realisation.py"


rule event_threshold:
    input:
        ensemble=f"{CASE}/ensemble.nc",
    output:
        event_threshold=f"{CASE}/event_threshold.json",
    log:
        f"{LOGS}/event_threshold/{{case}}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/event_threshold.py"),
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
    wildcard_constraints:
        case=one_of(
            [*campaign.simulated_cases, *campaign.where(lambda case: case.known)]
        ),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/scheduled_series.py"),
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
    wildcard_constraints:
        case=SIMULATED,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/lyapunov.py"),
    script:
        "../scripts/data/lyapunov.py"


rule neighbour_divergence:
    input:
        ensemble=f"{CASE}/ensemble.nc",
    output:
        exponents=f"{CASE}/lyapunov.json",
    log:
        f"{LOGS}/neighbour_divergence/{{case}}.log",
    wildcard_constraints:
        case=MEASURED,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/neighbour_divergence.py"),
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
    wildcard_constraints:
        case=one_of(campaign.where(lambda case: case.time_unit)),
    priority: 1
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/lengths.py"),
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
    wildcard_constraints:
        case=one_of({*campaign.cases} - {*campaign.switched_cases}),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/evaluation_set.py"),
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
    wildcard_constraints:
        case=one_of(campaign.switched_cases),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/switched_evaluation_set.py"),
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
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/events.py"),
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
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("data/reference_statistics.py"),
    script:
        "../scripts/data/reference_statistics.py"

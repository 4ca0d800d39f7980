"""Data of a case: the ensemble, its exponents and statistics, what forecasters are judged on."""

from burstcast.base.declared import read


rule simulate:
    output:
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
    log:
        "<logs>/simulate/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.where(has_equations=True, takes_series=False)),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/simulate.py"),
    script:
        "../scripts/data/simulate.py"


rule import_data:
    input:
        sources=stages.sources_of_data,
    output:
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
    log:
        "<logs>/import_data/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.where(has_equations=False, takes_series=False)),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/import_data.py"),
    script:
        "../scripts/data/import_data.py"


rule encode:
    # what sensors see of another case, or an encoder makes of it
    input:
        source=stages.declared(read("source/ensemble.nc")),
    output:
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
        encoder="<results>/{case}/encoder.nc",
    log:
        "<logs>/encode/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.where(is_encoded=True)),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/encode.py"),
    script:
        "../scripts/data/encode.py"


rule training_realisation:
    # the series of another case with other training series
    input:
        **computed_settings_files("training_realisation"),
        source=stages.ensemble_of_source,
    output:
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
    log:
        "<logs>/training_realisation/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.realised_cases),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/training_realisation.py"),
    script:
        "../scripts/data/training_realisation.py"


rule event_threshold:
    input:
        ensemble="<results>/{case}/ensemble.nc",
    output:
        event_threshold="<results>/{case}/event_threshold.json",
    log:
        "<logs>/event_threshold/{case}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/event_threshold.py"),
    script:
        "../scripts/data/event_threshold.py"


rule scheduled_series:
    # what kinds of forecasters learn from that know the parameters
    input:
        **computed_settings_files("scheduled_series"),
        ensemble="<results>/{case}/ensemble.nc",
    output:
        scheduled_series="<results>/{case}/scheduled_series.nc",
    log:
        "<logs>/scheduled_series/{case}.log",
    wildcard_constraints:
        case=any_of_regex(
            [*campaign.simulated_cases, *campaign.where(known_columns=True)]
        ),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/scheduled_series.py"),
    script:
        "../scripts/data/scheduled_series.py"


rule lyapunov:
    input:
        ensemble="<results>/{case}/ensemble.nc",
    output:
        exponents="<results>/{case}/lyapunov.json",
        spectrum="<results>/{case}/lyapunov_spectrum.nc",
    log:
        "<logs>/lyapunov/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.simulated_cases),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/lyapunov.py"),
    script:
        "../scripts/data/lyapunov.py"


rule neighbour_divergence:
    input:
        ensemble="<results>/{case}/ensemble.nc",
    output:
        exponents="<results>/{case}/lyapunov.json",
    log:
        "<logs>/neighbour_divergence/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.where(has_equations=False)),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/neighbour_divergence.py"),
    script:
        "../scripts/data/neighbour_divergence.py"


rule lengths:
    # what does not fit fails here at once, with one list
    input:
        **computed_settings_files("lengths"),
        ensemble="<results>/{case}/ensemble.nc",
    output:
        lengths="<results>/{case}/lengths.json",
    log:
        "<logs>/lengths/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.where(has_known_lengths=False)),
    priority: 1
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/lengths.py"),
    script:
        "../scripts/data/lengths.py"


rule evaluation_set:
    input:
        **computed_settings_files("evaluation_set"),
        ensemble="<results>/{case}/ensemble.nc",
    output:
        evaluation_set="<results>/{case}/evaluation_set.nc",
    log:
        "<logs>/evaluation_set/{case}.log",
    wildcard_constraints:
        case=any_of_regex({*campaign.cases} - {*campaign.where(is_switched=True)}),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/evaluation_set.py"),
    script:
        "../scripts/data/evaluation_set.py"


rule switched_evaluation_set:
    input:
        **computed_settings_files("switched_evaluation_set"),
        ensemble="<results>/{case}/ensemble.nc",
    output:
        evaluation_set="<results>/{case}/evaluation_set.nc",
    log:
        "<logs>/switched_evaluation_set/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.where(is_switched=True)),
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/switched_evaluation_set.py"),
    script:
        "../scripts/data/switched_evaluation_set.py"


rule events:
    input:
        **computed_settings_files("events"),
        ensemble="<results>/{case}/ensemble.nc",
    output:
        events="<results>/{case}/events.nc",
        events_summary="<results>/{case}/events.json",
    log:
        "<logs>/events/{case}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/events.py"),
    script:
        "../scripts/data/events.py"


rule reference_statistics:
    input:
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
    output:
        data="<results>/{case}/statistics_data.nc",
        training="<results>/{case}/statistics_training.nc",
        floor="<results>/{case}/statistics_floor.nc",
    log:
        "<logs>/reference_statistics/{case}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("data/reference_statistics.py"),
    script:
        "../scripts/data/reference_statistics.py"

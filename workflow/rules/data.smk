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
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.ensemble",
            "case.laminarisation_threshold",
            "case.parameters",
            "case.system",
            "random_seed",
        ),
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
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.data",
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.laminarisation_threshold",
            "case.parameters",
            "case.test_series",
            "case.training.series",
            "job.contents_of_data",
            "job.noise_of_data",
        ),
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
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.encoder",
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.parameters",
            "case.sensors",
            "case.source_system",
            "case.system",
            "case.training.series",
            "job.noise_of_data",
            "random_seed",
        ),
    script:
        "../scripts/data/encode.py"


rule training_realisation:
    # the series of another case with other training series
    input:
        source=stages.ensemble_of_source,
    output:
        ensemble="<results>/{case}/ensemble.nc",
        summary="<results>/{case}/dataset.json",
    log:
        "<logs>/training_realisation/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.realised_cases),
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.parameters",
            "case.realisation",
            "case.system",
            "case.test_series",
            "case.training.series",
            "job.drawn_shares",
            "probability.calibration_series",
            "random_seed",
        ),
    script:
        "../scripts/data/training_realisation.py"


rule event_threshold:
    input:
        ensemble="<results>/{case}/ensemble.nc",
    output:
        event_threshold="<results>/{case}/event_threshold.json",
    log:
        "<logs>/event_threshold/{case}.log",
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.event_threshold",
            "case.training.series",
        ),
    script:
        "../scripts/data/event_threshold.py"


rule time_unit:
    input:
        exponents=stages.computed_exponents,
    output:
        time_unit="<results>/{case}/time_unit.json",
    log:
        "<logs>/time_unit/{case}.log",
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.lyapunov.given_exponent",
            "case.lyapunov.time_unit",
        ),
    script:
        "../scripts/data/time_unit.py"


rule scheduled_series:
    # what kinds of forecasters learn from that know the parameters
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
    output:
        scheduled_series="<results>/{case}/scheduled_series.nc",
    log:
        "<logs>/scheduled_series/{case}.log",
    wildcard_constraints:
        case=any_of_regex(
            [*campaign.simulated_cases, *campaign.where(known_columns=True)]
        ),
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.actuation",
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.laminarisation_threshold",
            "case.parameters",
            "case.system",
            "case.training.actuation",
            "case.training.noise",
            "case.training.series",
            "job.parameters",
            "random_seed",
        ),
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
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.lyapunov.exponents",
            "case.lyapunov.orthonormalisation_interval",
            "case.lyapunov.perturbation",
            "case.lyapunov.saturation",
            "case.lyapunov.series",
            "case.parameters",
            "case.system",
            "random_seed",
        ),
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
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "bootstrap.confidence",
            "bootstrap.resamples",
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.estimates_time_unit",
            "case.training.series",
            "random_seed",
        ),
    script:
        "../scripts/data/neighbour_divergence.py"


rule lengths:
    # what does not fit fails here at once, with one list
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
    output:
        lengths="<results>/{case}/lengths.json",
    log:
        "<logs>/lengths/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.where(has_known_lengths=False)),
    priority: 1
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.recycle_validation.intervals_per_series",
            "case.recycle_validation.series",
            "case.training.series",
            "classification.longest_prediction_time_lt",
            "classification.resolution_lt",
            "classification.start_spacing_lt",
            "classification.window_lt",
            "forecasters.quadratic.window_lt",
            "horizon.lead_time_step_lt",
            "horizon.longest_lead_time_lt",
            "job.asked_of_series.kinds",
            "job.asked_of_series.long_runs",
            "job.asked_of_series.validations",
            "probability.start_spacing_lt",
            "search.interval_lt",
            "search.single_shot_lead_steps",
            "statistics.duration",
            "statistics.fixed_point_interval_lt",
            "statistics.start_spacing_lt",
            "washout_lt",
        ),
    script:
        "../scripts/data/lengths.py"


rule evaluation_set:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
    output:
        evaluation_set="<results>/{case}/evaluation_set.nc",
    log:
        "<logs>/evaluation_set/{case}.log",
    wildcard_constraints:
        case=any_of_regex({*campaign.cases} - {*campaign.where(is_switched=True)}),
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.parameters",
            "case.system",
            "case.test_series",
            "case.training.noise",
            "case.training.series",
            "classification.longest_prediction_time_lt",
            "classification.resolution_lt",
            "classification.start_spacing_lt",
            "classification.window_lt",
            "random_seed",
            "washout_lt",
        ),
    script:
        "../scripts/data/evaluation_set.py"


rule switched_evaluation_set:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
    output:
        evaluation_set="<results>/{case}/evaluation_set.nc",
    log:
        "<logs>/switched_evaluation_set/{case}.log",
    wildcard_constraints:
        case=any_of_regex(campaign.where(is_switched=True)),
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.actuation",
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.laminarisation_threshold",
            "case.parameters",
            "case.system",
            "case.test_series",
            "case.training.actuation",
            "case.training.noise",
            "case.training.series",
            "classification.longest_prediction_time_lt",
            "classification.resolution_lt",
            "classification.start_spacing_lt",
            "classification.window_lt",
            "job.parameters",
            "random_seed",
            "washout_lt",
        ),
    script:
        "../scripts/data/switched_evaluation_set.py"


rule events:
    input:
        event_threshold="<results>/{case}/event_threshold.json",
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
    output:
        events="<results>/{case}/events.nc",
        events_summary="<results>/{case}/events.json",
    log:
        "<logs>/events/{case}.log",
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.training.noise",
            "case.training.series",
            "horizon.events",
            "horizon.longest_lead_time_lt",
            "random_seed",
            "washout_lt",
        ),
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
    group:
        "case"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.density",
            "case.parameters",
            "case.system",
            "case.training.series",
            "random_seed",
            "statistics.floor_splits",
            "statistics.profile_points",
        ),
    script:
        "../scripts/data/reference_statistics.py"

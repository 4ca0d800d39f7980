"""Forecasters: the search for a network's hyperparameters, training, fitting, and all results."""


rule scan:
    # one job for all strategies that share their sums over the training data
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
        scheduled=stages.scheduled,
    output:
        scan="<results>/{case}/scan/{reservoir}/{strategies}.csv",
        scan_errors="<results>/{case}/scan/{reservoir}/{strategies}.nc",
    log:
        "<logs>/scan/{case}/{reservoir}/{strategies}.log",
    group:
        "forecaster"
    resources:
        **resources_of("training"),
    params:
        settings=settings(
            "case.parameters",
            "case.recycle_validation.intervals_per_series",
            "case.recycle_validation.series",
            "case.system",
            "case.training.noise",
            "case.training.series",
            "forecasters.aware",
            "forecasters.esn.backend",
            "forecasters.esn.connectivity",
            "forecasters.esn.input_bias",
            "forecasters.esn.input_offset",
            "forecasters.esn.input_range",
            "forecasters.esn.leak_rate",
            "forecasters.esn.readout",
            "random_seed",
            "search.grid",
            "search.input_scaling",
            "search.interval_lt",
            "search.single_shot_lead_steps",
            "search.spectral_radius",
            "search.tikhonov",
            "washout_lt",
        ),
    script:
        "../scripts/forecasters/scan.py"


rule search:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
        scheduled=stages.scheduled,
        scan=stages.scan_of_network("csv"),
        scan_errors=stages.scan_of_network("nc"),
    output:
        hyperparameters="<results>/{case}/networks/{forecaster}/hyperparameters.json",
        trace="<results>/{case}/networks/{forecaster}/search.csv",
    log:
        "<logs>/search/{case}/{forecaster}.log",
    wildcard_constraints:
        forecaster=NETWORK,
    group:
        "forecaster"
    resources:
        **resources_of("training"),
    params:
        settings=settings(
            "case.parameters",
            "case.recycle_validation.intervals_per_series",
            "case.recycle_validation.series",
            "case.system",
            "case.training.noise",
            "case.training.series",
            "forecasters.aware",
            "forecasters.esn.backend",
            "forecasters.esn.connectivity",
            "forecasters.esn.input_bias",
            "forecasters.esn.input_offset",
            "forecasters.esn.input_range",
            "forecasters.esn.leak_rate",
            "forecasters.esn.readout",
            "random_seed",
            "search.bayesian_points",
            "search.input_scaling",
            "search.interval_lt",
            "search.single_shot_lead_steps",
            "search.spectral_radius",
            "search.surrogate",
            "search.tikhonov",
            "washout_lt",
        ),
    script:
        "../scripts/forecasters/search.py"


rule train:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
        scheduled=stages.scheduled,
        hyperparameters=stages.hyperparameters,
    output:
        forecaster="<results>/{case}/networks/{forecaster}/forecaster.nc",
    log:
        "<logs>/train/{case}/{forecaster}.log",
    wildcard_constraints:
        forecaster=NETWORK,
    group:
        "forecaster"
    resources:
        **resources_of("training"),
    params:
        settings=settings(
            "case.training.noise",
            "case.training.series",
            "forecaster.options",
            "forecasters.aware",
            "forecasters.esn.connectivity",
            "forecasters.esn.input_bias",
            "forecasters.esn.input_offset",
            "forecasters.esn.input_range",
            "random_seed",
            "washout_lt",
        ),
    script:
        "../scripts/forecasters/train.py"


rule fit:
    input:
        time_unit="<results>/{case}/time_unit.json",
        ensemble="<results>/{case}/ensemble.nc",
        scheduled=stages.scheduled,
    output:
        forecaster="<results>/{case}/models/{forecaster}/forecaster.nc",
    log:
        "<logs>/fit/{case}/{forecaster}.log",
    wildcard_constraints:
        forecaster=MODEL,
    group:
        "forecaster"
    resources:
        **resources_of("usual"),
    params:
        settings=settings(
            "case.ensemble.sampling_stride",
            "case.ensemble.time_step",
            "case.parameters",
            "case.system",
            "case.training.noise",
            "case.training.series",
            "forecaster.divergence_bound",
            "forecaster.options",
            "forecaster.source",
            "random_seed",
        ),
    script:
        "../scripts/forecasters/fit.py"


rule forecasters:
    # all that is computed forecaster by forecaster: the target for planning a large campaign in batches
    input:
        case_files("lengths.json", campaign.where(has_known_lengths=False)),
        forecaster_files("forecaster.nc"),
        forecaster_files("forecast.nc"),
        forecaster_files("calibration_forecast.nc"),
        forecaster_files("horizon.nc", campaign.trajectory_forecasters),
        forecaster_files("long_term.nc", campaign.long_term_forecasters),
        forecaster_files("lyapunov_spectrum.nc", campaign.spectrum_forecasters),
        forecaster_files("flows.nc", campaign.strategy_runs),
    localrule: True

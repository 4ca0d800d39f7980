"""Forecasters: the search for a network's hyperparameters, training, fitting, and all results."""


rule scan:
    # one job for all strategies that share their sums over the training data
    input:
        **computed_settings_files("scan"),
        ensemble="<results>/{case}/ensemble.nc",
        scheduled=stages.scheduled,
    output:
        scan="<results>/{case}/scan/{reservoir}/{strategies}.csv",
        scan_errors="<results>/{case}/scan/{reservoir}/{strategies}.nc",
    log:
        "<logs>/scan/{case}/{reservoir}/{strategies}.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("training"),
    params:
        *of_script("forecasters/scan.py"),
    script:
        "../scripts/forecasters/scan.py"


rule search:
    input:
        **computed_settings_files("search"),
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
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("training"),
    params:
        *of_script("forecasters/search.py"),
    script:
        "../scripts/forecasters/search.py"


rule train:
    input:
        **computed_settings_files("train"),
        ensemble="<results>/{case}/ensemble.nc",
        scheduled=stages.scheduled,
        hyperparameters=stages.hyperparameters,
    output:
        forecaster="<results>/{case}/networks/{forecaster}/forecaster.nc",
    log:
        "<logs>/train/{case}/{forecaster}.log",
    wildcard_constraints:
        forecaster=NETWORK,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("training"),
    params:
        *of_script("forecasters/train.py"),
    script:
        "../scripts/forecasters/train.py"


rule fit:
    input:
        **computed_settings_files("fit"),
        ensemble="<results>/{case}/ensemble.nc",
        scheduled=stages.scheduled,
    output:
        forecaster="<results>/{case}/models/{forecaster}/forecaster.nc",
    log:
        "<logs>/fit/{case}/{forecaster}.log",
    wildcard_constraints:
        forecaster=MODEL,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("usual"),
    params:
        *of_script("forecasters/fit.py"),
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

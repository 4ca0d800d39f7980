"""From the data to forecasters: the search for a network's hyperparameters, training, fitting."""


rule scan:
    # one job for all strategies that share their sums over the training data
    input:
        ensemble=f"{CASE}/ensemble.nc",
        time_unit=time_unit,
    output:
        scan=f"{CASE}/scan/{{reservoir}}-{{strategies}}.csv",
    log:
        f"{LOGS}/scan/{{case}}/{{reservoir}}-{{strategies}}.log",
    benchmark:
        f"{TIMES}/scan/{{case}}/{{reservoir}}-{{strategies}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("search_grid", cached=True),
    params:
        **reads("forecasters/scan.py", "SEARCH search.grid"),
    message:
        "{wildcards.case}, {wildcards.reservoir}: objectives on the grid, {wildcards.strategies}"
    script:
        "../scripts/forecasters/scan.py"


rule search:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        time_unit=time_unit,
        scan=scan_of_network,
    output:
        hyperparameters=f"{FORECASTER}/hyperparameters.json",
        trace=f"{FORECASTER}/search.csv",
    log:
        f"{LOGS}/search/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/search/{{case}}/{{forecaster}}.tsv"
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("search_points", cached=True),
    params:
        **reads("forecasters/search.py", "SEARCH search.bayesian_points"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: Bayesian search"
    script:
        "../scripts/forecasters/search.py"


rule train:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        time_unit=time_unit,
        hyperparameters=f"{FORECASTER}/hyperparameters.json",
    output:
        forecaster=f"{FORECASTER}/forecaster.nc",
    log:
        f"{LOGS}/train/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/train/{{case}}/{{forecaster}}.tsv"
    wildcard_constraints:
        forecaster=NETWORKS,
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("training", cached=True),
    params:
        **reads("forecasters/train.py", "TIME OBSERVED RESERVOIR washout_lt"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: train"
    script:
        "../scripts/forecasters/train.py"


rule fit:
    input:
        ensemble=f"{CASE}/ensemble.nc",
        time_unit=time_unit,
    output:
        forecaster=f"{FORECASTER}/forecaster.nc",
    log:
        f"{LOGS}/fit/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/fit/{{case}}/{{forecaster}}.tsv"
    # forecasters of all other kinds, which need no search
    wildcard_constraints:
        forecaster=OTHERS,
    group:
        "forecaster"
    conda:
        ENVIRONMENT
    resources:
        **needs("training", cached=True),
    params:
        **reads("forecasters/fit.py", "FORECASTER OBSERVED"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: fit"
    script:
        "../scripts/forecasters/fit.py"

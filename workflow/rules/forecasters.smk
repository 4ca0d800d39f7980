"""From the data to forecasters: the search for a network's hyperparameters, training, fitting."""

# In all rules: `settings_of` gives a script the settings that its class declares, the one of the
# argument `settings` of its function; `needs`, a class of work that says memory and time (CLASSES
# in burstcast_workflow/costs/model.py), and whether the cache keeps the results; `unknowns_of` asks
# for thresholds and units of time where jobs compute them. A name that a rule repeats is its own,
# which `module` may change.


rule scan:
    # one job for all strategies that share their sums over the training data
    input:
        **unknowns_of("scan"),
        ensemble=f"{CASE}/ensemble.nc",
        scheduled=stages.scheduled,
    output:
        scan=f"{CASE}/scan/{{reservoir}}-{{strategies}}.csv",
        scan_errors=f"{CASE}/scan/{{reservoir}}-{{strategies}}.nc",
    log:
        f"{LOGS}/scan/{{case}}/{{reservoir}}/{{strategies}}.log",
    benchmark:
        f"{TIMES}/scan/{{case}}/{{reservoir}}/{{strategies}}.tsv"
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("scan", "search_grid", cached=True),
    params:
        settings=settings_of("forecasters/scan.py"),
        code=code_of("forecasters/scan.py"),
    message:
        "{wildcards.case}, {wildcards.reservoir}, {wildcards.strategies}: objectives on the grid"
    script:
        "../scripts/forecasters/scan.py"


rule search:
    input:
        **unknowns_of("search"),
        ensemble=f"{CASE}/ensemble.nc",
        scheduled=stages.scheduled,
        scan=stages.scan_of_network("csv"),
        scan_errors=stages.scan_of_network("nc"),
    output:
        hyperparameters=f"{FORECASTER}/hyperparameters.json",
        trace=f"{FORECASTER}/search.csv",
    log:
        f"{LOGS}/search/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/search/{{case}}/{{forecaster}}.tsv"
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("search", "search_points", cached=True),
    params:
        settings=settings_of("forecasters/search.py"),
        code=code_of("forecasters/search.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: Bayesian search"
    script:
        "../scripts/forecasters/search.py"


rule train:
    input:
        **unknowns_of("train"),
        ensemble=f"{CASE}/ensemble.nc",
        scheduled=stages.scheduled,
        hyperparameters=stages.hyperparameters,
    output:
        forecaster=f"{FORECASTER}/forecaster.nc",
    log:
        f"{LOGS}/train/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/train/{{case}}/{{forecaster}}.tsv"
    wildcard_constraints:
        forecaster=NETWORKS,
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("train", "training", cached=True),
    params:
        settings=settings_of("forecasters/train.py"),
        code=code_of("forecasters/train.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: train"
    script:
        "../scripts/forecasters/train.py"


rule fit:
    # kinds that need no search, without classifiers
    input:
        **unknowns_of("fit"),
        ensemble=f"{CASE}/ensemble.nc",
        scheduled=stages.scheduled,
    output:
        forecaster=f"{FORECASTER}/forecaster.nc",
    log:
        f"{LOGS}/fit/{{case}}/{{forecaster}}.log",
    benchmark:
        f"{TIMES}/fit/{{case}}/{{forecaster}}.tsv"
    wildcard_constraints:
        forecaster=NO_CLASSIFIER + OTHERS,
    group:
        group_of("forecaster")
    conda:
        ENVIRONMENT
    resources:
        **needs("fit", "training", cached=True),
    params:
        settings=settings_of("forecasters/fit.py"),
        code=code_of("forecasters/fit.py"),
    message:
        "{wildcards.case}, {wildcards.forecaster}: fit"
    script:
        "../scripts/forecasters/fit.py"

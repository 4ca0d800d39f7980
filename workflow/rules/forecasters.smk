"""From the data to forecasters: the search for a network's hyperparameters, training, fitting."""

# In all rules: `of_script` gives a job each setting that the class of the script declares, and each
# module of its code, as parameters; `resources_of`, memory and time; `unknowns_of`, files of
# thresholds and units of time where jobs compute them. A name that a rule repeats is its own, which
# `module` may change.


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
        **unknowns_of("train"),
        ensemble=f"{CASE}/ensemble.nc",
        scheduled=stages.scheduled,
        hyperparameters=stages.hyperparameters,
    output:
        forecaster=f"{FORECASTER}/forecaster.nc",
    log:
        f"{LOGS}/train/{{case}}/{{forecaster}}.log",
    wildcard_constraints:
        forecaster=NETWORKS,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("training"),
    params:
        *of_script("forecasters/train.py"),
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
    wildcard_constraints:
        forecaster=NO_CLASSIFIER + OTHERS,
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of(),
    params:
        *of_script("forecasters/fit.py"),
    script:
        "../scripts/forecasters/fit.py"

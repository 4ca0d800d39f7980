"""From all networks to the tables and figures."""


rule tables:
    localrule: True
    input:
        expand(f"{TABLES}/{{table}}.csv", table=TABLE_NAMES),


rule figures:
    localrule: True
    input:
        expand(f"{FIGURES}/{{figure}}.{{suffix}}", figure=[], suffix=["pdf", "png"]),


rule dataset_table:
    message:
        "table of the dataset"
    input:
        dataset=of_cases("dataset.json"),
        events=of_cases("events.json"),
        lyapunov=of_cases("lyapunov.json"),
    output:
        table=f"{TABLES}/dataset.csv",
    log:
        f"{RESULTS}/logs/dataset_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/dataset_table.tsv"
    params:
        settings=settings_of("dataset_table"),
        code=code_of("dataset_table"),
    threads: 1
    resources:
        mem_mb=memory_of("dataset_table"),
        runtime=runtime_of("dataset_table"),
    script:
        "../scripts/dataset_table.py"


rule hyperparameters_table:
    message:
        "table of the hyperparameters"
    input:
        hyperparameters=of_networks("hyperparameters.json"),
    output:
        table=f"{TABLES}/hyperparameters.csv",
    log:
        f"{RESULTS}/logs/hyperparameters_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/hyperparameters_table.tsv"
    params:
        settings=settings_of("hyperparameters_table"),
        code=code_of("hyperparameters_table"),
    threads: 1
    resources:
        mem_mb=memory_of("hyperparameters_table"),
        runtime=runtime_of("hyperparameters_table"),
    script:
        "../scripts/hyperparameters_table.py"


rule classify:
    message:
        "score the forecasts"
    input:
        forecasts=of_networks("forecast.nc"),
        test_sets=of_cases("test_set.nc"),
    output:
        table=f"{TABLES}/classification.csv",
        intervals=f"{TABLES}/classification_intervals.csv",
    log:
        f"{RESULTS}/logs/classify.log",
    benchmark:
        f"{RESULTS}/benchmarks/classify.tsv"
    params:
        settings=settings_of("classify"),
        code=code_of("classify"),
    threads: 1
    resources:
        mem_mb=memory_of("classify"),
        runtime=runtime_of("classify"),
    script:
        "../scripts/classify.py"


rule horizon_table:
    message:
        "table of the prediction horizons"
    input:
        horizons=of_networks("horizon.csv"),
    output:
        table=f"{TABLES}/horizon.csv",
    log:
        f"{RESULTS}/logs/horizon_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/horizon_table.tsv"
    params:
        settings=settings_of("horizon_table"),
        code=code_of("horizon_table"),
    threads: 1
    resources:
        mem_mb=memory_of("horizon_table"),
        runtime=runtime_of("horizon_table"),
    script:
        "../scripts/horizon_table.py"


"""From the data to trained networks: the scan, the search, the training."""


rule scan:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        lyapunov=time_unit,
    output:
        scan=f"{SCAN}/scan.csv",
    log:
        f"{RESULTS}/logs/scan/{{case}}-N{{neurons}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/scan/{{case}}-N{{neurons}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("scan"),
        runtime=runtime_of("scan"),
    params:
        settings=settings_of("scan"),
        code=code_of("scan"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, seed {wildcards.seed}: objectives on the grid, both strategies"
    script:
        "../scripts/scan.py"


rule tune:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        lyapunov=time_unit,
        scan=f"{SCAN}/scan.csv",
    output:
        hyperparameters=f"{NETWORK}/hyperparameters.json",
        search=f"{NETWORK}/search.csv",
    log:
        f"{RESULTS}/logs/tune/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/tune/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("tune"),
        runtime=runtime_of("tune"),
    params:
        settings=settings_of("tune"),
        code=code_of("tune"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: Bayesian search"
    script:
        "../scripts/tune.py"


rule train:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        lyapunov=time_unit,
        hyperparameters=f"{NETWORK}/hyperparameters.json",
    output:
        network=f"{NETWORK}/network.nc",
    log:
        f"{RESULTS}/logs/train/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/train/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("train"),
        runtime=runtime_of("train"),
    params:
        settings=settings_of("train"),
        code=code_of("train"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: train"
    script:
        "../scripts/train.py"

"""Time-accurate prediction: forecasts of the test set and prediction horizons of its events."""


rule forecast:
    input:
        network=f"{NETWORK}/network.nc",
        test_set=f"{RESULTS}/{{case}}/test_set.nc",
        lyapunov=time_unit,
    output:
        forecast=f"{NETWORK}/forecast.nc",
    log:
        f"{RESULTS}/logs/forecast/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/forecast/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("forecast"),
        runtime=runtime_of("forecast"),
    params:
        settings=settings_of("forecast"),
        code=code_of("forecast"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: forecast the test set"
    script:
        "../scripts/forecast.py"


rule horizon:
    input:
        network=f"{NETWORK}/network.nc",
        events=f"{RESULTS}/{{case}}/events.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
    output:
        horizon=f"{NETWORK}/horizon.nc",
    log:
        f"{RESULTS}/logs/horizon/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/horizon/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("horizon"),
        runtime=runtime_of("horizon"),
    params:
        settings=settings_of("horizon"),
        code=code_of("horizon"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: prediction horizons"
    script:
        "../scripts/horizon.py"


rule examples:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        test_set=f"{RESULTS}/{{case}}/test_set.nc",
        events=f"{RESULTS}/{{case}}/events.nc",
        lyapunov=time_unit,
        network=f"{NETWORK}/network.nc",
        forecast=f"{NETWORK}/forecast.nc",
        horizon=f"{NETWORK}/horizon.nc",
    output:
        examples=f"{NETWORK}/examples.nc",
    log:
        f"{RESULTS}/logs/examples/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/examples/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("examples"),
        runtime=runtime_of("examples"),
    params:
        settings=settings_of("examples"),
        code=code_of("examples"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: example forecasts"
    script:
        "../scripts/examples.py"

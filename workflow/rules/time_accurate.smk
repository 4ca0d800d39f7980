"""Time-accurate prediction: forecasts of the test set and prediction horizons of its events."""

rule forecast:
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: forecast the test set"
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
    params:
        settings=settings_of("forecast"),
        code=code_of("forecast"),
    threads: 1
    resources:
        mem_mb=memory_of("forecast"),
        runtime=runtime_of("forecast"),
    script:
        "../scripts/forecast.py"


rule horizon:
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: prediction horizons"
    input:
        network=f"{NETWORK}/network.nc",
        events=f"{RESULTS}/{{case}}/events.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
    output:
        horizon=f"{NETWORK}/horizon.csv",
    log:
        f"{RESULTS}/logs/horizon/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/horizon/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    params:
        settings=settings_of("horizon"),
        code=code_of("horizon"),
    threads: 1
    resources:
        mem_mb=memory_of("horizon"),
        runtime=runtime_of("horizon"),
    script:
        "../scripts/horizon.py"


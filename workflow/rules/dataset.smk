"""From the equations to the data: ensembles, Lyapunov exponents, test set, events."""


rule simulate:
    output:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
    log:
        f"{RESULTS}/logs/simulate/{{case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/simulate/{{case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("simulate"),
        runtime=runtime_of("simulate"),
    params:
        settings=settings_of("simulate"),
        code=code_of("simulate"),
    message:
        "{wildcards.case}: integrate the ensemble"
    script:
        "../scripts/simulate.py"


rule lyapunov:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
    output:
        exponents=f"{RESULTS}/{{case}}/lyapunov.json",
    log:
        f"{RESULTS}/logs/lyapunov/{{case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/lyapunov/{{case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("lyapunov"),
        runtime=runtime_of("lyapunov"),
    params:
        settings=settings_of("lyapunov"),
        code=code_of("lyapunov"),
    message:
        "{wildcards.case}: Lyapunov exponents by two methods"
    script:
        "../scripts/lyapunov.py"


rule test_set:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        lyapunov=time_unit,
    output:
        test_set=f"{RESULTS}/{{case}}/test_set.nc",
    log:
        f"{RESULTS}/logs/test_set/{{case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/test_set/{{case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("test_set"),
        runtime=runtime_of("test_set"),
    params:
        settings=settings_of("test_set"),
        code=code_of("test_set"),
    message:
        "{wildcards.case}: starting points of the test set and what truly follows"
    script:
        "../scripts/test_set.py"


rule events:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        lyapunov=time_unit,
    output:
        events=f"{RESULTS}/{{case}}/events.nc",
        summary=f"{RESULTS}/{{case}}/events.json",
    log:
        f"{RESULTS}/logs/events/{{case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/events/{{case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("events"),
        runtime=runtime_of("events"),
    params:
        settings=settings_of("events"),
        code=code_of("events"),
    message:
        "{wildcards.case}: extreme events and what comes before them"
    script:
        "../scripts/events.py"

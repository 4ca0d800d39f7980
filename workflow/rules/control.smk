"""Control of extreme events, by networks and by the forecasters to compare with."""

rule control:
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: control, prediction time {wildcards.prediction_time} LT"
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
        network=f"{NETWORK}/network.nc",
    output:
        counts=f"{NETWORK}/control_PT{{prediction_time}}.json",
        histograms=f"{NETWORK}/control_PT{{prediction_time}}.nc",
    log:
        f"{RESULTS}/logs/control/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}-PT{{prediction_time}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/control/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}-PT{{prediction_time}}.tsv"
    params:
        settings=settings_of("control"),
        code=code_of("control"),
    threads: 1
    resources:
        mem_mb=memory_of("control"),
        runtime=runtime_of("control"),
    script:
        "../scripts/control.py"


rule control_random:
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: random actuation, prediction time {wildcards.prediction_time} LT"
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
        counts=f"{NETWORK}/control_PT{{prediction_time}}.json",
    output:
        counts=f"{NETWORK}/control_random_PT{{prediction_time}}.json",
        histograms=f"{NETWORK}/control_random_PT{{prediction_time}}.nc",
    log:
        f"{RESULTS}/logs/control_random/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}-PT{{prediction_time}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/control_random/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}-PT{{prediction_time}}.tsv"
    params:
        settings=settings_of("control_random"),
        code=code_of("control_random"),
    threads: 1
    resources:
        mem_mb=memory_of("control_random"),
        runtime=runtime_of("control_random"),
    script:
        "../scripts/control_random.py"


rule control_equations:
    message:
        "{wildcards.case}: control by the equations, prediction time {wildcards.prediction_time} LT"
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
    output:
        counts=f"{RESULTS}/{{case}}/control_equations_PT{{prediction_time}}.json",
        histograms=f"{RESULTS}/{{case}}/control_equations_PT{{prediction_time}}.nc",
    log:
        f"{RESULTS}/logs/control_equations/{{case}}-PT{{prediction_time}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/control_equations/{{case}}-PT{{prediction_time}}.tsv"
    params:
        settings=settings_of("control_equations"),
        code=code_of("control_equations"),
    threads: 1
    resources:
        mem_mb=memory_of("control_equations"),
        runtime=runtime_of("control_equations"),
    script:
        "../scripts/control_equations.py"


rule control_table:
    message:
        "table of control"
    input:
        counts=control_counts(),
    output:
        table=f"{TABLES}/control.csv",
    log:
        f"{RESULTS}/logs/control_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/control_table.tsv"
    params:
        settings=settings_of("control_table"),
        code=code_of("control_table"),
    threads: 1
    resources:
        mem_mb=memory_of("control_table"),
        runtime=runtime_of("control_table"),
    script:
        "../scripts/control_table.py"


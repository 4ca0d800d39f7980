"""Statistical prediction: the long-term statistics of the data and of the networks."""

rule reference_statistics:
    message:
        "{wildcards.case}: long-term statistics of the data"
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
    output:
        data=f"{RESULTS}/{{case}}/statistics_data.nc",
        training=f"{RESULTS}/{{case}}/statistics_training.nc",
        floor=f"{RESULTS}/{{case}}/statistics_floor.csv",
    log:
        f"{RESULTS}/logs/reference_statistics/{{case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/reference_statistics/{{case}}.tsv"
    params:
        settings=settings_of("reference_statistics"),
        code=code_of("reference_statistics"),
    threads: 1
    resources:
        mem_mb=memory_of("reference_statistics"),
        runtime=runtime_of("reference_statistics"),
    script:
        "../scripts/reference_statistics.py"


rule climate:
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: long closed loops"
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        network=f"{NETWORK}/network.nc",
        lyapunov=time_unit,
    output:
        climate=f"{NETWORK}/climate.nc",
    log:
        f"{RESULTS}/logs/climate/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/climate/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    params:
        settings=settings_of("climate"),
        code=code_of("climate"),
    threads: 1
    resources:
        mem_mb=memory_of("climate"),
        runtime=runtime_of("climate"),
    script:
        "../scripts/climate.py"


rule statistics_table:
    message:
        "table of the long-term statistics"
    input:
        data=of_cases("statistics_data.nc"),
        training=of_cases("statistics_training.nc"),
        floor=of_cases("statistics_floor.csv"),
        climates=of_networks("climate.nc", campaign.climate_networks),
    output:
        table=f"{TABLES}/statistics.csv",
    log:
        f"{RESULTS}/logs/statistics_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/statistics_table.tsv"
    params:
        settings=settings_of("statistics_table"),
        code=code_of("statistics_table"),
    threads: 1
    resources:
        mem_mb=memory_of("statistics_table"),
        runtime=runtime_of("statistics_table"),
    script:
        "../scripts/statistics_table.py"


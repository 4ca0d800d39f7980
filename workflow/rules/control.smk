"""Control of extreme events, by networks and by the forecasters to compare with."""


rule control:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
        network=f"{NETWORK}/network.nc",
    output:
        counts=f"{NETWORK}/control_PT{{prediction_time_lt}}.json",
        histograms=f"{NETWORK}/control_PT{{prediction_time_lt}}.nc",
    log:
        f"{RESULTS}/logs/control/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}-PT{{prediction_time_lt}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/control/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}-PT{{prediction_time_lt}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("control"),
        runtime=runtime_of("control"),
    params:
        settings=settings_of("control"),
        code=code_of("control"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: control, prediction time {wildcards.prediction_time_lt} LT"
    script:
        "../scripts/control.py"


rule control_random:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
        counts=f"{NETWORK}/control_PT{{prediction_time_lt}}.json",
    output:
        counts=f"{NETWORK}/control_random_PT{{prediction_time_lt}}.json",
        histograms=f"{NETWORK}/control_random_PT{{prediction_time_lt}}.nc",
    log:
        f"{RESULTS}/logs/control_random/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}-PT{{prediction_time_lt}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/control_random/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}-PT{{prediction_time_lt}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("control_random"),
        runtime=runtime_of("control_random"),
    params:
        settings=settings_of("control_random"),
        code=code_of("control_random"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: random actuation, prediction time {wildcards.prediction_time_lt} LT"
    script:
        "../scripts/control_random.py"


rule control_equations:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
    output:
        counts=f"{RESULTS}/{{case}}/control_equations_PT{{prediction_time_lt}}.json",
        histograms=f"{RESULTS}/{{case}}/control_equations_PT{{prediction_time_lt}}.nc",
    log:
        f"{RESULTS}/logs/control_equations/{{case}}-PT{{prediction_time_lt}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/control_equations/{{case}}-PT{{prediction_time_lt}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("control_equations"),
        runtime=runtime_of("control_equations"),
    params:
        settings=settings_of("control_equations"),
        code=code_of("control_equations"),
    message:
        "{wildcards.case}: control by the equations, prediction time {wildcards.prediction_time_lt} LT"
    script:
        "../scripts/control_equations.py"


rule control_table:
    input:
        counts=control_counts(),
    output:
        table=f"{TABLES}/control.csv",
    log:
        f"{RESULTS}/logs/control_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/control_table.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("control_table"),
        runtime=runtime_of("control_table"),
    params:
        settings=settings_of("control_table"),
        code=code_of("control_table"),
    message:
        "table of control"
    script:
        "../scripts/control_table.py"


rule suppressed_event:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        lyapunov=time_unit,
        network=f"{NETWORK}/network.nc",
    output:
        event=f"{NETWORK}/suppressed_event.nc",
    log:
        f"{RESULTS}/logs/suppressed_event/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/suppressed_event/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("suppressed_event"),
        runtime=runtime_of("suppressed_event"),
    params:
        settings=settings_of("suppressed_event"),
        code=code_of("suppressed_event"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: a suppressed event"
    script:
        "../scripts/suppressed_event.py"


rule figure_control_schematic:
    input:
        event=control_example,
    output:
        pdf=f"{FIGURES}/control_schematic.pdf",
        png=report(
            f"{FIGURES}/control_schematic.png",
            caption="../report/control_schematic.rst",
            category="Figures",
            labels=labels_of_figure("control schematic", case_of_control_example),
        ),
    log:
        f"{RESULTS}/logs/figure_control_schematic.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_control_schematic.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_control_schematic"),
        runtime=runtime_of("figure_control_schematic"),
    params:
        settings=settings_of("figure_control_schematic"),
        code=code_of("figure_control_schematic"),
    message:
        "figure: schematic of control"
    script:
        "../scripts/figure_control_schematic.py"


rule figure_suppressed_event:
    input:
        event=control_example,
    output:
        pdf=f"{FIGURES}/suppressed_event.pdf",
        png=report(
            f"{FIGURES}/suppressed_event.png",
            caption="../report/suppressed_event.rst",
            category="Figures",
            labels=labels_of_figure("suppressed event", case_of_control_example),
        ),
    log:
        f"{RESULTS}/logs/figure_suppressed_event.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_suppressed_event.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_suppressed_event"),
        runtime=runtime_of("figure_suppressed_event"),
    params:
        settings=settings_of("figure_suppressed_event"),
        code=code_of("figure_suppressed_event"),
    message:
        "figure: a suppressed event"
    script:
        "../scripts/figure_suppressed_event.py"


rule figure_control_density:
    input:
        histograms=controlled_densities,
    output:
        table=f"{TABLES}/control_density{{of_case}}.csv",
        pdf=f"{FIGURES}/control_density{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/control_density{{of_case}}.png",
            caption="../report/control_density.rst",
            category="Figures",
            labels=labels_of_figure(
                "control density", campaign.case_of_control_figure
            ),
        ),
    log:
        f"{RESULTS}/logs/figure_control_density{{of_case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_control_density{{of_case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_control_density"),
        runtime=runtime_of("figure_control_density"),
    params:
        settings=settings_of("figure_control_density"),
        code=code_of("figure_control_density"),
    message:
        "figure: density of the observable with and without control"
    script:
        "../scripts/figure_control_density.py"


rule figure_control_tradeoff:
    input:
        percentiles=f"{TABLES}/control_percentiles.csv",
    output:
        pdf=f"{FIGURES}/control_tradeoff{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/control_tradeoff{{of_case}}.png",
            caption="../report/control_tradeoff.rst",
            category="Figures",
            labels=labels_of_figure(
                "control tradeoff", campaign.case_of_control_figure
            ),
        ),
    log:
        f"{RESULTS}/logs/figure_control_tradeoff{{of_case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_control_tradeoff{{of_case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_control_tradeoff"),
        runtime=runtime_of("figure_control_tradeoff"),
    params:
        settings=settings_of("figure_control_tradeoff"),
        code=code_of("figure_control_tradeoff"),
    message:
        "figure: what control achieves against how early and how much it acts"
    script:
        "../scripts/figure_control_tradeoff.py"

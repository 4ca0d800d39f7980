"""From all networks to the tables and figures."""


rule networks:
    # all that is computed network by network: the target for planning a large campaign in batches
    input:
        of_networks("network.nc"),
        of_networks("forecast.nc"),
        of_networks("horizon.nc"),
        of_networks("climate.nc", campaign.climate_networks),
        control_counts(),
    localrule: True


rule tables:
    input:
        expand(
            f"{TABLES}/{{table}}.{{suffix}}",
            table=campaign.report_tables,
            suffix=["csv", "tex"],
        ),
    localrule: True


rule figures:
    input:
        expand(
            f"{FIGURES}/{{figure}}.{{suffix}}",
            figure=campaign.figures,
            suffix=["pdf", "png"],
        ),
    localrule: True


rule dataset_table:
    input:
        dataset=of_cases("dataset.json"),
        events=of_cases("events.json"),
        lyapunov=of_cases("lyapunov.json"),
    output:
        table=report(
            f"{TABLES}/dataset.csv",
            caption="../report/dataset.rst",
            category="Tables",
            labels={"table": "dataset"},
        ),
    log:
        f"{RESULTS}/logs/dataset_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/dataset_table.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("dataset_table"),
        runtime=runtime_of("dataset_table"),
    params:
        settings=settings_of("dataset_table"),
        code=code_of("dataset_table"),
    message:
        "table of the dataset"
    script:
        "../scripts/dataset_table.py"


rule hyperparameters_table:
    input:
        hyperparameters=of_networks("hyperparameters.json"),
    output:
        table=f"{TABLES}/hyperparameters.csv",
    log:
        f"{RESULTS}/logs/hyperparameters_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/hyperparameters_table.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("hyperparameters_table"),
        runtime=runtime_of("hyperparameters_table"),
    params:
        settings=settings_of("hyperparameters_table"),
        code=code_of("hyperparameters_table"),
    message:
        "table of the hyperparameters"
    script:
        "../scripts/hyperparameters_table.py"


rule classify:
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
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("classify"),
        runtime=runtime_of("classify"),
    params:
        settings=settings_of("classify"),
        code=code_of("classify"),
    message:
        "score the forecasts"
    script:
        "../scripts/classify.py"


rule horizon_table:
    input:
        horizons=of_networks("horizon.nc"),
    output:
        table=f"{TABLES}/horizon.csv",
    log:
        f"{RESULTS}/logs/horizon_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/horizon_table.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("horizon_table"),
        runtime=runtime_of("horizon_table"),
    params:
        settings=settings_of("horizon_table"),
        code=code_of("horizon_table"),
    message:
        "table of the prediction horizons"
    script:
        "../scripts/horizon_table.py"


rule data_generation_parameters:
    input:
        datasets=of_cases("dataset.json"),
    output:
        table=report(
            f"{TABLES}/data_generation_parameters.csv",
            caption="../report/data_generation_parameters.rst",
            category="Tables",
            labels={"table": "data generation parameters"},
        ),
    log:
        f"{RESULTS}/logs/data_generation_parameters.log",
    benchmark:
        f"{RESULTS}/benchmarks/data_generation_parameters.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("data_generation_parameters"),
        runtime=runtime_of("data_generation_parameters"),
    params:
        settings=settings_of("data_generation_parameters"),
        code=code_of("data_generation_parameters"),
    message:
        "table of the parameters of the data"
    script:
        "../scripts/data_generation_parameters.py"


rule network_hyperparameters:
    output:
        table=report(
            f"{TABLES}/network_hyperparameters.csv",
            caption="../report/network_hyperparameters.rst",
            category="Tables",
            labels={"table": "network hyperparameters"},
        ),
    log:
        f"{RESULTS}/logs/network_hyperparameters.log",
    benchmark:
        f"{RESULTS}/benchmarks/network_hyperparameters.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("network_hyperparameters"),
        runtime=runtime_of("network_hyperparameters"),
    params:
        settings=settings_of("network_hyperparameters"),
        code=code_of("network_hyperparameters"),
    message:
        "table of the networks' hyperparameters"
    script:
        "../scripts/network_hyperparameters.py"


rule percentiles:
    input:
        table=f"{TABLES}/{{table}}.csv",
    output:
        table=report(
            f"{TABLES}/{{table}}_percentiles.csv",
            caption="../report/percentiles.rst",
            category="Tables",
            labels={"table": "{table}, percentiles"},
        ),
    log:
        f"{RESULTS}/logs/percentiles/{{table}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/percentiles/{{table}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("percentiles"),
        runtime=runtime_of("percentiles"),
    params:
        settings=settings_of("percentiles"),
        code=code_of("percentiles"),
    message:
        "percentiles over networks: {wildcards.table}"
    script:
        "../scripts/percentiles.py"


rule latex:
    input:
        table=f"{TABLES}/{{table}}.csv",
    output:
        latex=f"{TABLES}/{{table}}.tex",
    log:
        f"{RESULTS}/logs/latex/{{table}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/latex/{{table}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("latex"),
        runtime=runtime_of("latex"),
    params:
        settings=settings_of("latex"),
        code=code_of("latex"),
    message:
        "table in LaTeX: {wildcards.table}"
    script:
        "../scripts/latex.py"


rule figure_observable_and_density:
    input:
        ensemble=of_figure_case("ensemble.nc"),
        lyapunov=time_unit_of_figure,
    output:
        pdf=f"{FIGURES}/observable_and_density{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/observable_and_density{{of_case}}.png",
            caption="../report/observable_and_density.rst",
            category="Figures",
            labels=labels_of_figure("observable and density"),
        ),
    log:
        f"{RESULTS}/logs/figure_observable_and_density{{of_case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_observable_and_density{{of_case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_observable_and_density"),
        runtime=runtime_of("figure_observable_and_density"),
    params:
        settings=settings_of("figure_observable_and_density"),
        code=code_of("figure_observable_and_density"),
    message:
        "figure: typical evolution of the observable and its density"
    script:
        "../scripts/figure_observable_and_density.py"


rule figure_validation_strategies:
    input:
        ensemble=f"{EXAMPLE_CASE}/ensemble.nc",
        lyapunov=time_unit_of_figure,
    output:
        pdf=f"{FIGURES}/validation_strategies.pdf",
        png=report(
            f"{FIGURES}/validation_strategies.png",
            caption="../report/validation_strategies.rst",
            category="Figures",
            labels=labels_of_figure("validation strategies"),
        ),
    log:
        f"{RESULTS}/logs/figure_validation_strategies.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_validation_strategies.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_validation_strategies"),
        runtime=runtime_of("figure_validation_strategies"),
    params:
        settings=settings_of("figure_validation_strategies"),
        code=code_of("figure_validation_strategies"),
    message:
        "figure: validation strategies"
    script:
        "../scripts/figure_validation_strategies.py"


rule figure_network_schematic:
    input:
        hyperparameters=f"{EXAMPLE}/hyperparameters.json",
    output:
        pdf=f"{FIGURES}/network_schematic.pdf",
        png=report(
            f"{FIGURES}/network_schematic.png",
            caption="../report/network_schematic.rst",
            category="Figures",
            labels=labels_of_figure("network schematic"),
        ),
    log:
        f"{RESULTS}/logs/figure_network_schematic.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_network_schematic.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_network_schematic"),
        runtime=runtime_of("figure_network_schematic"),
    params:
        settings=settings_of("figure_network_schematic"),
        code=code_of("figure_network_schematic"),
    message:
        "figure: schematic of the network"
    script:
        "../scripts/figure_network_schematic.py"


rule figure_search_landscape:
    input:
        searches=example_searches(),
    output:
        pdf=f"{FIGURES}/search_landscape.pdf",
        png=report(
            f"{FIGURES}/search_landscape.png",
            caption="../report/search_landscape.rst",
            category="Figures",
            labels=labels_of_figure("search landscape"),
        ),
    log:
        f"{RESULTS}/logs/figure_search_landscape.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_search_landscape.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_search_landscape"),
        runtime=runtime_of("figure_search_landscape"),
    params:
        settings=settings_of("figure_search_landscape"),
        code=code_of("figure_search_landscape"),
    message:
        "figure: what the search for hyperparameters saw"
    script:
        "../scripts/figure_search_landscape.py"


rule figure_prediction_schematic:
    input:
        examples=f"{EXAMPLE}/examples.nc",
    output:
        pdf=f"{FIGURES}/prediction_schematic.pdf",
        png=report(
            f"{FIGURES}/prediction_schematic.png",
            caption="../report/prediction_schematic.rst",
            category="Figures",
            labels=labels_of_figure("prediction schematic"),
        ),
    log:
        f"{RESULTS}/logs/figure_prediction_schematic.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_prediction_schematic.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_prediction_schematic"),
        runtime=runtime_of("figure_prediction_schematic"),
    params:
        settings=settings_of("figure_prediction_schematic"),
        code=code_of("figure_prediction_schematic"),
    message:
        "figure: schematic of a prediction"
    script:
        "../scripts/figure_prediction_schematic.py"


rule figure_prediction_examples:
    input:
        examples=f"{EXAMPLE}/examples.nc",
    output:
        pdf=f"{FIGURES}/prediction_examples.pdf",
        png=report(
            f"{FIGURES}/prediction_examples.png",
            caption="../report/prediction_examples.rst",
            category="Figures",
            labels=labels_of_figure("prediction examples"),
        ),
    log:
        f"{RESULTS}/logs/figure_prediction_examples.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_prediction_examples.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_prediction_examples"),
        runtime=runtime_of("figure_prediction_examples"),
    params:
        settings=settings_of("figure_prediction_examples"),
        code=code_of("figure_prediction_examples"),
    message:
        "figure: a true positive, a false positive and a false negative"
    script:
        "../scripts/figure_prediction_examples.py"


rule figure_classification_scores:
    input:
        percentiles=f"{TABLES}/classification_percentiles.csv",
        published=published(),
    output:
        pdf=f"{FIGURES}/classification_scores{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/classification_scores{{of_case}}.png",
            caption="../report/classification_scores.rst",
            category="Figures",
            labels=labels_of_figure("classification scores"),
        ),
    log:
        f"{RESULTS}/logs/figure_classification_scores{{of_case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_classification_scores{{of_case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_classification_scores"),
        runtime=runtime_of("figure_classification_scores"),
    params:
        settings=settings_of("figure_classification_scores"),
        code=code_of("figure_classification_scores"),
    message:
        "figure: precision, recall and F-score"
    script:
        "../scripts/figure_classification_scores.py"


rule figure_horizon_schematic:
    output:
        pdf=f"{FIGURES}/horizon_schematic.pdf",
        png=report(
            f"{FIGURES}/horizon_schematic.png",
            caption="../report/horizon_schematic.rst",
            category="Figures",
            labels=labels_of_figure("horizon schematic"),
        ),
    log:
        f"{RESULTS}/logs/figure_horizon_schematic.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_horizon_schematic.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_horizon_schematic"),
        runtime=runtime_of("figure_horizon_schematic"),
    params:
        settings=settings_of("figure_horizon_schematic"),
        code=code_of("figure_horizon_schematic"),
    message:
        "figure: schematic of the prediction horizon of extreme events"
    script:
        "../scripts/figure_horizon_schematic.py"


rule figure_horizon_evaluations:
    input:
        examples=f"{EXAMPLE}/examples.nc",
    output:
        pdf=f"{FIGURES}/horizon_evaluations.pdf",
        png=report(
            f"{FIGURES}/horizon_evaluations.png",
            caption="../report/horizon_evaluations.rst",
            category="Figures",
            labels=labels_of_figure("horizon evaluations"),
        ),
    log:
        f"{RESULTS}/logs/figure_horizon_evaluations.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_horizon_evaluations.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_horizon_evaluations"),
        runtime=runtime_of("figure_horizon_evaluations"),
    params:
        settings=settings_of("figure_horizon_evaluations"),
        code=code_of("figure_horizon_evaluations"),
    message:
        "figure: last evaluations before an event is predicted"
    script:
        "../scripts/figure_horizon_evaluations.py"


rule figure_horizon_by_size:
    input:
        percentiles=f"{TABLES}/horizon_percentiles.csv",
        published=published(),
    output:
        pdf=f"{FIGURES}/horizon_by_size{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/horizon_by_size{{of_case}}.png",
            caption="../report/horizon_by_size.rst",
            category="Figures",
            labels=labels_of_figure("horizon by size"),
        ),
    log:
        f"{RESULTS}/logs/figure_horizon_by_size{{of_case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_horizon_by_size{{of_case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_horizon_by_size"),
        runtime=runtime_of("figure_horizon_by_size"),
    params:
        settings=settings_of("figure_horizon_by_size"),
        code=code_of("figure_horizon_by_size"),
    message:
        "figure: prediction horizon of extreme events against reservoir size"
    script:
        "../scripts/figure_horizon_by_size.py"


rule figure_by_reynolds:
    input:
        horizon=f"{TABLES}/horizon_percentiles.csv",
        classification=f"{TABLES}/classification_percentiles.csv",
        published=published(),
    output:
        pdf=f"{FIGURES}/by_reynolds.pdf",
        png=report(
            f"{FIGURES}/by_reynolds.png",
            caption="../report/by_reynolds.rst",
            category="Figures",
            labels=labels_of_figure("by reynolds"),
        ),
    log:
        f"{RESULTS}/logs/figure_by_reynolds.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_by_reynolds.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_by_reynolds"),
        runtime=runtime_of("figure_by_reynolds"),
    params:
        settings=settings_of("figure_by_reynolds"),
        code=code_of("figure_by_reynolds"),
    message:
        "figure: prediction horizon and F-score against the Reynolds number"
    script:
        "../scripts/figure_by_reynolds.py"

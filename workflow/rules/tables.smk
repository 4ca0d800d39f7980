"""Tables: gathered from the files of many jobs, then percentiles and LaTeX."""


rule dataset_table:
    input:
        summaries=of_cases("dataset.json"),
        events=of_cases("events.json"),
        exponents=of_cases("lyapunov.json"),
    output:
        table=report(
            f"{TABLES}/dataset.csv",
            caption="../report/dataset.rst",
            category="Tables",
            labels={"table": "dataset"},
        ),
    log:
        f"{LOGS}/dataset_table.log",
    benchmark:
        f"{TIMES}/dataset_table.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads("tables/dataset_table.py", cases=campaign.of_each_case(*listed("TIME"))),
    message:
        "table of the dataset"
    script:
        "../scripts/tables/dataset_table.py"


rule hyperparameters_table:
    input:
        hyperparameters=of_forecasters("hyperparameters.json", campaign.networks),
    output:
        table=f"{TABLES}/hyperparameters.csv",
    log:
        f"{LOGS}/hyperparameters_table.log",
    benchmark:
        f"{TIMES}/hyperparameters_table.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads(
            "tables/hyperparameters_table.py", rows=campaign.keys(campaign.networks)
        ),
    message:
        "table of the hyperparameters"
    script:
        "../scripts/tables/hyperparameters_table.py"


rule classification_table:
    input:
        forecasts=of_forecasters("forecast.nc"),
        evaluation_sets=of_cases("evaluation_set.nc"),
    output:
        table=f"{TABLES}/classification.csv",
        intervals=f"{TABLES}/classification_intervals.csv",
    log:
        f"{LOGS}/classification_table.log",
    benchmark:
        f"{TIMES}/classification_table.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("bootstrap"),
    params:
        **reads(
            "tables/classification_table.py",
            "random_seed bootstrap classification.prediction_times_lt "
            "classification.window_lt classification.resolution_lt",
            cases=campaign.of_each_case("case.event_threshold"),
            rows=campaign.keys(campaign.forecasters),
        ),
    message:
        "score the forecasts"
    script:
        "../scripts/tables/classification_table.py"


rule horizon_table:
    input:
        horizons=of_forecasters("horizon.nc"),
    output:
        table=f"{TABLES}/horizon.csv",
    log:
        f"{LOGS}/horizon_table.log",
    benchmark:
        f"{TIMES}/horizon_table.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads("tables/horizon_table.py", rows=campaign.keys(campaign.forecasters)),
    message:
        "table of the prediction horizons"
    script:
        "../scripts/tables/horizon_table.py"


rule statistics_table:
    input:
        data=of_cases("statistics_data.nc"),
        training=of_cases("statistics_training.nc"),
        floor=of_cases("statistics_floor.nc"),
        long_term=of_forecasters("long_term.nc", campaign.long_term_forecasters),
    output:
        table=f"{TABLES}/statistics.csv",
    log:
        f"{LOGS}/statistics_table.log",
    benchmark:
        f"{TIMES}/statistics_table.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads(
            "tables/statistics_table.py",
            "statistics.profile_points",
            cases=campaign.of_each_case(*listed("SYSTEM")),
            rows=campaign.keys(campaign.long_term_forecasters),
        ),
    message:
        "table of the long-term statistics"
    script:
        "../scripts/tables/statistics_table.py"


rule control_table:
    input:
        counts=of_control(".json"),
    output:
        table=f"{TABLES}/control.csv",
    log:
        f"{LOGS}/control_table.log",
    benchmark:
        f"{TIMES}/control_table.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads("tables/control_table.py", rows=campaign.control_keys()),
    message:
        "table of control"
    script:
        "../scripts/tables/control_table.py"


rule control_density_table:
    input:
        histograms=of_control(".nc"),
    output:
        table=f"{TABLES}/control_density.csv",
    log:
        f"{LOGS}/control_density_table.log",
    benchmark:
        f"{TIMES}/control_density_table.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads("tables/control_density_table.py", rows=campaign.control_keys()),
    message:
        "densities with and without control"
    script:
        "../scripts/tables/control_density_table.py"


rule data_generation_parameters:
    input:
        summaries=of_cases("dataset.json"),
    output:
        table=report(
            f"{TABLES}/data_generation_parameters.csv",
            caption="../report/data_generation_parameters.rst",
            category="Tables",
            labels={"table": "data generation parameters"},
        ),
    log:
        f"{LOGS}/data_generation_parameters.log",
    benchmark:
        f"{TIMES}/data_generation_parameters.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads(
            "tables/data_generation_parameters.py",
            cases=campaign.of_each_case(
                *listed(
                    "SYSTEM case.ensemble.time_step case.ensemble.duration case.training.series"
                    " case.laminarisation_threshold case.event_threshold"
                )
            ),
        ),
    message:
        "table of the parameters of the data"
    script:
        "../scripts/tables/data_generation_parameters.py"


rule network_hyperparameters:
    output:
        table=report(
            f"{TABLES}/network_hyperparameters.csv",
            caption="../report/network_hyperparameters.rst",
            category="Tables",
            labels={"table": "network hyperparameters"},
        ),
    log:
        f"{LOGS}/network_hyperparameters.log",
    benchmark:
        f"{TIMES}/network_hyperparameters.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads(
            "tables/network_hyperparameters.py",
            "forecasters.esn.connectivity forecasters.esn.input_bias "
            "search.spectral_radius search.input_scaling search.tikhonov",
            cases=campaign.of_each_case("case.training.noise"),
        ),
    message:
        "table of the networks' hyperparameters"
    script:
        "../scripts/tables/network_hyperparameters.py"


rule percentiles:
    input:
        table=f"{TABLES}/{{table}}.csv",
    output:
        percentiles=report(
            f"{TABLES}/{{table}}_percentiles.csv",
            caption="../report/percentiles.rst",
            category="Tables",
            labels={"table": "{table}, percentiles"},
        ),
    log:
        f"{LOGS}/percentiles/{{table}}.log",
    benchmark:
        f"{TIMES}/percentiles/{{table}}.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads("tables/percentiles.py"),
    message:
        "percentiles over networks: {wildcards.table}"
    script:
        "../scripts/tables/percentiles.py"


rule latex:
    input:
        table=f"{TABLES}/{{table}}.csv",
    output:
        latex=f"{TABLES}/{{table}}.tex",
    log:
        f"{LOGS}/latex/{{table}}.log",
    benchmark:
        f"{TIMES}/latex/{{table}}.tsv"
    group:
        "tables"
    conda:
        ENVIRONMENT
    resources:
        **needs("gather"),
    params:
        **reads("tables/latex.py"),
    message:
        "table in LaTeX: {wildcards.table}"
    script:
        "../scripts/tables/latex.py"


rule tables:
    input:
        expand(
            f"{TABLES}/{{table}}.{{suffix}}",
            table=campaign.table_names,
            suffix=["csv", "tex"],
        ),
    localrule: True


rule forecasters:
    # all that is computed forecaster by forecaster: the target for planning a large campaign in batches
    input:
        of_forecasters("forecaster.nc"),
        of_forecasters("forecast.nc"),
        of_forecasters("horizon.nc"),
        of_forecasters("long_term.nc", campaign.long_term_forecasters),
        of_control(".json"),
    localrule: True

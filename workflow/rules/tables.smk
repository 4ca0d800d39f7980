"""Tables: each case's, gathered from the files of many jobs; then of all cases, and LaTeX."""

from burstcast_workflow.tables.registry import cases_of_tables, latex_names, table_names

table_stage(
    "dataset_table",
    "table of the dataset",
    inputs={
        **files("summary events_summary"),
        # a case that is a part of another one has that one's
        "exponents": of_case(
            lambda campaign, case: f"{RESULTS}/{campaign.source_case(case)}/lyapunov.json"
        ),
    },
    settings="KEYS TIME",
)
table_stage(
    "hyperparameters_table",
    "table of the hyperparameters",
    inputs={
        "hyperparameters": files_in_case(
            campaign.hyperparameters_file, campaign.searched_networks
        )
    },
    settings="KEYS",
)
table_stage(
    "classification_table",
    "score the forecasts",
    inputs={
        "forecasts": files_in_case("forecast.nc"),
        **files("evaluation_set"),
        # the alarm thresholds of forecasters that give probabilities
        "calibration": stages.file_of_case(
            "calibration.json",
            {one.case for one in campaign.forecasters if not one.kind.has_trajectories},
        ),
    },
    settings="KEYS SCORED case.event_threshold",
    cost="bootstrap",
)
table_stage(
    "horizon_table",
    "table of the prediction horizons",
    inputs={"horizons": files_in_case("horizon.nc", campaign.horizon_forecasters)},
    settings="KEYS random_seed bootstrap",
)
table_stage(
    "statistics_table",
    "table of the long-term statistics",
    inputs={
        **files("data training floor"),
        "long_term": files_in_case("long_term.nc", campaign.long_term_forecasters),
    },
    settings="SYSTEM random_seed bootstrap statistics.profile_points",
    cost="bootstrap_runs",
)
table_stage(
    "survival_table",
    "table of escapes from the chaotic phase",
    inputs={
        **files("ensemble"),
        "long_term": files_in_case("long_term.nc", campaign.long_term_forecasters),
    },
    settings="KEYS STEPS statistics.duration bootstrap.confidence",
)
table_stage(
    "lyapunov_spectrum_table",
    "table of the Lyapunov exponents",
    inputs={
        "spectrum": stages.file_of_case(
            "lyapunov_spectrum.nc", campaign.simulated_cases
        ),
        "forecasters": files_in_case(
            "lyapunov_spectrum.nc", campaign.spectrum_forecasters
        ),
    },
    settings="KEYS random_seed bootstrap",
)
table_stage(
    "control_table",
    "table of control",
    inputs={"flows": files_in_case("flows.nc", campaign.control_runs)},
    settings="KEYS",
)
table_stage(
    "control_density_table",
    "densities with and without control",
    inputs={"flows": files_in_case("flows.nc", campaign.control_runs)},
    settings="KEYS random_seed bootstrap",
)
table_stage(
    "control_strategies_table",
    "costs and gains of control",
    inputs={"flows": files_in_case("flows.nc", campaign.strategy_runs)},
    settings="KEYS case.training.noise random_seed bootstrap",
)
table_stage(
    "control_choice_table",
    "strategies at their best",
    inputs={"flows": files_in_case("flows.nc", campaign.chosen_runs)},
    settings="KEYS case.training.noise control.tolerated_exceedance random_seed bootstrap",
)
table_stage(
    "warnings_table",
    "look for warning signs",
    inputs={
        **files("ensemble data events_summary calibration_set"),
        **stages.tables_of_case("dataset classification hyperparameters statistics"),
        # where the unit of time is an estimate that it may contradict
        "lyapunov_spectrum": stages.file_of_case(
            "tables/lyapunov_spectrum.csv",
            set(cases_of(campaign, "lyapunov_spectrum"))
            & set(filter(campaign.estimates_time_unit, campaign.case_names)),
        ),
    },
    settings="KEYS SYSTEM case.event_threshold case.training.series case.training.noise "
    "horizon.events search.spectral_radius search.input_scaling search.tikhonov",
)
parameter_stage(
    "data_generation_parameters",
    "table of the parameters of the data",
    inputs={"summaries": of_cases("dataset.json", campaign.simulated_cases)},
    cases=campaign.settings_of_cases(
        *("SYSTEM", "case.ensemble.time_step", "case.ensemble.duration"),
        *("case.training.series", "case.laminarisation_threshold"),
        "case.event_threshold",
        cases=campaign.simulated_cases,
    ),
)
parameter_stage(
    "network_hyperparameters",
    "table of the networks' hyperparameters",
    settings="forecasters.esn.connectivity forecasters.esn.input_bias "
    "search.spectral_radius search.input_scaling search.tikhonov",
    cases=campaign.settings_of_cases("case.training.noise"),
)
# tables whose scatter over seeds is separated from the scatter over training sets
scattered = [
    name
    for name in ("classification", "horizon", "statistics", "survival")
    if name in cases_of_tables(campaign)
]
stage(
    "tables/training_realisations",
    "scatter over training sets and over seeds",
    inputs={"scores": [f"{TABLES}/{name}.csv" for name in scattered]},
    outputs={"tables": [in_report("training_realisations")]},
    tables=written(["training_realisations"]),
    scattered=written(scattered),
    kinds=sorted({one.name.keys["forecaster"] for one in campaign.forecasters}),
)


rule tables:
    input:
        # what they are made from is asked for, too (see the Snakefile)
        of_cases("calibration.json"),
        [
            f"{RESULTS}/{case}/tables/{table}.csv"
            for table, cases in cases_of_tables(campaign).items()
            for case in cases
        ],
        expand(f"{TABLES}/{{table}}.csv", table=table_names(campaign)),
        expand(f"{TABLES}/{{table}}.tex", table=latex_names(campaign)),
    localrule: True


rule forecasters:
    # all that is computed forecaster by forecaster: the target for planning a large campaign in batches
    input:
        of_cases("lengths.json", campaign.computed_times),
        of_forecasters("forecaster.nc", campaign.fitted_forecasters),
        of_forecasters("forecast.nc"),
        of_forecasters("calibration_forecast.nc", campaign.fitted_forecasters),
        of_forecasters("horizon.nc", campaign.horizon_forecasters),
        of_forecasters("long_term.nc", campaign.long_term_forecasters),
        of_forecasters("lyapunov_spectrum.nc", campaign.spectrum_forecasters),
        of_forecasters("flows.nc", campaign.strategy_runs),
    localrule: True

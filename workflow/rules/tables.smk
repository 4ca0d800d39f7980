"""Tables: gathered from the files of many jobs, then percentiles and LaTeX."""

# The case whose Lyapunov exponents each case has.
EXPONENTS_OF = {case: campaign.source_case(case) for case in campaign.case_names}

stage(
    "tables/dataset_table",
    "table of the dataset",
    inputs={
        "summaries": of_cases("dataset.json"),
        "events": of_cases("events.json"),
        "exponents": of_cases("lyapunov.json", dict.fromkeys(EXPONENTS_OF.values())),
    },
    outputs={"table": in_report("dataset")},
    cases=campaign.of_each_case(*listed("TIME")),
    exponents_of=EXPONENTS_OF,
)
stage(
    "tables/hyperparameters_table",
    "table of the hyperparameters",
    inputs={
        "hyperparameters": of_forecasters("hyperparameters.json", campaign.networks)
    },
    outputs={"table": f"{TABLES}/hyperparameters.csv"},
    rows=campaign.keys(campaign.networks),
)
stage(
    "tables/classification_table",
    "score the forecasts",
    inputs={
        "forecasts": of_forecasters("forecast.nc"),
        "evaluation_sets": of_cases("evaluation_set.nc"),
    },
    outputs={
        "table": f"{TABLES}/classification.csv",
        "intervals": f"{TABLES}/classification_intervals.csv",
    },
    settings="random_seed bootstrap classification.prediction_times_lt "
    "classification.window_lt classification.resolution_lt",
    cost="bootstrap",
    cases=campaign.of_each_case("case.event_threshold"),
    rows=campaign.keys(campaign.forecasters),
)
stage(
    "tables/horizon_table",
    "table of the prediction horizons",
    inputs={"horizons": of_forecasters("horizon.nc")},
    outputs={
        "table": f"{TABLES}/horizon.csv",
        "intervals": f"{TABLES}/horizon_intervals.csv",
    },
    settings="random_seed bootstrap",
    rows=campaign.keys(campaign.forecasters),
)
stage(
    "tables/statistics_table",
    "table of the long-term statistics",
    inputs={
        "data": of_cases("statistics_data.nc"),
        "training": of_cases("statistics_training.nc"),
        "floor": of_cases("statistics_floor.nc"),
        "long_term": of_forecasters("long_term.nc", campaign.long_term_forecasters),
    },
    outputs={
        "table": f"{TABLES}/statistics.csv",
        "intervals": f"{TABLES}/statistics_intervals.csv",
    },
    settings="random_seed bootstrap statistics.profile_points",
    cost="bootstrap_runs",
    cases=campaign.of_each_case(*listed("SYSTEM")),
    rows=campaign.keys(campaign.long_term_forecasters),
)
stage(
    "tables/survival_table",
    "table of escapes from the chaotic phase",
    inputs={
        "data": of_cases("ensemble.nc"),
        "long_term": of_forecasters("long_term.nc", campaign.long_term_forecasters),
    },
    outputs={
        "table": f"{TABLES}/survival.csv",
        "curves": f"{TABLES}/survival_curve.csv",
    },
    settings="bootstrap.confidence",
    cases=campaign.of_each_case(
        "case.ensemble.time_step",
        "case.ensemble.sampling_stride",
        "statistics.duration",
    ),
    rows=campaign.keys(campaign.long_term_forecasters),
)
stage(
    "tables/lyapunov_spectrum_table",
    "table of the Lyapunov exponents",
    inputs={
        "data": of_cases("lyapunov_spectrum.nc", campaign.simulated_cases),
        "forecasters": of_forecasters(
            "lyapunov_spectrum.nc", campaign.spectrum_forecasters
        ),
    },
    outputs={
        "table": f"{TABLES}/lyapunov_spectrum.csv",
        "dimensions": f"{TABLES}/kaplan_yorke.csv",
    },
    settings="random_seed bootstrap",
    cases=campaign.of_each_case(cases=campaign.simulated_cases),
    rows=campaign.keys(campaign.spectrum_forecasters),
)
stage(
    "tables/control_table",
    "table of control",
    inputs={"counts": of_control("counts.json")},
    outputs={"table": f"{TABLES}/control.csv"},
    rows=campaign.control_keys(),
)
stage(
    "tables/control_density_table",
    "densities with and without control",
    inputs={"histograms": of_control("histograms.nc")},
    outputs={"table": f"{TABLES}/control_density.csv"},
    rows=campaign.control_keys(),
)
stage(
    "tables/control_strategies_table",
    "costs and gains of control",
    inputs={"flows": of_control("flows.nc", campaign.strategy_runs)},
    outputs={"table": in_report("control_strategies")},
    settings="random_seed bootstrap",
    rows=campaign.strategy_keys(),
)
stage(
    "tables/data_generation_parameters",
    "table of the parameters of the data",
    inputs={"summaries": of_cases("dataset.json", campaign.simulated_cases)},
    outputs={"table": in_report("data_generation_parameters")},
    cases=campaign.of_each_case(
        *listed("SYSTEM case.ensemble.time_step case.ensemble.duration"),
        *listed("case.training.series case.laminarisation_threshold"),
        "case.event_threshold",
        cases=campaign.simulated_cases,
    ),
)
stage(
    "tables/network_hyperparameters",
    "table of the networks' hyperparameters",
    outputs={"table": in_report("network_hyperparameters")},
    settings="forecasters.esn.connectivity forecasters.esn.input_bias "
    "search.spectral_radius search.input_scaling search.tikhonov",
    cases=campaign.of_each_case("case.training.noise"),
)
stage(
    "tables/percentiles",
    "percentiles over networks",
    inputs={"table": f"{TABLES}/{{table}}.csv"},
    outputs={"percentiles": in_report("{table}_percentiles", caption="percentiles")},
)
stage(
    "tables/latex",
    "typeset in LaTeX",
    inputs={"table": f"{TABLES}/{{table}}.csv"},
    outputs={"latex": f"{TABLES}/{{table}}.tex"},
)


rule tables:
    input:
        expand(
            f"{TABLES}/{{table}}.{{suffix}}",
            table=campaign.table_names,
            suffix=["csv", "tex"],
        ),
        rules.probabilities.input,
    localrule: True


rule forecasters:
    # all that is computed forecaster by forecaster: the target for planning a large campaign in batches
    input:
        of_forecasters("forecaster.nc"),
        of_forecasters("forecast.nc"),
        of_forecasters("calibration_forecast.nc"),
        of_forecasters("member_forecast.nc", campaign.ensemble_forecasters),
        of_forecasters("calibration_member_forecast.nc", campaign.ensemble_forecasters),
        of_forecasters("horizon.nc"),
        of_forecasters("long_term.nc", campaign.long_term_forecasters),
        of_forecasters("lyapunov_spectrum.nc", campaign.spectrum_forecasters),
        of_control("flows.nc", campaign.strategy_runs),
    localrule: True

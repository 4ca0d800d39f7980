"""Tables: each case's, gathered from the files of many jobs; then of all cases, and LaTeX."""

from burstcast_workflow.campaign.job_settings import settings_of_cases
from burstcast_workflow.tables.jobs import caption_of, in_report
from burstcast_workflow.tables.registry import (
    cases_of,
    cases_of_tables,
    joined,
    latex_names,
    made_by,
    table_names,
    tables_by_section,
    typeset,
    with_percentiles,
    written,
)

# What tables of probabilities are made from.
PROBABILITIES = {
    "forecasts": files_in_case("forecast.nc"),
    "evaluation_set": "<results>/{case}/evaluation_set.nc",
    "calibration": "<results>/{case}/calibration.json",
}
# Inputs of the rules that make tables of a case, by the name of their module in
# burstcast.tables.makers.
TABLE_RULES = {
    "dataset_table": {
        "summary": "<results>/{case}/dataset.json",
        "events_summary": "<results>/{case}/events.json",
        # a case that is a part of another one has that one's
        "exponents": for_case(
            lambda case: f"<results>/{case.source.name}/lyapunov.json"
        ),
    },
    "hyperparameters_table": {
        "hyperparameters": files_in_case(
            "hyperparameters.json", campaign.searched_networks
        )
    },
    "classification_table": {
        "forecasts": files_in_case("forecast.nc"),
        "evaluation_set": "<results>/{case}/evaluation_set.nc",
        # the alarm thresholds of forecasters that give probabilities
        "calibration": stages.file_of_case(
            "calibration.json",
            {one.case for one in campaign.forecasters if not one.kind.has_trajectories},
        ),
    },
    "probability_scores": PROBABILITIES,
    "reliability_table": PROBABILITIES,
    "ranking_table": PROBABILITIES,
    "lead_times": {"ensemble": "<results>/{case}/ensemble.nc", **PROBABILITIES},
    "horizon_table": {
        "horizons": files_in_case("horizon.nc", campaign.trajectory_forecasters)
    },
    "statistics_table": {
        "data": "<results>/{case}/statistics_data.nc",
        "training": "<results>/{case}/statistics_training.nc",
        "floor": "<results>/{case}/statistics_floor.nc",
        "long_term": files_in_case("long_term.nc", campaign.long_term_forecasters),
    },
    "survival_table": {
        "ensemble": "<results>/{case}/ensemble.nc",
        "long_term": files_in_case("long_term.nc", campaign.long_term_forecasters),
    },
    "lyapunov_spectrum_table": {
        "spectrum": stages.file_of_case(
            "lyapunov_spectrum.nc", campaign.simulated_cases
        ),
        "forecasters": files_in_case(
            "lyapunov_spectrum.nc", campaign.spectrum_forecasters
        ),
    },
    "control_table": {"flows": files_in_case("flows.nc", campaign.control_runs)},
    "control_density_table": {
        "flows": files_in_case("flows.nc", campaign.control_runs)
    },
    "control_strategies_table": {
        "flows": files_in_case("flows.nc", campaign.strategy_runs)
    },
    "control_choice_table": {"flows": files_in_case("flows.nc", campaign.chosen_runs)},
    "warnings_table": {
        "ensemble": "<results>/{case}/ensemble.nc",
        "data": "<results>/{case}/statistics_data.nc",
        "events_summary": "<results>/{case}/events.json",
        "calibration_set": "<results>/{case}/calibration_set.nc",
        **stages.tables_of_case("dataset classification hyperparameters statistics"),
        # where the unit of time is an estimate that it may contradict
        "lyapunov_spectrum": stages.file_of_case(
            "tables/lyapunov_spectrum.csv",
            set(cases_of(campaign, "lyapunov_spectrum"))
            & set(campaign.where(lambda case: case.estimates_time_unit)),
        ),
    },
}
# Tables that each rule makes (workflow/tables.yaml declares them), percentiles beside them.
FILES = {name: with_percentiles(made_by(name)) for name in TABLE_RULES}
# -- tables of a case --------------------------------------------------------------------------------

for name, inputs in TABLE_RULES.items():

    rule:
        name:
            name
        input:
            **inputs,
            **computed_settings(name),
        output:
            tables=[f"<results>/{{case}}/tables/{file}.csv" for file in FILES[name]],
        log:
            f"<logs>/{name}/{{case}}.log",
        group:
            "tables"
        conda:
            "../envs/burstcast.yaml"
        resources:
            **resources_of("short"),
        params:
            *of_script(
                "tables/table.py",
                name,
                maker=name,
                by_name={"burstcast.tables.makers": [name]},
                tables=written(made_by(name), campaign.unused_columns),
            ),
            maker=name,
        script:
            "../scripts/tables/table.py"


# -- tables of all cases -----------------------------------------------------------------------------

for section, files in tables_by_section(campaign).items():

    # a section of the report at once, and LaTeX for papers; no other job reads these
    rule:
        name:
            f"joined_{section}"
        input:
            of_cases=[
                path
                for file in files
                for path in case_files(f"tables/{file}.csv", cases_of(campaign, file))
            ],
        output:
            tables=[in_report(file) for file in files],
            latex=[f"<results>/tables/{paper}.tex" for paper in typeset(files)],
        log:
            f"<logs>/joined_{section}.log",
        group:
            "tables"
        conda:
            "../envs/burstcast.yaml"
        resources:
            **resources_of("short"),
        params:
            *of_script(
                "tables/joined.py",
                f"joined_{section}",
                columns=joined(files, campaign.unused_columns),
                latex=typeset(files),
            ),
        script:
            "../scripts/tables/joined.py"


# -- tables of the whole campaign --------------------------------------------------------------------


rule data_generation_parameters:
    input:
        **computed_settings("data_generation_parameters"),
        summaries=case_files("dataset.json", campaign.simulated_cases),
    output:
        table=in_report("data_generation_parameters"),
        latex="<results>/tables/data_generation_parameters.tex",
    log:
        "<logs>/data_generation_parameters.log",
    group:
        "tables"
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("short"),
    params:
        *of_script(
            "tables/data_generation_parameters.py",
            caption=caption_of("data_generation_parameters"),
            cases=settings_of_cases(
                campaign,
                stages.declared("tables/data_generation_parameters.py", "CaseData"),
                campaign.simulated_cases,
            ),
        ),
    script:
        "../scripts/tables/data_generation_parameters.py"


rule network_hyperparameters:
    output:
        table=in_report("network_hyperparameters"),
        latex="<results>/tables/network_hyperparameters.tex",
    log:
        "<logs>/network_hyperparameters.log",
    group:
        "tables"
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("short"),
    params:
        *of_script(
            "tables/network_hyperparameters.py",
            caption=caption_of("network_hyperparameters"),
            cases=settings_of_cases(
                campaign,
                stages.declared("tables/network_hyperparameters.py", "CaseInputs"),
            ),
        ),
    script:
        "../scripts/tables/network_hyperparameters.py"


# tables whose scatter over seeds is separated from the scatter over training sets
SCATTERED = [
    name
    for name in ("classification", "horizon", "statistics", "survival")
    if name in cases_of_tables(campaign)
]


rule training_realisations:
    input:
        scores=[f"<results>/tables/{name}.csv" for name in SCATTERED],
    output:
        tables=[in_report("training_realisations")],
    log:
        "<logs>/training_realisations.log",
    group:
        "tables"
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("short"),
    params:
        *of_script(
            "tables/training_realisations.py",
            tables=written(["training_realisations"]),
            scattered=written(SCATTERED),
            kinds=sorted(
                {one.name.keys["forecaster"] for one in campaign.forecasters}
            ),
        ),
    script:
        "../scripts/tables/training_realisations.py"


rule tables:
    input:
        # what they are made from is asked for, too (see the Snakefile)
        case_files("calibration.json"),
        [
            f"<results>/{case}/tables/{table}.csv"
            for table, cases in cases_of_tables(campaign).items()
            for case in cases
        ],
        expand("<results>/tables/{table}.csv", table=table_names(campaign)),
        expand("<results>/tables/{table}.tex", table=latex_names(campaign)),
    localrule: True


rule forecasters:
    # all that is computed forecaster by forecaster: the target for planning a large campaign in batches
    input:
        case_files("lengths.json", campaign.where(lambda case: case.time_unit)),
        forecaster_files("forecaster.nc"),
        forecaster_files("forecast.nc"),
        forecaster_files("calibration_forecast.nc"),
        forecaster_files("horizon.nc", campaign.trajectory_forecasters),
        forecaster_files("long_term.nc", campaign.long_term_forecasters),
        forecaster_files("lyapunov_spectrum.nc", campaign.spectrum_forecasters),
        forecaster_files("flows.nc", campaign.strategy_runs),
    localrule: True

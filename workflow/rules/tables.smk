"""Tables: each case's, gathered from the files of many jobs; then of all cases, and LaTeX."""

from burstcast_workflow.campaign.job_settings import settings_of_cases
from burstcast_workflow.jobs.forecasters import CaseInputs
from burstcast_workflow.jobs.cases import CaseData
from burstcast_workflow.tables.declarations import TABLES
from burstcast_workflow.tables.registry import (
    MAKERS,
    cases_of_tables,
    files_by,
    in_report,
    joined,
    kinds_of,
    latex_names,
    table_names,
    tables_by_section,
    typeset,
    written,
)

# -- tables of a case --------------------------------------------------------------------------------

for name in MAKERS:

    rule:
        name:
            name
        input:
            **stages.inputs_of_tables(name),
        output:
            tables=[f"<results>/{{case}}/tables/{file}.csv" for file in files_by(name)],
        log:
            f"<logs>/{name}/{{case}}.log",
        group:
            "tables"
        resources:
            **resources_of("short"),
        params:
            settings=stages.settings_of_table(name),
            maker=name,
        script:
            "../scripts/tables/table.py"


# -- tables of all cases -----------------------------------------------------------------------------

for section, files in tables_by_section(campaign).items():
    # a section of the report at once, and LaTeX for papers; no other job reads these
    rule_name = f"joined_{section}"

    rule:
        name:
            rule_name
        input:
            of_cases=[path for file in files for path in stages.table_files(file)],
        output:
            tables=[in_report(file) for file in files],
            latex=[f"<results>/tables/{paper}.tex" for paper in typeset(files)],
        log:
            f"<logs>/{rule_name}.log",
        group:
            "tables"
        resources:
            **resources_of("short"),
        params:
            settings=settings(**joined(campaign, files)),
        script:
            "../scripts/tables/joined.py"


# -- tables of the whole campaign --------------------------------------------------------------------


caption_of = {name: layout["caption"] for name, layout in typeset(TABLES).items()}


rule data_generation_parameters:
    input:
        summaries=case_files("dataset.json", campaign.simulated_cases),
        event_thresholds=case_files("event_threshold.json", campaign.simulated_cases),
    output:
        table=in_report("data_generation_parameters"),
        latex="<results>/tables/data_generation_parameters.tex",
    log:
        "<logs>/data_generation_parameters.log",
    group:
        "tables"
    resources:
        **resources_of("short"),
    params:
        settings=settings(
            caption=caption_of["data_generation_parameters"],
            cases=settings_of_cases(campaign, CaseData, campaign.simulated_cases),
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
    resources:
        **resources_of("short"),
    params:
        settings=settings(
            "forecasters.esn.connectivity",
            "search.input_scaling",
            "search.spectral_radius",
            "search.tikhonov",
            caption=caption_of["network_hyperparameters"],
            cases=settings_of_cases(campaign, CaseInputs),
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
    resources:
        **resources_of("short"),
    params:
        settings=settings(
            tables=written(["training_realisations"]),
            scattered=written(SCATTERED),
            kinds=kinds_of(campaign),
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

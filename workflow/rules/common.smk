"""What all rules share: the campaign, where files lie, and the one rule of all stages."""

import os
import re
import sys
import time
from pathlib import Path

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.costs.model import CostModel
from burstcast_workflow.costs.records import (
    RULE_COSTS,
    costs_of_jobs,
    job_costs,
    rule_costs,
)
from burstcast_workflow.figures.jobs import captions
from burstcast_workflow.harness.failures import failure_summary
from burstcast_workflow.harness.storage import write_table
from burstcast_workflow.commands.prune import stale_note
from burstcast_workflow.stages.stages import Stages, of_job, one_of
from snaketrust.checks import RefusedError
from burstcast_workflow.start import (
    REFUSALS,
    covers_campaign,
    start,
    tell_what_is_off,
)
from burstcast_workflow.campaign.summary import (
    campaign_summary,
    warnings_summary,
    where_results_lie,
)
from burstcast_workflow.tables.declarations import SECTIONS
from burstcast_workflow.tables.registry import (
    cases_of,
    joined,
    made_by,
    table_of,
    typeset,
    with_percentiles,
    written,
)
from snakemake_logger_plugin_burstcast.terminal import expect, interrupted

PROJECT = Path(str(workflow.current_basedir)).parents[1]
try:
    started = start(workflow, config, PROJECT)
except REFUSALS as error:
    raise RefusedError(str(error)) from None
config, run, sources = started.config, started.run, started.sources
campaign = Campaign(config)
costs = CostModel(campaign)
stages = Stages(campaign, sources, costs)
# what rules say most
files, files_in_case = stages.files, stages.files_in_case
of_case, of_cases = stages.of_case, stages.of_cases
of_forecasters = stages.of_forecasters
# The report reads captions from the config, where they are no setting of any job.
config["captions"] = captions(campaign)

# -- where files lie ---------------------------------------------------------------------------------

RESULTS = config["results"]
CASE = f"{RESULTS}/{{case}}"
FORECASTER = f"{CASE}/{{forecaster}}"
TABLES = f"{RESULTS}/tables"
TABLES_OF_CASE = f"{CASE}/tables"
LOGS = f"{RESULTS}/logs"
TIMES = f"{RESULTS}/benchmarks"
ENVIRONMENT = "../envs/burstcast.yaml"
# Logs of jobs of a scheduler, as profiles/slurm says it.
SCHEDULER_LOGS = Path("results/slurm-logs")
STARTED = time.time()

# Networks have a search before they are trained; forecasters of other kinds are fitted at once.
NETWORKS = r"[a-z_]+(-[a-z][a-z0-9]*)?-N\d+-[A-Z]+-seed\d+"
OTHERS = r"(?![a-z_]+(-[a-z][a-z0-9]*)?-N\d)[a-z][a-z0-9_]*(-[A-Za-z0-9.]+)*"
# Kinds that give probabilities without a trajectory have one stage for all that.
CLASSIFIERS = one_of(sorted({one.name.kind for one in campaign.classifiers}))
# Forecasts of other programs come in files.
EXTERNAL = one_of(
    sorted({one.name.identifier for one in campaign.external_forecasters})
)
NO_CLASSIFIER = rf"(?!({CLASSIFIERS}|{EXTERNAL})(/|$))"
# Rule that makes the ensemble of a case.
SIMULATED, MEASURED = one_of(campaign.simulated_cases), one_of(campaign.measured_cases)
REALISED = one_of(campaign.realised_cases)
INTEGRATED, IMPORTED = (
    one_of({*cases} - {*campaign.realised_cases, *campaign.encoded_cases})
    for cases in (campaign.simulated_cases, campaign.measured_cases)
)
if workflow.is_main_process:
    tell_what_is_off(campaign)


wildcard_constraints:
    case=r"[A-Za-z][A-Za-z0-9_.-]*",
    forecaster=r"[a-z][a-z0-9_]*(-[A-Za-z0-9.]+)*",
    controller=r"[a-z][a-z0-9_]*(-[A-Za-z0-9.]+)*",
    reservoir=r"[a-z_]+(-[a-z][a-z0-9]*)?-N\d+-seed\d+",
    strategies=r"[A-Z]+(\+[A-Z]+)*",
    strategy=r"[a-z][A-Za-z0-9_.+-]*",


# -- before and after --------------------------------------------------------------------------------


onstart:
    found = costs_of_jobs(workflow.dag.needrun_jobs(), costs)
    expect({job.jobid: cost.seconds for job, cost in found})


onsuccess:
    if workflow.is_main_process and covers_campaign(workflow):
        write_table(
            Path(TIMES) / RULE_COSTS, rule_costs(job_costs(workflow, costs))
        )
    found = [
        campaign_summary(Path(TABLES)),
        warnings_summary(Path(TABLES)),
        f"{where_results_lie(Path(RESULTS))}\n{stale_note(RESULTS, workflow)}",
    ]
    print("\n" + "\n\n".join(filter(None, found)), file=sys.stderr)


onerror:
    if not interrupted():
        print(
            "\nWhat failed, with the ends of the logs:\n\n"
            + failure_summary(Path(LOGS), SCHEDULER_LOGS, STARTED),
            file=sys.stderr,
        )


# -- stages ------------------------------------------------------------------------------------------

# Slurm's groups of jobs (profiles/slurm), by the folder of the script.
JOB_GROUPS = {
    "data": "case",
    "forecasters": "forecaster",
    "evaluation": "forecaster",
    "control": "forecaster",
    "probabilities": "tables",
    "tables": "tables",
}


def group_of(name):
    """Group of a rule's submitted jobs; jobs that run locally are in none.

    Snakemake would plan by the groups all the same, at each job by all jobs of its group.
    """
    return of_job(lambda wildcards: None if workflow.local_exec else name)


def stage(
    name,
    does,
    outputs,
    inputs={},
    settings="",
    cost="gather",
    cached=False,
    constraints={},
    rule_name=None,
    found_by_name={},
    priority=0,
    **values,
):
    """A stage of the workflow: the one rule of a script, and of its name.

    Inputs by the names of the script's arguments, in the words that the rules use::

        files("ensemble events")                 outputs of earlier stages, by their names there
        {"scan": f"{CASE}/scan.csv"}             a path
        {"forecasts": files_in_case("forecast.nc")}              of all forecasters of the case
        {"flows": files_in_case("flows.nc", campaign.strategy_runs)}    of some, or of control
        {"scores": of_cases("scores.csv")}                       of all cases
        stages.tables_of_case("dataset horizon")     tables of the case, as far as it has them
        stages.file_of_case("lyapunov.json", campaign.simulated_cases)  of some cases alone
        {"sources": stages.sources_of_data}          whatever a function of the wildcards says

    Values that are in no config, by name: ``quantile=of_case(Campaign.event_quantile)``, a
    function of the campaign and the case.

    Parameters
    ----------
    name
        Name of the script below ``workflow/scripts``: "evaluation/horizon" makes the rule horizon.
    does
        Message while it runs, after the name of the job.
    outputs, inputs
        Files by the names of the script's arguments. Later stages find outputs by `files`.
    settings, values
        What its script reads, and further values by name (see `Stages.reads`).
    cost, cached
        The class of its cost, and whether the cache keeps its results (see `Stages.needs`).
    constraints
        Constraints of wildcards, beside the constraints of all rules.
    priority
        Jobs with a higher one run earlier.
    rule_name, found_by_name
        For a script that several rules run: the rule's name, and modules that it finds by name.
    """
    folder, _, script_name = name.partition("/")
    rule_name = rule_name or script_name
    wildcards = list(
        dict.fromkeys(re.findall(r"\{(\w+)\}", str(next(iter(outputs.values())))))
    )
    # logs/horizon/Re400/esn-N2000-RV-seed3.log, logs/horizon_table.log
    record = os.path.join(rule_name, *(f"{{{key}}}" for key in wildcards))
    whose = ", ".join(f"{{wildcards.{key}}}" for key in wildcards)
    stages.made(outputs)
    parameters = stages.reads(f"{name}.py", settings, found_by_name, **values)
    if found_by_name:
        parameters["maker"] = rule_name

    # A rule sees the arguments of its own call, also when its job runs; in a loop over stages, all
    # jobs would run the script of the last one. (What Snakemake itself calls script and the like
    # must keep its name here.)
    rule:
        name:
            rule_name
        input:
            **stages.with_unknowns(inputs, parameters["settings"]),
        output:
            **outputs,
        log:
            f"{LOGS}/{record}.log",
        benchmark:
            f"{TIMES}/{record}.tsv"
        wildcard_constraints:
            **constraints,
        priority: priority
        group:
            group_of(JOB_GROUPS[folder])
        conda:
            ENVIRONMENT
        resources:
            **stages.needs(rule_name, cost, cached),
        params:
            **parameters,
        message:
            f"{whose}: {does}" if whose else does
        script:
            f"../scripts/{name}.py"


def in_report(table):
    """A table that the report has."""
    return report(
        f"{TABLES}/{table}.csv",
        caption="../report/table.rst",
        category=SECTIONS[table_of(table).section],
        subcategory="Tables",
        labels={"table": table},
    )


def table_stage(name, does, **arguments):
    """A stage that makes tables of a case, and a stage ``all_<name>`` that joins all cases.

    It has the arguments of `stage`, and the name of a module of `burstcast.tables.makers`.
    Its tables are declared in workflow/tables.yaml.
    """
    names = made_by(name)
    files = with_percentiles(names)
    stage(
        "tables/table",
        does,
        {"tables": [f"{TABLES_OF_CASE}/{file}.csv" for file in files]},
        rule_name=name,
        found_by_name={"burstcast.tables.makers": [name]},
        tables=written(names, campaign.unused_columns),
        **arguments,
    )
    cases = cases_of(campaign, names[0])
    if not cases:
        return
    layouts = typeset(names)
    outputs, values = {"tables": list(map(in_report, files))}, {}
    if layouts:
        outputs["latex"] = [f"{TABLES}/{paper}.tex" for paper in layouts]
        values["latex"] = layouts
    stage(
        "tables/all_cases_latex" if layouts else "tables/all_cases",
        f"{does}, of all cases",
        outputs,
        {
            "of_cases": [
                path for file in files for path in of_cases(f"tables/{file}.csv", cases)
            ]
        },
        rule_name=f"all_{name}",
        columns=joined(files, campaign.unused_columns),
        **values,
    )


def parameter_stage(name, does, **arguments):
    """A stage that writes a table of parameters, and typesets it: no case has one of its own."""
    outputs = {"table": in_report(name), "latex": f"{TABLES}/{name}.tex"}
    caption = typeset([name])[name]["caption"]
    stage(f"tables/{name}", does, outputs, caption=caption, **arguments)

"""What all rules share: the campaign, where files lie, and what a stage depends on and needs."""

import gc
import inspect
import os
import re
import sys
import time
from pathlib import Path

from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.cases import own_modules
from burstcast_workflow.config.cases import realisation_of
from burstcast_workflow.config.loading import ConfigError, load
from burstcast_workflow.config.measured_cases import OFF, data_files
from burstcast_workflow.cost_report import (
    costs_of_jobs,
    job_table,
    jobs_with_costs,
    write_costs,
)
from burstcast_workflow.costs import CostModel
from burstcast_workflow.figure_registry import (
    FIGURES,
    caption,
    figure_case,
    figure_names,
)
from burstcast_workflow.fingerprint import Sources
from burstcast_workflow.harness.code_check import (
    CodeChangedError,
    check_imports,
    compile_by_content,
)
from burstcast_workflow.harness.failures import failure_summary
from burstcast_workflow.harness.run import OvertakenError, Run
from burstcast_workflow.harness.search_path import make_importable, search_directories
from burstcast_workflow.harness.thresholds import INPUT as THRESHOLDS
from burstcast_workflow.harness.thresholds import cases_of_thresholds
from burstcast_workflow.planning import plan_by_records
from burstcast_workflow.project import packages_of
from burstcast_workflow.prune import stale_note
from burstcast_workflow.report_sections import category
from burstcast_workflow.setting_groups import listed
from burstcast_workflow.snakemake_patches import (
    claim_before_jobs,
    interrupt_quietly,
    refuse_what_nothing_makes,
    start_jobs_without_delay,
)
from burstcast_workflow.snakemake_plan import covers_campaign
from burstcast_workflow.summary import campaign_summary, warnings_summary
from burstcast_workflow.table_registry import (
    cases_of_tables,
    latex_names,
    table_names,
    table_of,
)
from burstcast_workflow.table_texts import source_of
from snakemake_logger_plugin_burstcast.terminal import expect, interrupted

# Planning makes millions of objects and keeps them: looking through them for garbage all the time
# takes a tenth of it.
gc.set_threshold(200_000, 50, 1000)

PROJECT = Path(str(workflow.current_basedir)).parents[1]
try:
    check_imports(packages_of(PROJECT))
    if workflow.is_main_process:
        directories = search_directories(workflow.configfiles, PROJECT)
        make_importable(directories)
        config = load(config, workflow.configfiles, defaults=PROJECT / "config.yaml")
        # where another workflow's prefix puts it, if it has this one as a module
        run = Run.new(workflow.modifier.path_modifier.replace_prefix(config["results"]))
    else:  # a job of a cluster: what was planned, whatever the files say by now
        run = Run.of_job()
        config, directories = run.plan()["config"], run.plan()["directories"]
        make_importable(directories)
    sources = Sources(PROJECT, own_modules(config))
    if workflow.is_main_process:
        compile_by_content(packages_of(PROJECT), sources.own_files().values())
except (CodeChangedError, ConfigError, OvertakenError) as error:
    # without the traceback, in which nobody would find the message
    raise WorkflowError(str(error)) from None
plan_by_records(run.results)
if workflow.is_main_process:
    start_jobs_without_delay()
    interrupt_quietly()
    refuse_what_nothing_makes(run.results)
    claim_before_jobs(run, dict(config), sources, directories)
campaign = Campaign(config)
costs = CostModel(campaign)

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
NETWORKS = r"esn-N\d+-[A-Z]+-seed\d+"
OTHERS = r"(?!esn-)[a-z][a-z0-9_]*(-[A-Za-z0-9.]+)*"


wildcard_constraints:
    case=r"[A-Za-z][A-Za-z0-9_.-]*",
    forecaster=r"[a-z][a-z0-9_]*(-[A-Za-z0-9.]+)*",
    reservoir=r"esn-N\d+-seed\d+",
    strategies=r"[A-Z]+(\+[A-Z]+)*",
    strategy=r"[a-z][A-Za-z0-9_.+-]*",
    table="[a-z_]+",


onstart:
    found = costs_of_jobs(workflow.dag.needrun_jobs(), campaign, costs)
    expect({job.jobid: cost.seconds for job, cost in found})


onsuccess:
    if workflow.is_main_process and covers_campaign(workflow):
        jobs = job_table(jobs_with_costs(workflow, campaign, costs))
        write_costs(jobs, campaign, Path(TIMES))
    found = [
        campaign_summary(Path(TABLES)),
        warnings_summary(Path(TABLES)),
        f"Tables: {TABLES}/*.csv and *.tex. Figures: {RESULTS}/figures/*.pdf and *.png; look first "
        f"at classification_scores and forecast_skill.\n{stale_note(RESULTS, workflow)}",
    ]
    print("\n" + "\n\n".join(filter(None, found)), file=sys.stderr)


onerror:
    if not interrupted():
        print(
            "\nWhat failed, with the ends of the logs:\n\n"
            + failure_summary(Path(LOGS), SCHEDULER_LOGS, STARTED),
            file=sys.stderr,
        )


def in_results(paths):
    """Paths below the results directory, or one of them."""
    if isinstance(paths, str):
        return f"{RESULTS}/{paths}"
    return [f"{RESULTS}/{path}" for path in paths]


def of_cases(name, cases=campaign.case_names):
    """The file called ``name`` of every case, of the whole campaign unless told otherwise."""
    return in_results(f"{case}/{name}" for case in cases)


def of_forecasters(name, forecasters=campaign.forecasters):
    """The file called ``name`` of every forecaster, or of every run of control.

    They are the forecasters of the whole campaign unless told otherwise.
    """
    return in_results(f"{one.directory}/{name}" for one in forecasters)


# -- what a stage depends on and needs ---------------------------------------------------------------


def of_job(function):
    """Keep the signature of a function of a job.

    Snakemake asks for it several times for each job, and working it out takes longer than calling
    the function: a tenth of the time of planning.
    """
    function.__signature__ = inspect.signature(function)
    return function


def in_case(chosen, function, *arguments):
    """``function`` of those who belong to a job's case, or of whom ``chosen`` makes of the case."""

    @of_job
    def found(wildcards):
        case = wildcards.case
        if callable(chosen):
            return function(*arguments, chosen(campaign, case))
        return function(*arguments, [one for one in chosen if one.case == case])

    return found


def files_in_case(name, chosen=campaign.forecasters):
    """The file called ``name`` of forecasters, or runs of control, of a job's case (`in_case`)."""
    return in_case(chosen, of_forecasters, name)


def tables_in_case(names):
    """Tables of a job's case, by their names; nothing for those that it does not have."""

    def of_name(name):
        cases = cases_of_tables(campaign).get(name, [])
        return of_job(
            lambda wildcards: (
                f"{RESULTS}/{wildcards.case}/tables/{name}.csv"
                if wildcards.case in cases
                else []
            )
        )

    return {name: of_name(name) for name in names.split()}


def of_case(function):
    """``function`` of the campaign and a job's case."""
    return of_job(lambda wildcards: function(campaign, wildcards.case))


def thresholds_of(settings):
    """Files of the event thresholds that settings of a job only know as quantiles."""
    return of_cases(
        "event_threshold.json", dict.fromkeys(cases_of_thresholds(settings))
    )


# Settings are gone through for each job: not where no threshold is a quantile.
QUANTILES = any(campaign.event_quantile(case) is not None for case in campaign.cases)


def reads(script, paths="", **values):
    """Parameters of a stage: the settings that its script reads, and the code that it runs.

    ``paths`` are those of the config and names of `setting_groups`, ``case.`` standing for the job's case
    and ``forecaster.options`` for the section of its kind; ``values`` are given as they are, or
    by functions of the job's wildcards.
    """
    names = listed(paths)

    @of_job
    def settings(wildcards):
        found = {
            name: value(wildcards) if callable(value) else value
            for name, value in values.items()
        }
        return campaign.settings(names, wildcards, found)

    @of_job
    def code(wildcards):
        return sources.fingerprint(script, campaign.modules(wildcards))

    return {"settings": settings, "code": code}


def needs(stage, cost_class, cached=False):
    """Resources of a stage: what a scheduler is asked for, and whether the cache keeps its results.

    ``stage`` is its name, whatever the rule is called where this workflow is a module of another;
    ``cost_class`` says what sort of work it is (`burstcast_workflow.costs`).
    """

    @of_job
    def memory(wildcards, attempt):
        return costs.predicted(cost_class, stage, wildcards).mib_for(attempt)

    @of_job
    def runtime(wildcards, attempt):
        return costs.predicted(cost_class, stage, wildcards).minutes_for(attempt)

    memory.cost_class, memory.stage = cost_class, stage  # for the report of costs
    return {"mem_mb": memory, "runtime": runtime, "cached": int(cached)}


# -- stages ------------------------------------------------------------------------------------------

# Outputs of stages by their names, which are those of the arguments of scripts. A function is asked
# for each job, which takes time: not for the unit of time where all exponents are published.
FILES = {"time_unit": []}
if any(map(campaign.time_unit, campaign.cases)):
    FILES["time_unit"] = of_job(
        lambda wildcards: in_results(campaign.time_unit(wildcards.case))
    )
# Slurm's groups of jobs (profiles/slurm), by the folder of the script.
JOB_GROUPS = {
    "data": "case",
    "forecasters": "forecaster",
    "evaluation": "forecaster",
    "control": "forecaster",
    "probabilities": "tables",
    "tables": "tables",
}


def files(names):
    """Files that earlier stages make, by their names there: inputs of a stage."""
    return {name: FILES[name] for name in names.split()}


def stage(
    name,
    does,
    outputs,
    inputs={},
    settings="",
    cost="gather",
    cached=False,
    constraints={},
    **values,
):
    """A stage of the workflow: the one rule of a script, and of its name.

    Parameters
    ----------
    name
        Of the script below ``workflow/scripts``: "evaluation/horizon" makes the rule horizon.
    does
        What a person is told while it runs, after whose job it is.
    outputs, inputs
        Files by the names of the script's arguments. Later stages find outputs by `files`.
    settings, values
        What its script reads, and further values by name (see `reads`).
    cost, cached
        The class of its cost, and whether the cache keeps its results (see `needs`).
    constraints
        Of wildcards, beside those of all rules.
    """
    folder, _, rule_name = name.partition("/")
    wildcards = list(
        dict.fromkeys(re.findall(r"\{(\w+)\}", next(iter(outputs.values()))))
    )
    # logs/horizon/Re400/esn-N2000-RV-seed3.log, logs/horizon_table.log
    record = os.path.join(rule_name, *(f"{{{key}}}" for key in wildcards))
    whose = ", ".join(f"{{wildcards.{key}}}" for key in wildcards)
    for file, path in outputs.items():
        # what two stages call the same is no name for either
        FILES[file] = path if FILES.get(file, path) == path else None
    parameters = reads(f"{name}.py", settings, **values)
    if QUANTILES:
        read = parameters["settings"]
        inputs = {
            **inputs,
            THRESHOLDS: of_job(lambda wildcards: thresholds_of(read(wildcards))),
        }

    # A rule sees the arguments of its own call, also when its job runs; in a loop over stages, all
    # jobs would run the script of the last one. (What Snakemake itself calls script and the like
    # must keep its name here.)

    rule:
        name:
            rule_name
        input:
            **inputs,
        output:
            **outputs,
        log:
            f"{LOGS}/{record}.log",
        benchmark:
            f"{TIMES}/{record}.tsv"
        wildcard_constraints:
            **constraints,
        group:
            JOB_GROUPS[folder]
        conda:
            ENVIRONMENT
        resources:
            **needs(rule_name, cost, cached),
        params:
            **parameters,
        message:
            f"{whose}: {does}" if whose else does
        script:
            f"../scripts/{name}.py"


# -- measured series ---------------------------------------------------------------------------------


def one_of(cases):
    """Wildcard that is one of these cases."""
    return "|".join(map(re.escape, cases)) or "(?!)"


# Who makes the ensemble of a case.
SIMULATED, MEASURED = one_of(campaign.simulated_cases), one_of(campaign.measured_cases)
REALISED = one_of(campaign.realised_cases)
INTEGRATED, IMPORTED = (
    one_of(case for case in cases if case not in campaign.realised_cases)
    for cases in (campaign.simulated_cases, campaign.measured_cases)
)
if workflow.is_main_process and campaign.measured_cases:
    print(
        f"{', '.join(campaign.measured_cases)}: measured series; off: {OFF}",
        file=sys.stderr,
    )


@of_job
def ensemble_of_source(wildcards):
    """The ensemble that a case of other training series takes its series from."""
    return f"{RESULTS}/{realisation_of(wildcards.case)[0]}/ensemble.nc"


@of_job
def sources_of_data(wildcards):
    """Files that the measured series of a case come in."""
    data = campaign.cases[wildcards.case]["data"]
    if data["case"] is not None:
        return [f"{RESULTS}/{data['case']}/ensemble.nc"]
    return [local(path) for path in data_files(data)]


# -- of single stages --------------------------------------------------------------------------------


def scan_of_network(suffix):
    """A file of the scan that a network's search goes on from."""

    @of_job
    def path(wildcards):
        reservoir, strategies = campaign.scan_of(wildcards.forecaster)
        return f"{RESULTS}/{wildcards.case}/scan/{reservoir}-{strategies}.{suffix}"

    return path


def in_report(table):
    """A table that the report has."""
    return report(
        f"{TABLES}/{table}.csv",
        caption="../report/table.rst",
        category=category_of_table(table),
        subcategory="Tables",
        labels={"table": table},
    )


def category_of_table(table):
    """Section of the report that a table stands in, told a name or the wildcard of one."""
    if "{" not in table:
        return category("tables", table)
    return lambda wildcards: category("tables", wildcards.table)


# -- figures -----------------------------------------------------------------------------------------

# The report reads captions from the config, where they are no setting of any job.
config["captions"] = {
    "figures": {
        name: caption(PROJECT / "workflow" / "scripts" / "figures" / f"{name}.py")
        for name in FIGURES
    },
    "tables": {name: table_of(name).says for name in table_names(campaign)},
}
PUBLISHED = os.path.relpath(PROJECT / "resources" / "published_percentiles.csv")


def case_of_figure(wildcards):
    """The case that a figure shows."""
    return figure_case(campaign, wildcards.figure, wildcards.of_case)


@of_job
def files_of_figure(wildcards):
    """What a figure is drawn from."""
    figure = FIGURES[wildcards.figure]
    paths = figure.files(campaign, case_of_figure(wildcards))
    found = {name: in_results(path) for name, path in paths.items()}
    if QUANTILES:
        found[THRESHOLDS] = thresholds_of(settings_of_figure(wildcards))
    overlay = figure.published and config["figures"]["published_overlay"]
    return {**found, "published": local(PUBLISHED)} if overlay else found


@of_job
def settings_of_figure(wildcards):
    """What a figure's script reads."""
    figure, case = FIGURES[wildcards.figure], case_of_figure(wildcards)
    return campaign.settings(
        figure.reads, {"case": case}, figure.values(campaign, case)
    )


@of_job
def code_of_figure(wildcards):
    """What a figure's script runs."""
    modules = campaign.modules({"case": case_of_figure(wildcards)})
    return sources.fingerprint(f"figures/{wildcards.figure}.py", modules)


def category_of_figure(wildcards):
    """Section of the report that a figure stands in."""
    return category("figures", wildcards.figure)


def labels_of_figure(wildcards):
    """What the report calls a figure: its name, and the case, which is a switch there."""
    several = FIGURES[wildcards.figure].of_several_cases
    case = "several" if several else case_of_figure(wildcards)
    return {"figure": wildcards.figure, "case": case}

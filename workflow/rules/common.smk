"""What all rules share: the campaign, where files lie, and functions of what rules need."""

import sys
import time
from pathlib import Path

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.costs.model import RULE_COSTS, CostModel
from burstcast_workflow.costs.records import check_memory, costs_of_jobs, rule_costs
from burstcast_workflow.figures.jobs import captions
from burstcast_workflow.harness.failures import failure_summary
from burstcast_workflow.harness.storage import write_table
from burstcast_workflow.stages.stages import Stages, of_job, one_of
from snaketrust.checks import RefusedError
from burstcast_workflow.start import (
    REFUSALS,
    check_records,
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
from burstcast_workflow.tables.registry import table_of, typeset
from snakemake_logger_plugin_burstcast.terminal import expect, interrupted

PROJECT = Path(str(workflow.current_basedir)).parents[1]


def check():
    """What jobs of this run would lack, or read in files with mistakes."""
    check_memory(workflow, costs)
    check_records(workflow, campaign)


try:
    started = start(workflow, config, PROJECT, check)
except REFUSALS as error:
    raise RefusedError(str(error)) from None
config, run, sources = started.config, started.run, started.sources
campaign = Campaign(config)
costs = CostModel(campaign)
stages = Stages(campaign, sources, costs)
# Parameters of rules: the settings that a script declares, and hashes of the code that runs.
settings_of, code_of = stages.settings_of, stages.code_of
# Resources: memory and time of a class of work (burstcast_workflow/costs/model.py).
needs = stages.needs
# Inputs: thresholds and units of time that jobs compute; files of a case, or of the campaign.
unknowns_of, files_in_case = stages.unknowns_of, stages.files_in_case
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
# Only where Snakemake makes environments (--sdm): each job would look for the file.
ENVIRONMENT = (
    "../envs/burstcast.yaml" if workflow.deployment_settings.deployment_method else None
)
# Logs of jobs of a scheduler, as profiles/slurm says it.
SCHEDULER_LOGS = Path("results/slurm-logs")
STARTED = time.time()

# Networks have a search before they are trained; forecasters of other kinds are fitted at once.
NETWORKS = r"[a-z_]+(-[a-z][a-z0-9]*)?-N\d+-[A-Z]+-seed\d+"
OTHERS = r"(?![a-z_]+(-[a-z][a-z0-9]*)?-N\d)[A-Za-z][A-Za-z0-9_.]*(-[A-Za-z0-9.]+)*"
# Kinds that give probabilities without a trajectory have one stage for all that.
CLASSIFIERS = one_of(
    sorted({one.name.identifier for one in campaign.classifiers})
)
NO_CLASSIFIER = rf"(?!({CLASSIFIERS})(/|$))"
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
    forecaster=r"[A-Za-z][A-Za-z0-9_.]*(-[A-Za-z0-9.]+)*",
    controller=r"[A-Za-z][A-Za-z0-9_.]*(-[A-Za-z0-9.]+)*",
    reservoir=r"[a-z_]+(-[a-z][a-z0-9]*)?-N\d+-seed\d+",
    strategies=r"[A-Z]+(\+[A-Z]+)*",
    strategy=r"[a-z][A-Za-z0-9_.+-]*",


# -- before and after --------------------------------------------------------------------------------


onstart:
    found = costs_of_jobs(workflow.dag.needrun_jobs(), costs)
    expect(
        {job.jobid: (job.rule.name, cost.seconds) for job, cost in found},
        f"by the times in {costs.table}" if costs.table else "estimated from sizes",
    )


onsuccess:
    if workflow.is_main_process and covers_campaign(workflow):
        write_table(Path(TIMES) / RULE_COSTS, rule_costs(workflow, costs))
    found = [
        campaign_summary(Path(TABLES)),
        warnings_summary(Path(TABLES)),
        where_results_lie(Path(RESULTS)),
    ]
    print("\n" + "\n\n".join(filter(None, found)), file=sys.stderr)


onerror:
    if not interrupted():
        print(
            "\nWhat failed, with the ends of the logs:\n\n"
            + failure_summary(Path(LOGS), SCHEDULER_LOGS, STARTED),
            file=sys.stderr,
        )


# -- what all rules use ------------------------------------------------------------------------------


def group_of(name):
    """Group of a rule's submitted jobs on Slurm (profiles/slurm); jobs that run locally are in none.

    Snakemake would plan by the groups all the same, at each job by all jobs of its group.
    """
    return of_job(lambda wildcards: None if workflow.local_exec else name)


def in_report(table):
    """A table that the report has."""
    return report(
        f"{TABLES}/{table}.csv",
        caption="../report/table.rst",
        category=SECTIONS[table_of(table).section],
        subcategory="Tables",
        labels={"table": table},
    )


def caption_of(table):
    """Caption of a table of the whole campaign, in LaTeX."""
    return typeset([table])[table]["caption"]

"""What all rules share: the campaign, where files lie, and functions of what rules need."""

import os
import sys
import time
from pathlib import Path

from snakemake.exceptions import WorkflowError

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.summary import (
    campaign_summary,
    warnings_summary,
    where_results_lie,
)
from burstcast_workflow.figures.jobs import captions
from burstcast_workflow.harness.failures import failure_summary
from burstcast_workflow.project import source_revision
from burstcast_workflow.stages.resources import beyond_memory, resources_of
from burstcast_workflow.stages.stages import Stages, one_of
from burstcast_workflow.start import start, tell_what_is_off
from burstcast_workflow.tables.declarations import SECTIONS
from burstcast_workflow.tables.registry import table_of, typeset
from burstcast_workflow.tracking.cache import seconds_of_rules, tidy
from burstcast_workflow.tracking.run import begin
from snakemake_logger_plugin_burstcast.terminal import expect, interrupted

HERE = Path(str(workflow.current_basedir))


def file_of(path):
    """A file of the workflow, by its path from here; a copy where the workflow is a remote module."""
    return (
        (HERE / path).resolve() if HERE.is_dir() else Path(workflow.source_path(path))
    )


def beside(path):
    """The same as an input: relative, so that another clone plans the same."""
    return os.path.relpath(file_of(path))


started = start(
    workflow,
    config,
    lambda script: file_of(f"../scripts/{script}"),
    file_of("../../config.yaml"),
)
config, sources = started.config, started.sources
campaign = Campaign(config)
stages = Stages(campaign, sources)
# Parameters of rules: the settings that a script declares, and hashes of the code that runs.
of_script = stages.of_script
# Inputs: thresholds and units of time that jobs compute; files of a case, or of the campaign.
unknowns_of, files_in_case = stages.unknowns_of, stages.files_in_case
of_case, of_cases = stages.of_case, stages.of_cases
of_forecasters = stages.of_forecasters
PLANNED = dict(config)
# The report reads captions from the config, where they are no setting of any job.
config["captions"] = captions(campaign)

# -- where files lie ---------------------------------------------------------------------------------

RESULTS = config["results"]
CASE = f"{RESULTS}/{{case}}"
FORECASTER = f"{CASE}/{{forecaster}}"
TABLES = f"{RESULTS}/tables"
TABLES_OF_CASE = f"{CASE}/tables"
LOGS = f"{RESULTS}/logs"

CACHE_BYTES = 10**9 * config["cache_gb"]
# Logs of jobs of a scheduler, as profiles/slurm says it.
SCHEDULER_LOGS = Path("results/slurm-logs")
STARTED = time.time()

# Networks have a search before they are trained; forecasters of other kinds are fitted at once.
NETWORKS = r"[a-z_]+(-[a-z][a-z0-9]*)?-N\d+-[A-Z]+-seed\d+"
OTHERS = r"(?![a-z_]+(-[a-z][a-z0-9]*)?-N\d)[A-Za-z][A-Za-z0-9_.]*(-[A-Za-z0-9.]+)*"
# Kinds that give probabilities without a trajectory have one stage for all that.
CLASSIFIERS = one_of(sorted({one.name.identifier for one in campaign.classifiers}))
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
    if workflow.local_exec and (
        reason := beyond_memory(one.name.neurons or 0 for one in campaign.networks)
    ):
        raise WorkflowError(reason)
    begin(
        started.results,
        PLANNED,
        sources.all_entries(),
        started.directories,
        source_revision(),
    )
    tidy(CACHE_BYTES)
    expect(workflow.dag.needrun_jobs(), seconds_of_rules())


onsuccess:
    tidy(CACHE_BYTES)
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

"""What all rules share: the campaign, where files lie, and functions of what rules need."""

import os
import sys
import time
from pathlib import Path

# plan and jobs draw to files, also if a notebook has started them
os.environ["MPLBACKEND"] = "agg"

from snakemake.exceptions import WorkflowError

from burstcast.base.names import MODEL, NETWORK
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.figures.jobs import captions
from burstcast_workflow.harness.logs import cache_summary, failure_summary
from burstcast_workflow.project import source_revision
from burstcast_workflow.stages.resources import beyond_memory, resources_of
from burstcast_workflow.stages.stages import Stages, any_of_regex
from burstcast_workflow.start import check_records, start, tell_what_is_off
from burstcast_workflow.summary import closing_summary
from burstcast_workflow.tracking.cache import seconds_of_rules, tidy
from burstcast_workflow.tracking.run import begin
from snakemake_logger_plugin_burstcast.terminal import expect, interrupted

started = start(workflow, config)
config, sources = started.config, started.sources
campaign = Campaign(config)
stages = Stages(campaign, sources)
# Parameters of rules: each setting that a script declares, and a hash of the script and of every
# module that it imports, directly or not (of kinds, only the ones in the wildcards). A job runs
# again where one has changed: docs/selective_rebuilds.md.
of_script = stages.of_script
# Resources of rules: work of seconds is "short", of minutes "usual", of an hour "long"; "training"
# grows with the square of the neurons. All double at each retry; amounts: stages/resources.py.
# Inputs: thresholds and units of time that jobs compute; files of all cases or forecasters.
computed_settings_files = stages.computed_settings_files
case_files, forecaster_files = stages.case_files, stages.forecaster_files
PLANNED = dict(config)
# The report reads captions from the config, where they are no setting of any job.
config["captions"] = captions(campaign)

# -- where files lie ---------------------------------------------------------------------------------


pathvars:
    results=config["results"],
    logs="<results>/logs",


CACHE_BYTES = 10**9 * config["cache_gb"]
# Logs of jobs of a scheduler, as profiles/slurm says it.
SCHEDULER_LOGS = Path("results/slurm-logs")
STARTED = time.time()

if workflow.is_main_process:
    tell_what_is_off(campaign)


# The directory of a file says which rule makes it: names of cases, forecasters, plans have no slash.
wildcard_constraints:
    case="[^/]+",
    family="networks|models",
    forecaster="[^/]+",
    controller="[^/]+",
    reservoir="[^/]+",
    strategies="[^/]+",
    strategy="[^/]+",


# -- before and after --------------------------------------------------------------------------------


onstart:
    if workflow.local_exec:
        if reason := beyond_memory(
            member.name.neurons for member in campaign.networks
        ):
            raise WorkflowError(reason)
        # Snakemake's limit of jobs per second makes it look at all jobs that are ready once more a
        # second after each look: with each finished job more often, in the end all the time
        workflow.scheduler.job_rate_limiter = None
    check_records(workflow, campaign)
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
    print(
        cache_summary(Path(started.results, "logs"), STARTED),
        closing_summary(Path(started.results)),
        sep="\n",
        file=sys.stderr,
    )


onerror:
    if not interrupted():
        print(
            "\nWhat failed, with the ends of the logs:\n\n"
            + failure_summary(
                Path(started.results, "logs"), SCHEDULER_LOGS, STARTED
            ),
            file=sys.stderr,
        )

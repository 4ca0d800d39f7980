"""What all rules share: the campaign, where files lie, and functions of what rules need."""

import os
import sys
import time
from pathlib import Path

# plan and jobs draw to files, also if a notebook has started them
os.environ.update(MPLBACKEND="agg")

from burstcast.base.names import MODEL, NETWORK
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.figures.jobs import captions
from burstcast_workflow.harness.logs import cache_summary, failure_summary
from burstcast_workflow.stages.resources import resources_of
from burstcast_workflow.snakemake_internals import all_files
from burstcast_workflow.stages.stages import Stages, any_of_regex
from burstcast_workflow.start import (
    begin_run,
    follow,
    start,
    tell_what_is_hidden,
    tell_what_is_off,
)
from burstcast_workflow.summary import closing_summary
from burstcast_workflow.tracking.cache import tidy
from snakemake_logger_plugin_burstcast.terminal import interrupted

started = start(workflow, config)
sources, campaign = started.sources, Campaign(started.config)
# The report reads captions from the config, where they are no setting of any job.
config = {**started.config, "captions": captions(campaign)}
stages = Stages(campaign, sources)
# A rule names the settings that its jobs depend on by their paths in config.yaml: ``case.`` stands
# for the job's case, ``forecaster.options`` for the section of its kind of forecaster. At the end of
# the Snakefile each rule gets the code of its script, too: a hash of the script and of what it uses of
# each module, directly or not (of kinds, only the ones in the wildcards). A job runs again where one
# of both has changed: docs/selective_rebuilds.md.
settings = stages.settings
# Resources of rules: work of seconds is "short", of minutes "usual", of an hour "long"; "training"
# grows with the square of the neurons. All double at each retry; amounts: stages/resources.py.
# Inputs: files of all cases or forecasters.
case_files, forecaster_files = stages.case_files, stages.forecaster_files

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

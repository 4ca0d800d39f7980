"""What all rules share: the campaign, and what each rule depends on."""

import gc
import inspect
import os
import sys
import time
from pathlib import Path

from burstcast.tuning.strategies import registry as strategies
from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.cases import case_records
from burstcast_workflow.config.loading import ConfigError, load
from burstcast_workflow.costs import CostModel
from burstcast_workflow.failures import failure_summary
from burstcast_workflow.fingerprint import fingerprint

# Planning makes millions of objects and keeps them: looking through them for garbage all the time
# takes a tenth of it.
gc.set_threshold(200_000, 50, 1000)

try:
    config = load(config, workflow.configfiles)
except ConfigError as error:
    # without the traceback, in which nobody would find the message
    raise WorkflowError(str(error)) from None
campaign = Campaign(config, case_records(config))
costs = CostModel(campaign)
RESULTS = config["results"]
SOURCES = Path(workflow.basedir) / "src"
SCRIPTS = Path(workflow.basedir) / "workflow" / "scripts"
NETWORK = f"{RESULTS}/{{case}}/N{{neurons}}/{{validation}}/seed{{seed}}"
SCAN = f"{RESULTS}/{{case}}/N{{neurons}}/scan/seed{{seed}}"
TABLES = f"{RESULTS}/tables"
FIGURES = f"{RESULTS}/figures"
EXAMPLE_CASE = f"{RESULTS}/{campaign.example.case}"
EXAMPLE = f"{RESULTS}/{campaign.example.directory}"
PUBLISHED = os.path.relpath(
    Path(workflow.basedir) / "resources" / "published_percentiles.csv"
)


wildcard_constraints:
    case=r"[A-Za-z][A-Za-z0-9_.-]*",
    neurons=r"\d+",
    validation="SSV|RV",
    seed=r"\d+",
    prediction_time_lt=r"\d+(\.\d+)?",
    table="[a-z_]+",
    # nothing for the case that figures show by default
    of_case=r"(_[A-Za-z][A-Za-z0-9_.-]*)?",


# Logs of jobs of a scheduler, as profiles/slurm says it.
SCHEDULER_LOGS = Path("results/slurm-logs")
STARTED = time.time()


onerror:
    print(
        "\nWhat failed, with the ends of the logs:\n\n"
        + failure_summary(Path(RESULTS) / "logs", SCHEDULER_LOGS, STARTED),
        file=sys.stderr,
    )


def of_job(function):
    """Keep the signature of a function of a job.

    Snakemake asks for it several times for each job, and working it out takes longer than calling
    the function: a tenth of the time of planning.
    """
    function.__signature__ = inspect.signature(function)
    return function


def settings_of(name):
    """The settings that the script of a rule reads, as a function of its wildcards."""

    @of_job
    def settings(wildcards):
        return campaign.settings(name, dict(wildcards.items()))

    return settings


def code_of(name):
    """Fingerprints of the code that a rule runs, with the modules that are found by name.

    These are its system's, and the validation strategies' where the script looks for them.
    """
    script = SCRIPTS / f"{name}.py"
    finds_strategies = any(
        entry.startswith("burstcast.tuning.strategies.registry@")
        for entry in fingerprint(script, SOURCES)
    )

    @of_job
    def code(wildcards):
        case = wildcards.get("case")
        found = [f"burstcast.systems.{campaign.cases[case]['system']}"] if case else []
        if finds_strategies:
            names = campaign.settings(name, dict(wildcards.items()))["validation"]
            names = [names] if isinstance(names, str) else names
            found += map(strategies.module_of, names)
        return fingerprint(script, SOURCES, found)

    return code


def memory_of(name):
    """Memory that a rule asks for, in MiB; more at each retry."""

    @of_job
    def memory(wildcards, attempt):
        return costs.memory_mib(name, dict(wildcards.items()), attempt)

    return memory


def runtime_of(name):
    """Time that a rule asks for, in minutes; more at each retry."""

    @of_job
    def runtime(wildcards, attempt):
        return costs.runtime_minutes(name, dict(wildcards.items()), attempt)

    return runtime


def of_networks(name, networks=campaign.networks):
    """The file called ``name`` of every network, of the whole campaign unless told otherwise."""
    return [f"{RESULTS}/{network.directory}/{name}" for network in networks]


def of_cases(name):
    """The file called ``name`` of every case of the campaign."""
    return [f"{RESULTS}/{case}/{name}" for case in campaign.case_names]


def control_counts():
    """What every run of control achieved."""
    return [f"{RESULTS}/{run.stem}.json" for run in campaign.control_runs]


def time_unit_of_case(case):
    """The computed Lyapunov exponent of a case, where it sets the unit of time."""
    if campaign.steps_per_lyapunov_time(case) is None:
        return f"{RESULTS}/{case}/lyapunov.json"
    return []


@of_job
def time_unit_of_job(wildcards):
    """The computed Lyapunov exponent of a job's case, where it sets the unit of time."""
    return time_unit_of_case(wildcards.case)


# A function is asked for each job, which takes time: not where all exponents are published.
time_unit = time_unit_of_job if any(map(time_unit_of_case, campaign.cases)) else []


def of_figure_case(name):
    """The file called ``name`` of the case that a figure shows."""
    return lambda wildcards: f"{RESULTS}/{campaign.case_of_figure(wildcards)}/{name}"


def time_unit_of_figure(wildcards):
    """The computed Lyapunov exponent of the case that a figure shows, where it is needed."""
    return time_unit_of_case(campaign.case_of_figure(wildcards))


def example_searches():
    """Search traces of the example's reservoir, one for each validation strategy."""
    example = campaign.example
    networks = campaign.select(
        case=example.case, neurons=example.neurons, seed=example.seed
    )
    return of_networks("search.csv", networks)


def published():
    """Published percentiles, where they are drawn on ours."""
    return PUBLISHED if config["figures"]["published_overlay"] else []


def labels_of_figure(name, case_of=campaign.case_of_figure):
    """What the report calls a figure; ``case_of`` tells from the wildcards which case it shows."""
    return lambda wildcards: {"figure": name, "case": case_of(wildcards)}


def statistics_candidates(wildcards):
    """Statistics of the networks of a figure's case, the best of which the figure shows."""
    case = campaign.case_of_figure(wildcards)
    return of_networks("climate.nc", campaign.statistics_candidates(case))


def control_example(wildcards):
    """The suppressed event that figures show."""
    return f"{RESULTS}/{campaign.control_example.network.directory}/suppressed_event.nc"


def case_of_control_example(wildcards):
    """Case of the suppressed event that figures show."""
    return campaign.control_example.case


def controlled_densities(wildcards):
    """Histograms of the controlled flows that a figure shows."""
    return [f"{RESULTS}/{run.stem}.nc" for run in campaign.density_runs(wildcards)]

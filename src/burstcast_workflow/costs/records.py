"""Costs of the jobs of a campaign: predicted, and measured for finished jobs.

::

    burstcast costs [options of snakemake]

The command prints a row for each rule. Every run of a whole campaign writes the same rows at its
end, ``benchmarks/rule_costs.csv`` below the results: beside Snakemake's records of times, not among
the campaign's tables, which are the same bits wherever and whenever they are made.
"""

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from burstcast_workflow.costs.model import SECONDS_PER, Cost, CostModel
from burstcast_workflow.start import names_of_rules
from snaketrust.plan import planned

RULE_COSTS = "rule_costs.csv"
"""Table of what the jobs of each rule took, beside the records."""

_MEASURED = ("seconds", "memory_mib", "disk_mib")
_SHOWN = {
    "jobs": "jobs",
    "predicted_longest_seconds": "longest [s]",
    "predicted_memory_mib": "MiB",
    "predicted_minutes": "all [min]",
    "records": "records",
    "median_seconds": "median [s]",
    "predicted_median_seconds": "predicted",
    "memory_mib": "MiB",
}


def costs_of_jobs(jobs: Iterable[Any], model: CostModel) -> Iterator[tuple[Any, Cost]]:
    """Jobs of Snakemake that are stages of a campaign, with their costs.

    A job's stage is the first part of the name of its record, ``benchmarks/<stage>/...``: rules
    may have other names where another workflow has this one as a module.
    """
    for job in jobs:
        record = Path(job.benchmark or "")
        if record.is_relative_to(model.records):
            stage = record.relative_to(model.records).parts[0].removesuffix(".tsv")
            yield job, model.predicted(model.classes[stage], job.wildcards_dict)


def beyond_memory(costs: Iterable[tuple[Any, Cost]], machine_mib: float) -> str:
    """The largest network that jobs train and a machine cannot hold, in words; empty if none is.

    A bound, no prediction: the Gram matrix alone does not fit.
    """
    job, cost = max(costs, key=lambda pair: pair[1].least_mib, default=(None, Cost(0.0, 0.0)))
    if job is None or cost.least_mib <= machine_mib:
        return ""
    return (
        f"{job.rule.name} of {', '.join(job.wildcards_dict.values())} cannot run on this machine: "
        f"the Gram matrix of the network's states takes {cost.least_mib / 1024:.1f} GiB, and there "
        f"are {machine_mib / 1024:.1f} GiB of memory. Take fewer neurons "
        f"(campaign.forecasters.esn.neurons), or a cluster (docs/cluster.md)"
    )


def job_costs(workflow: Any, model: CostModel, above: Path = Path()) -> pd.DataFrame:
    """Costs of the jobs of a planned campaign, predicted and measured.

    Returns a row for each job, in the order of the rules: ``rule``, ``predicted_seconds``,
    ``predicted_memory_mib``; empty for a job without a record, ``seconds`` (wall time),
    ``memory_mib`` (the largest that was sampled) and ``disk_mib`` (of outputs that are there).
    """
    order = {rule.name: number for number, rule in enumerate(workflow.rules)}
    jobs = sorted(workflow.dag.jobs, key=lambda job: order[job.rule.name])
    rows = [
        {
            "rule": job.rule.name,
            "predicted_seconds": cost.seconds,
            "predicted_memory_mib": cost.memory_mib,
            **_measured(above / job.benchmark, [above / path for path in job.output]),
        }
        for job, cost in costs_of_jobs(jobs, model)
    ]
    names = ("rule", "predicted_seconds", "predicted_memory_mib", *_MEASURED)
    return pd.DataFrame(rows, columns=list(names))


def _measured(record: Path, outputs: Iterable[Path]) -> dict[str, float]:
    """Measurements of a finished job by Snakemake."""
    if not record.exists():
        return dict.fromkeys(_MEASURED, float("nan"))
    with record.open(encoding="utf-8") as file:
        row = list(csv.DictReader(file, delimiter="\t"))[-1]
    # a job that is over at once is not sampled
    memory = 0.0 if row["max_rss"] in ("-", "NA") else float(row["max_rss"])
    size = sum(path.stat().st_size for path in outputs if path.is_file())
    return {"seconds": float(row["s"]), "memory_mib": memory, "disk_mib": size / 2**20}


def rule_costs(jobs: pd.DataFrame) -> pd.DataFrame:
    """Predicted costs of the jobs of each rule, and measured costs of jobs with records.

    Returns a row for each rule: ``rule``; ``jobs``, how many the campaign has;
    ``predicted_longest_seconds`` and ``predicted_memory_mib``, the most of any;
    ``predicted_minutes``, of all; ``records``, how many have run. The rest is of these, and empty
    without any: ``median_seconds`` and ``predicted_median_seconds``; ``minutes`` of all;
    ``longest_seconds`` and ``memory_mib``, the most of any; ``disk_mib``, the size of all outputs.
    """
    of_run = jobs["predicted_seconds"].where(jobs["seconds"].notna())
    rules = jobs.assign(predicted_of_run=of_run).groupby("rule", sort=False)
    return pd.DataFrame(
        {
            "jobs": rules.size(),
            "predicted_longest_seconds": rules["predicted_seconds"].max(),
            "predicted_memory_mib": rules["predicted_memory_mib"].max(),
            "predicted_minutes": rules["predicted_seconds"].sum() / 60,
            "records": rules["seconds"].count(),
            "median_seconds": rules["seconds"].median(),
            "predicted_median_seconds": rules["predicted_of_run"].median(),
            "minutes": rules["seconds"].sum(min_count=1) / 60,
            "longest_seconds": rules["seconds"].max(),
            "memory_mib": rules["memory_mib"].max(),
            "disk_mib": rules["disk_mib"].sum(min_count=1),
        }
    ).reset_index()


def costs_text(costs: pd.DataFrame) -> str:
    """`rule_costs` for people, and the total."""
    shown = costs.set_index("rule")[[*_SHOWN]].dropna(axis=1, how="all").rename_axis(None)
    text = shown.rename(columns=_SHOWN).to_string(
        na_rep="", float_format=lambda value: f"{value:.1f}"
    )
    minutes = costs["predicted_minutes"].sum()
    total = f"total of {costs['jobs'].sum()} jobs, in minutes on one core: {minutes:.1f}"
    return f"{text}\n{total}"


def costs_of_plan(workflow: Any, seconds_per: Mapping[str, float] = SECONDS_PER) -> pd.DataFrame:
    """`job_costs` of a workflow that was only planned, with the rates of some machine."""
    model: CostModel = names_of_rules(workflow)["costs"]
    return job_costs(workflow, model.at(seconds_per), Path(workflow.overwrite_workdir or ""))


def main(arguments: Sequence[str]) -> int:
    """Print the costs of a campaign."""
    print(costs_text(rule_costs(costs_of_plan(planned([*arguments, "--forceall"])))))
    return 0

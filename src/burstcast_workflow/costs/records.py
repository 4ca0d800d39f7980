"""Costs of the jobs of a campaign: predicted, and measured for finished jobs.

::

    burstcast costs [options of snakemake]

The command prints a row for each rule. Every run of a whole campaign writes the same rows at its
end, ``benchmarks/rule_costs.csv`` below the results: beside Snakemake's records of times, not among
the campaign's tables, which are the same bits wherever and whenever they are made.
"""

import csv
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from burstcast_workflow.costs.model import Cost, CostModel
from burstcast_workflow.start import names_of_rules
from snaketrust.checks import RefusedError
from snaketrust.plan import planned

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


def stages_of(jobs: Iterable[Any], model: CostModel) -> Iterator[tuple[Any, str]]:
    """Jobs of Snakemake that are stages of a campaign, with their stages.

    A stage is the first part of the name of a job's record, ``benchmarks/<stage>/...``: rules may
    have other names where another workflow has this one as a module.
    """
    for job in jobs:
        record = Path(job.benchmark or "")
        if record.is_relative_to(model.records):
            yield job, record.relative_to(model.records).parts[0].removesuffix(".tsv")


def costs_of_jobs(jobs: Iterable[Any], model: CostModel) -> Iterator[tuple[Any, Cost]]:
    """Jobs of Snakemake that are stages of a campaign, with what is expected of them."""
    for job, stage in stages_of(jobs, model):
        yield job, model.predicted(model.classes[stage], job.wildcards_dict, stage)


def check_memory(workflow: Any, model: CostModel) -> None:
    """Refuse a run whose networks this machine cannot hold; a dry run only says so.

    Memory of other machines is known to their scheduler alone.
    """
    if not workflow.local_exec:
        return
    machine_mib = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**20
    if reason := beyond_memory(costs_of_jobs(workflow.dag.needrun_jobs(), model), machine_mib):
        if not workflow.dryrun:
            raise RefusedError(reason)
        print(reason, file=sys.stderr)


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


def rule_costs(workflow: Any, model: CostModel, above: Path = Path()) -> pd.DataFrame:
    """Costs of the jobs of each rule of a planned campaign: predicted by sizes, and measured.

    Returns a row for each rule, in their order: ``rule``; ``jobs``, how many the campaign has;
    ``predicted_longest_seconds`` and ``predicted_memory_mib``, the most of any;
    ``predicted_minutes``, of all; ``records``, how many have run. The rest is of these, and empty
    without any: ``median_seconds`` and ``predicted_median_seconds``; ``minutes`` of all;
    ``longest_seconds`` and ``memory_mib``, the most of any; ``disk_mib``, the size of all outputs.
    """
    order = {rule.name: number for number, rule in enumerate(workflow.rules)}
    rows = []
    for job, stage in stages_of(workflow.dag.jobs, model):
        cost = model.predicted(model.classes[stage], job.wildcards_dict)
        record, outputs = above / job.benchmark, [above / path for path in job.output]
        row = {"rule": job.rule.name, "predicted": cost.seconds, "mib": cost.memory_mib}
        rows.append({**row, **(_measured(record, outputs) if record.exists() else {})})
    names = ["rule", "predicted", "mib", "seconds", "sampled", "disk"]
    jobs = pd.DataFrame(rows, columns=names).sort_values(
        "rule", key=lambda rules: rules.map(order), kind="stable"
    )
    rules = jobs.assign(of_run=jobs["predicted"].where(jobs["seconds"].notna())).groupby(
        "rule", sort=False
    )
    return pd.DataFrame(
        {
            "jobs": rules.size(),
            "predicted_longest_seconds": rules["predicted"].max(),
            "predicted_memory_mib": rules["mib"].max(),
            "predicted_minutes": rules["predicted"].sum() / 60,
            "records": rules["seconds"].count(),
            "median_seconds": rules["seconds"].median(),
            "predicted_median_seconds": rules["of_run"].median(),
            "minutes": rules["seconds"].sum(min_count=1) / 60,
            "longest_seconds": rules["seconds"].max(),
            "memory_mib": rules["sampled"].max(),
            "disk_mib": rules["disk"].sum(min_count=1),
        }
    ).reset_index()


def _measured(record: Path, outputs: Iterable[Path]) -> dict[str, float]:
    """Wall time, largest memory that was sampled, size of outputs: what Snakemake has measured."""
    with record.open(encoding="utf-8") as file:
        row = list(csv.DictReader(file, delimiter="\t"))[-1]
    # a job that is over at once is not sampled
    memory = 0.0 if row["max_rss"] in ("-", "NA") else float(row["max_rss"])
    size = sum(path.stat().st_size for path in outputs if path.is_file())
    return {"seconds": float(row["s"]), "sampled": memory, "disk": size / 2**20}


def costs_text(costs: pd.DataFrame, earlier: Mapping[str, float] | None = None) -> str:
    """`rule_costs` for people, and the total, corrected by what earlier jobs took."""
    shown = costs.set_index("rule")[[*_SHOWN]].dropna(axis=1, how="all").rename_axis(None)
    text = shown.rename(columns=_SHOWN).to_string(
        na_rep="", float_format=lambda value: f"{value:.1f}"
    )
    factors = costs["rule"].map(earlier or {}).fillna(1.0)
    minutes = (costs["predicted_minutes"] * factors).sum()
    by = ", corrected by an earlier campaign" if earlier else ""
    jobs = costs["jobs"].sum()
    return f"{text}\ntotal of {jobs} jobs, in minutes on one core{by}: {minutes:.1f}"


def costs_of_plan(workflow: Any, seconds_per: Mapping[str, float] | None = None) -> pd.DataFrame:
    """`rule_costs` of a workflow that was only planned, with the rates of some machine."""
    known: CostModel = names_of_rules(workflow)["costs"]
    model = CostModel(known.campaign, seconds_per)
    model.classes = known.classes
    return rule_costs(workflow, model, Path(workflow.overwrite_workdir or ""))


def main(arguments: Sequence[str]) -> int:
    """Print the costs of a campaign."""
    workflow = planned([*arguments, "--forceall"])
    print(costs_text(costs_of_plan(workflow), names_of_rules(workflow)["costs"].earlier))
    return 0

"""Predicted costs of a campaign, and how they compare with what its jobs took.

::

    burstcast costs [options of snakemake]

All jobs of the campaign are listed by rule, as Snakemake plans them, with their predicted time.
Where results have ``benchmark:`` records, the median of their times and the largest memory are
compared with the predictions for the same jobs: ``!`` marks what is beyond a factor of two. Where
forecasts have records, what each kind of forecaster took follows.

Both are also tables, ``benchmarks/rule_costs.csv`` and ``benchmarks/forecaster_costs.csv`` below
the results, which every run makes at its end. They lie beside the records, not among the campaign's
tables: those are the same bits wherever and whenever they are made, while times are those of one
machine and one day; a rule that made them would run again after every other job.
"""

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from burstcast_workflow.campaign import Campaign
from burstcast_workflow.costs import SECONDS_PER, Cost, CostModel
from burstcast_workflow.harness.tables import write_table
from burstcast_workflow.identifiers import ForecasterName
from burstcast_workflow.snakemake_plan import names_of_rules, planned

FORECASTER_COSTS = "forecaster_costs.csv"
"""Table of what forecasters took, beside the records."""

RULE_COSTS = "rule_costs.csv"
"""Table of what the jobs of each rule took, beside the records."""


@dataclass(frozen=True)
class PredictedJob:
    """A job of the campaign; the file of its record and its outputs are there if it has run.

    Attributes
    ----------
    rule, stage
        Its rule, and that rule's name in this workflow: another one that has it as a module may
        call it otherwise.
    wildcards
        Whose job it is.
    cost
        Predicted.
    record, outputs
        Files.
    """

    rule: str
    stage: str
    wildcards: Mapping[str, str]
    cost: Cost
    record: Path
    outputs: tuple[Path, ...] = ()

    def measured(self) -> dict[str, float]:
        """What Snakemake measured, and the size of those of its outputs that are there.

        ``seconds`` is wall time, ``memory_mib`` the largest resident set that was sampled. The
        processor's time is not among them: samples are up to half a minute apart, and what a job
        does after the last of them is lost.
        """
        with self.record.open(encoding="utf-8") as file:
            row = list(csv.DictReader(file, delimiter="\t"))[-1]
        # a job that is over at once is not sampled
        memory = 0.0 if row["max_rss"] in ("-", "NA") else float(row["max_rss"])
        size = sum(path.stat().st_size for path in self.outputs if path.is_file())
        return {
            "seconds": float(row["s"]),
            "memory_mib": memory,
            "disk_mib": size / 2**20,
        }


def jobs_of_plan(
    workflow: Any, seconds_per: Mapping[str, float] = SECONDS_PER
) -> list[PredictedJob]:
    """All jobs of a campaign that Snakemake has planned, rule by rule."""
    campaign = names_of_rules(workflow)["campaign"]
    above = Path(workflow.overwrite_workdir or "")
    return jobs_with_costs(workflow, campaign, CostModel(campaign, seconds_per), above)


def jobs_with_costs(
    workflow: Any, campaign: Campaign, model: CostModel, above: Path = Path()
) -> list[PredictedJob]:
    """Those jobs of a workflow of Snakemake that are of a campaign, with their costs, rule by rule.

    Parameters
    ----------
    workflow
        As Snakemake has planned it.
    campaign, model
        Whose jobs, and what predicts their costs.
    above
        Directory that the jobs' paths start from.
    """
    rules = [rule.name for rule in workflow.rules]
    found = [
        PredictedJob(
            job.rule.name,
            _request(job).stage,
            job.wildcards_dict,
            cost,
            above / job.benchmark,
            tuple(above / path for path in job.output),
        )
        for job, cost in costs_of_jobs(workflow.dag.jobs, campaign, model)
    ]
    return sorted(found, key=lambda job: (rules.index(job.rule), job.record))


def costs_of_jobs(
    jobs: Iterable[Any], campaign: Campaign, model: CostModel
) -> Iterator[tuple[Any, Cost]]:
    """Those jobs of Snakemake that are of a campaign, with what they cost.

    A target has no output, and nothing is known of the rules of a workflow that has this one as a
    module.
    """
    for job in jobs:
        if job.output and job.rule.module_globals.get("campaign") is campaign:
            asked = _request(job)
            yield job, model.predicted(asked.cost_class, asked.stage, job.wildcards_dict)


def _request(job: Any) -> Any:
    """The function of a job's rule that asks for memory: it knows stage and class of cost."""
    return job.rule.ruleinfo.resources[1]["mem_mb"]


_WHOSE = ("case", "forecaster", "reservoir", "strategies")
_MEASURED = ("seconds", "memory_mib", "disk_mib")


def job_table(jobs: Iterable[PredictedJob]) -> pd.DataFrame:
    """All jobs with what they cost.

    Returns
    -------
    A row for each job: ``rule``, ``stage``, wildcards (``case``, ``forecaster``, ``reservoir``,
    ``strategies``), ``predicted_seconds``, ``predicted_memory_mib`` and, empty for a job without a
    record, what `PredictedJob.measured` tells.
    """
    rows = [
        {
            "rule": job.rule,
            "stage": job.stage,
            **{name: job.wildcards.get(name) for name in _WHOSE},
            "predicted_seconds": job.cost.seconds,
            "predicted_memory_mib": job.cost.memory_mib,
            **(job.measured() if job.record.exists() else dict.fromkeys(_MEASURED, float("nan"))),
        }
        for job in jobs
    ]
    names = ("rule", "stage", *_WHOSE, "predicted_seconds", "predicted_memory_mib", *_MEASURED)
    return pd.DataFrame(rows, columns=list(names))


def rule_costs(jobs: pd.DataFrame) -> pd.DataFrame:
    """What the jobs of each rule take by prediction, and what those took that have records.

    Parameters
    ----------
    jobs
        Of `job_table`.

    Returns
    -------
    A row for each rule, in the order of the jobs: ``rule``; ``jobs``, how many the campaign has;
    ``predicted_longest_seconds`` and ``predicted_memory_mib``, the most of any;
    ``predicted_minutes``, of all; ``records``, how many have run. The rest is of these, and empty
    without any: ``median_seconds`` and ``predicted_median_seconds``; ``minutes`` of all;
    ``longest_seconds`` and ``memory_mib``, the most of any; ``disk_mib``, the size of all outputs.
    """
    has_run = jobs["seconds"].notna()
    jobs = jobs.assign(predicted_of_run=jobs["predicted_seconds"].where(has_run))
    rules = jobs.groupby("rule", sort=False)
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


def report(costs: pd.DataFrame) -> str:
    """`rule_costs` for people, and the total."""
    lines = [
        f"{'rule':<26} {'jobs':>5} {'longest [s]':>11} {'MiB':>5} {'all [min]':>9}"
        f"  {'records':>7} {'median [s]':>10} {'ratio':>6} {'MiB':>5} {'ratio':>6}"
    ]
    for cost in costs.to_dict("records"):
        line = (
            f"{cost['rule']:<26} {cost['jobs']:>5} {cost['predicted_longest_seconds']:>11.1f}"
            f" {cost['predicted_memory_mib']:>5.0f} {cost['predicted_minutes']:>9.1f}"
        )
        if cost["records"]:
            line += f"  {cost['records']:>7} {cost['median_seconds']:>10.1f}"
            line += _ratio(cost["median_seconds"], cost["predicted_median_seconds"])
            line += f" {cost['memory_mib']:>5.0f}" + _ratio(
                cost["memory_mib"], cost["predicted_memory_mib"]
            )
        lines.append(line)
    total = f"total of {costs['jobs'].sum()} jobs, in minutes on one core"
    return "\n".join([*lines, f"{total}: {costs['predicted_minutes'].sum():.1f}"])


def forecaster_costs(jobs: pd.DataFrame, campaign: Campaign) -> pd.DataFrame:
    """Measured times and memory of training and forecasting, by case and kind.

    A scan counts in full for each network that it serves. A job whose results came from the cache
    has the time of a copy.

    Parameters
    ----------
    jobs
        Of `job_table`.
    campaign
        Whose forecasters.

    Returns
    -------
    A row for each case and kind, of networks for each size and strategy: ``case``,
    ``forecaster``, ``neurons``, ``validation``; ``forecasters``, how many of them have records of
    all their jobs; of ``training_``, all that makes a forecaster, and of ``forecast_``, its
    forecast of the evaluation set, the median of ``seconds`` and the largest ``memory_mib``.
    """
    has_run = jobs[jobs["seconds"].notna()]
    keys = has_run[["stage", *_WHOSE]].itertuples(index=False)
    known = {
        tuple(part for part in key if isinstance(part, str)): row
        for key, row in zip(keys, has_run[list(_MEASURED[:2])].to_numpy(), strict=True)
    }
    rows = []
    for one in campaign.forecasters:
        whose = one.case, one.name.identifier
        if one.name.kind == "esn":
            scan = ("scan", one.case, *campaign.scan_of(one.name.identifier))
            made = [scan, ("search", *whose), ("train", *whose)]
        else:
            made = [("fit", *whose)]
        *training, forecast = (known.get(key) for key in (*made, ("forecast", *whose)))
        if forecast is None or any(part is None for part in training):
            continue
        seconds, memory = zip(*training, strict=True)
        kind = one.name.kind, one.name.neurons, one.name.validation
        rows.append([one.case, *kind, sum(seconds), max(memory), *forecast])
    quantities = [f"{of}_{name}" for of in ("training", "forecast") for name in _MEASURED[:2]]
    names = ["case", "forecaster", "neurons", "validation"]
    table = pd.DataFrame(rows, columns=[*names, *quantities]).astype({"neurons": "Int64"})
    groups = table.groupby(names, sort=False, dropna=False)
    return pd.DataFrame(
        {
            "forecasters": groups.size(),
            **{
                name: groups[name].max() if name.endswith("memory_mib") else groups[name].median()
                for name in quantities
            },
        }
    ).reset_index()


def forecasters_report(costs: pd.DataFrame) -> str:
    """`forecaster_costs` for people; "" without any."""
    if costs.empty:
        return ""
    lines = [
        f"{'case':<10} {'forecaster':<26} {'number':>6} {'training [s]':>12} {'MiB':>5}"
        f" {'forecast [s]':>12} {'MiB':>5}"
    ]
    for cost in costs.to_dict("records"):
        network = cost["forecaster"] == "esn"
        axes = (int(cost["neurons"]), cost["validation"]) if network else ()
        lines.append(
            f"{cost['case']:<10} {ForecasterName(cost['forecaster'], *axes).identifier:<26}"
            f" {cost['forecasters']:>6}"
            f" {cost['training_seconds']:>12.1f} {cost['training_memory_mib']:>5.0f}"
            f" {cost['forecast_seconds']:>12.1f} {cost['forecast_memory_mib']:>5.0f}"
        )
    return "\n".join(lines)


def write_costs(jobs: pd.DataFrame, campaign: Campaign, records: Path) -> None:
    """Write `rule_costs` and `forecaster_costs` as tables beside the records (CSV).

    A table that would have no row is not written.
    """
    tables = {RULE_COSTS: rule_costs(jobs), FORECASTER_COSTS: forecaster_costs(jobs, campaign)}
    for name, table in tables.items():
        if len(table):
            write_table(records / name, table)


def _ratio(measured: float, prediction: float) -> str:
    ratio = measured / prediction
    return f" {ratio:>5.2f}" + (" " if 0.5 <= ratio <= 2 else "!")


def main(arguments: Sequence[str]) -> int:
    """Print the reports of a campaign."""
    workflow = planned([*arguments, "--forceall"])
    jobs = job_table(jobs_of_plan(workflow))
    print(report(rule_costs(jobs)))
    if text := forecasters_report(forecaster_costs(jobs, names_of_rules(workflow)["campaign"])):
        print(f"\n{text}")
    return 0

"""Predicted costs of a campaign, and how they compare with what its jobs took.

::

    burstcast costs [options of snakemake]

All jobs of the campaign are listed by rule, as Snakemake plans them, with their predicted time.
Where results have ``benchmark:`` records, the median of their times and the largest memory are
compared with the predictions for the same jobs: ``!`` marks what is beyond a factor of two. Where
forecasts have records, what each kind of forecaster took follows.

What forecasters took is also a table, ``benchmarks/forecaster_costs.csv`` below the results, which
every run makes at its end. It lies beside the records, not among the campaign's tables: those are
the same bits wherever and whenever they are made, while times are those of one machine and one day;
a rule that made it would run again after every other job.
"""

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from statistics import median
from typing import Any

from burstcast_workflow.campaign import Campaign
from burstcast_workflow.costs import SECONDS_PER, Cost, CostModel
from burstcast_workflow.identifiers import ForecasterName
from burstcast_workflow.why import names_of_rules, planned

TABLE = "forecaster_costs.csv"
"""Table of what forecasters took, beside the records."""


@dataclass(frozen=True)
class Measured(Cost):
    """What a job took: wall time and memory as they are predicted, and time of the processor.

    Attributes
    ----------
    processor_seconds
        As far as Snakemake sampled it: of short jobs all, of long ones nearly all. It depends less
        than the wall time on what else the machine did.
    """

    processor_seconds: float


@dataclass(frozen=True)
class PredictedJob:
    """A job of the campaign; the file of its record is there if it has run."""

    rule: str
    wildcards: Mapping[str, str]
    cost: Cost
    record: Path

    def measured(self) -> Measured:
        """What Snakemake measured: wall time, time of the processor, largest resident set."""
        return _measured(self.record)


def predicted_jobs(
    arguments: Sequence[str] = (), seconds_per: Mapping[str, float] = SECONDS_PER
) -> list[PredictedJob]:
    """All jobs of the campaign that options of snakemake name, rule by rule, done or not."""
    return _jobs(planned([*arguments, "--forceall"]), seconds_per)


def _jobs(workflow: Any, seconds_per: Mapping[str, float] = SECONDS_PER) -> list[PredictedJob]:
    """All jobs of a plan."""
    campaign = names_of_rules(workflow)["campaign"]
    model = CostModel(campaign, seconds_per)
    above = Path(workflow.overwrite_workdir or "")
    found = [
        PredictedJob(job.rule.name, job.wildcards_dict, cost, above / job.benchmark)
        for job, cost in costs_of_jobs(workflow.dag.jobs, campaign, model)
    ]
    rules = [rule.name for rule in workflow.rules]
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
            memory = job.rule.ruleinfo.resources[1]["mem_mb"]
            yield job, model.predicted(memory.cost_class, memory.stage, job.wildcards_dict)


def report(jobs: Sequence[PredictedJob]) -> str:
    """Predicted costs rule by rule, what the jobs took where that is known, and the total."""
    lines = [
        f"{'rule':<26} {'jobs':>5} {'longest [s]':>11} {'MiB':>5} {'all [min]':>9}"
        f"  {'records':>7} {'median [s]':>10} {'ratio':>6} {'MiB':>5} {'ratio':>6}"
    ]
    for rule, group in groupby(jobs, lambda job: job.rule):
        of_rule = list(group)
        costs = [job.cost for job in of_rule]
        line = (
            f"{rule:<26} {len(costs):>5} {max(cost.seconds for cost in costs):>11.1f}"
            f" {max(cost.memory_mib for cost in costs):>5.0f}"
            f" {sum(cost.seconds for cost in costs) / 60:>9.1f}"
        )
        if run := [job for job in of_rule if job.record.exists()]:
            measured = [job.measured() for job in run]
            seconds = median(cost.seconds for cost in measured)
            memory = max(cost.memory_mib for cost in measured)
            line += f"  {len(run):>7} {seconds:>10.1f}"
            line += _ratio(seconds, median(job.cost.seconds for job in run))
            line += f" {memory:>5.0f}" + _ratio(memory, max(job.cost.memory_mib for job in run))
        lines.append(line)
    minutes = sum(job.cost.seconds for job in jobs) / 60
    return "\n".join([*lines, f"total of {len(jobs)} jobs, in minutes on one core: {minutes:.1f}"])


@dataclass(frozen=True)
class ForecasterCost:
    """What forecasters of a kind, of networks those of one size and strategy, took in a case.

    Attributes
    ----------
    case, name
        Whose it is; no seed.
    forecasters
        How many of them have records of all their jobs.
    training, forecast
        Medians over these of the times, and the largest memory: of all that makes a forecaster, and
        of the forecast of the evaluation set.
    """

    case: str
    name: ForecasterName
    forecasters: int
    training: Measured
    forecast: Measured

    @property
    def row(self) -> dict[str, str | int | float | None]:
        """Row of a table, keys first."""
        parts = {"training": self.training, "forecast": self.forecast}
        return {
            "case": self.case,
            "forecaster": self.name.kind,
            "neurons": self.name.neurons,
            "validation": self.name.validation,
            "forecasters": self.forecasters,
            **{
                f"{part}_{quantity}": getattr(cost, quantity)
                for part, cost in parts.items()
                for quantity in ("seconds", "processor_seconds", "memory_mib")
            },
        }


def forecaster_costs(campaign: Campaign, records: Path) -> list[ForecasterCost]:
    """Measured times and memory of training and forecasting, by case and kind.

    A scan counts in full for each network that it serves. A job whose results came from the cache
    has the time of a copy.

    Parameters
    ----------
    campaign
        Whose forecasters.
    records
        Directory of the ``benchmark:`` records of its jobs.
    """
    found: dict[tuple[str, ForecasterName], list[tuple[Measured, Measured]]] = {}
    for one in campaign.forecasters:
        identifier = one.name.identifier
        if one.name.kind == "esn":
            scan = "scan/{}/{}/{}".format(one.case, *campaign.scan_of(identifier))
            made = [scan, f"search/{one.directory}", f"train/{one.directory}"]
        else:
            made = [f"fit/{one.directory}"]
        paths = [records / f"{name}.tsv" for name in (*made, f"forecast/{one.directory}")]
        if all(path.exists() for path in paths):
            *training, forecast = map(_measured, paths)
            total = Measured(
                sum(cost.seconds for cost in training),
                max(cost.memory_mib for cost in training),
                sum(cost.processor_seconds for cost in training),
            )
            whose = one.case, replace(one.name, seed=None)
            found.setdefault(whose, []).append((total, forecast))
    return [
        ForecasterCost(case, name, len(both), *map(_typical, zip(*both, strict=True)))
        for (case, name), both in found.items()
    ]


def _measured(record: Path) -> Measured:
    with record.open(encoding="utf-8") as file:
        row = list(csv.DictReader(file, delimiter="\t"))[-1]
    # a job that is over at once is not sampled
    memory, processor = (
        0.0 if row[name] in ("-", "NA") else float(row[name]) for name in ("max_rss", "cpu_time")
    )
    return Measured(float(row["s"]), memory, processor)


def _typical(costs: Sequence[Measured]) -> Measured:
    return Measured(
        median(cost.seconds for cost in costs),
        max(cost.memory_mib for cost in costs),
        median(cost.processor_seconds for cost in costs),
    )


def forecasters_report(costs: Sequence[ForecasterCost]) -> str:
    """Table of `forecaster_costs` for people; "" without any."""
    if not costs:
        return ""
    head = (
        f"{'case':<10} {'forecaster':<26} {'number':>6} {'training [s]':>12} {'MiB':>5}"
        f" {'forecast [s]':>12} {'MiB':>5}"
    )
    return "\n".join(
        [head]
        + [
            f"{cost.case:<10} {cost.name.identifier:<26} {cost.forecasters:>6}"
            + "".join(
                f" {part.seconds:>12.1f} {part.memory_mib:>5.0f}"
                for part in (cost.training, cost.forecast)
            )
            for cost in costs
        ]
    )


def write_forecaster_costs(campaign: Campaign, records: Path) -> None:
    """Write `forecaster_costs` as a table beside the records (CSV); nothing without any."""
    rows = [cost.row for cost in forecaster_costs(campaign, records)]
    if rows:
        with (records / TABLE).open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


def _ratio(measured: float, prediction: float) -> str:
    ratio = measured / prediction
    return f" {ratio:>5.2f}" + (" " if 0.5 <= ratio <= 2 else "!")


def main(arguments: Sequence[str]) -> int:
    """Print the reports of a campaign."""
    workflow = planned([*arguments, "--forceall"])
    names = names_of_rules(workflow)
    print(report(_jobs(workflow)))
    records = Path(workflow.overwrite_workdir or "", names["TIMES"])
    if text := forecasters_report(forecaster_costs(names["campaign"], records)):
        print(f"\n{text}")
    return 0

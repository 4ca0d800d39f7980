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
from dataclasses import asdict, dataclass, replace
from itertools import groupby
from pathlib import Path
from statistics import median
from typing import Any

from burstcast_workflow.campaign import Campaign
from burstcast_workflow.costs import SECONDS_PER, Cost, CostModel
from burstcast_workflow.identifiers import ForecasterName
from burstcast_workflow.why import names_of_rules, planned

FORECASTER_COSTS = "forecaster_costs.csv"
"""Table of what forecasters took, beside the records."""

RULE_COSTS = "rule_costs.csv"
"""Table of what the jobs of each rule took, beside the records."""


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
    """A job of the campaign; the file of its record and its outputs are there if it has run."""

    rule: str
    wildcards: Mapping[str, str]
    cost: Cost
    record: Path
    outputs: tuple[Path, ...] = ()

    def measured(self) -> Measured:
        """What Snakemake measured: wall time, time of the processor, largest resident set."""
        return measured(self.record)

    def disk_mib(self) -> float:
        """Size of those of its outputs that are there."""
        return sum(path.stat().st_size for path in self.outputs if path.is_file()) / 2**20


def predicted_jobs(
    arguments: Sequence[str] = (), seconds_per: Mapping[str, float] = SECONDS_PER
) -> list[PredictedJob]:
    """All jobs of the campaign that options of snakemake name, rule by rule, done or not."""
    return _jobs(planned([*arguments, "--forceall"]), seconds_per)


def _jobs(workflow: Any, seconds_per: Mapping[str, float] = SECONDS_PER) -> list[PredictedJob]:
    """All jobs of a plan."""
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
            memory = job.rule.ruleinfo.resources[1]["mem_mb"]
            yield job, model.predicted(memory.cost_class, memory.stage, job.wildcards_dict)


@dataclass(frozen=True)
class RuleCost:
    """What the jobs of a rule take by prediction, and what those took that have records.

    Attributes
    ----------
    rule, jobs
        How many jobs the campaign has of it.
    predicted_longest_seconds, predicted_memory_mib
        The most of any job.
    predicted_minutes
        Of all jobs, one after the other.
    records
        How many have run. What follows is of these, and None without any.
    median_seconds, predicted_median_seconds
        Wall times, measured and predicted.
    minutes, processor_minutes
        Of all that have run: wall and processor time.
    memory_mib
        Largest resident set of any.
    disk_mib
        Size of all of their outputs.
    """

    rule: str
    jobs: int
    predicted_longest_seconds: float
    predicted_memory_mib: float
    predicted_minutes: float
    records: int
    median_seconds: float | None = None
    predicted_median_seconds: float | None = None
    minutes: float | None = None
    processor_minutes: float | None = None
    memory_mib: float | None = None
    disk_mib: float | None = None


def rule_costs(jobs: Sequence[PredictedJob]) -> list[RuleCost]:
    """Costs rule by rule: `RuleCost` for each, in the order of the jobs."""
    return [_rule_cost(rule, list(group)) for rule, group in groupby(jobs, lambda job: job.rule)]


def _rule_cost(rule: str, jobs: Sequence[PredictedJob]) -> RuleCost:
    run = [job for job in jobs if job.record.exists()]
    predicted = RuleCost(
        rule,
        len(jobs),
        max(job.cost.seconds for job in jobs),
        max(job.cost.memory_mib for job in jobs),
        sum(job.cost.seconds for job in jobs) / 60,
        len(run),
    )
    if not run:
        return predicted
    measured = [job.measured() for job in run]
    return replace(
        predicted,
        median_seconds=median(cost.seconds for cost in measured),
        predicted_median_seconds=median(job.cost.seconds for job in run),
        minutes=sum(cost.seconds for cost in measured) / 60,
        processor_minutes=sum(cost.processor_seconds for cost in measured) / 60,
        memory_mib=max(cost.memory_mib for cost in measured),
        disk_mib=sum(job.disk_mib() for job in run),
    )


def report(costs: Sequence[RuleCost]) -> str:
    """Predicted costs rule by rule, what the jobs took where that is known, and the total."""
    lines = [
        f"{'rule':<26} {'jobs':>5} {'longest [s]':>11} {'MiB':>5} {'all [min]':>9}"
        f"  {'records':>7} {'median [s]':>10} {'ratio':>6} {'MiB':>5} {'ratio':>6}"
    ]
    for cost in costs:
        line = (
            f"{cost.rule:<26} {cost.jobs:>5} {cost.predicted_longest_seconds:>11.1f}"
            f" {cost.predicted_memory_mib:>5.0f} {cost.predicted_minutes:>9.1f}"
        )
        if cost.median_seconds and cost.predicted_median_seconds and cost.memory_mib is not None:
            line += f"  {cost.records:>7} {cost.median_seconds:>10.1f}"
            line += _ratio(cost.median_seconds, cost.predicted_median_seconds)
            line += f" {cost.memory_mib:>5.0f}" + _ratio(cost.memory_mib, cost.predicted_memory_mib)
        lines.append(line)
    total = f"total of {sum(cost.jobs for cost in costs)} jobs, in minutes on one core"
    return "\n".join([*lines, f"{total}: {sum(cost.predicted_minutes for cost in costs):.1f}"])


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
            *training, forecast = map(measured, paths)
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


def measured(record: Path) -> Measured:
    """What Snakemake's record of a job (``benchmark:``) says."""
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


def write_costs(jobs: Sequence[PredictedJob], campaign: Campaign, records: Path) -> None:
    """Write `rule_costs` and `forecaster_costs` as tables beside the records (CSV).

    A table that would have no row is not written.
    """
    _write(records / RULE_COSTS, [asdict(cost) for cost in rule_costs(jobs)])
    _write(records / FORECASTER_COSTS, [cost.row for cost in forecaster_costs(campaign, records)])


def _write(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    if rows:
        with path.open("w", encoding="utf-8", newline="") as file:
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
    print(report(rule_costs(_jobs(workflow))))
    records = Path(workflow.overwrite_workdir or "", names["TIMES"])
    if text := forecasters_report(forecaster_costs(names["campaign"], records)):
        print(f"\n{text}")
    return 0

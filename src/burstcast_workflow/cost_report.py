"""Predicted costs of a campaign, and how they compare with what its jobs took.

::

    python -m burstcast_workflow.cost_report [options of snakemake]

All jobs of the campaign are listed by rule, as Snakemake plans them, with their predicted time.
Where results have ``benchmark:`` records, the median of their times and the largest memory are
compared with the predictions for the same jobs: ``!`` marks what is beyond a factor of two. Where
forecasts have records, what each kind of forecaster took follows: times are those of one machine,
so that no table of the campaign holds them.
"""

import csv
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from statistics import median

from burstcast_workflow.costs import SECONDS_PER, Cost, CostModel
from burstcast_workflow.identifiers import parsed
from burstcast_workflow.why import planned

TRAINING_RULES = ("search", "train", "fit")
"""What makes a forecaster, beside the scan that networks of a reservoir share."""


@dataclass(frozen=True)
class PredictedJob:
    """A job of the campaign; the file of its record is there if it has run."""

    rule: str
    wildcards: Mapping[str, str]
    cost: Cost
    record: Path

    def measured(self) -> Cost:
        """What Snakemake measured: wall time, largest resident set."""
        with self.record.open(encoding="utf-8") as file:
            row = list(csv.DictReader(file, delimiter="\t"))[-1]
        memory = row["max_rss"]  # that of a job that is over at once is not sampled
        return Cost(float(row["s"]), 0.0 if memory in ("-", "NA") else float(memory))


def predicted_jobs(
    arguments: Sequence[str] = (), seconds_per: Mapping[str, float] = SECONDS_PER
) -> list[PredictedJob]:
    """All jobs of the campaign that options of snakemake name, rule by rule, done or not."""
    workflow = planned([*arguments, "--forceall"])
    model = CostModel(workflow.globals["campaign"], seconds_per)
    found = []
    for job in workflow.dag.jobs:
        if job.output:  # a target has none
            memory = job.rule.ruleinfo.resources[1]["mem_mb"]
            cost = model.predicted(memory.cost_class, memory.stage, job.wildcards_dict)
            record = Path(workflow.overwrite_workdir or "", job.benchmark)
            found.append(PredictedJob(job.rule.name, job.wildcards_dict, cost, record))
    rules = [rule.name for rule in workflow.rules]
    return sorted(found, key=lambda job: (rules.index(job.rule), job.record))


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


def forecasters_report(jobs: Sequence[PredictedJob]) -> str:
    """Measured times and memory of training and forecasting, by case and kind; "" without records.

    Networks of a size and strategy share a line, with the medians over those whose jobs all have
    records. A scan counts in full for each network that it serves. A job whose results came from
    the cache has the time of a copy.
    """
    measured: dict[tuple[str, str], dict[str, Cost]] = {}
    scans: dict[tuple[str, str], Cost] = {}
    for job in jobs:
        if not job.record.exists():
            continue
        if job.rule == "scan":
            scans[job.wildcards["case"], job.wildcards["reservoir"]] = job.measured()
        elif job.rule in (*TRAINING_RULES, "forecast"):
            key = (job.wildcards["case"], job.wildcards["forecaster"])
            measured.setdefault(key, {})[job.rule] = job.measured()
    lines: dict[tuple[str, str], list[tuple[Cost, Cost]]] = {}
    for (case, identifier), costs in measured.items():
        name = parsed(identifier)
        if name.neurons is not None:  # a network
            reservoir = replace(name, validation=None).identifier
            if (case, reservoir) in scans:
                costs["scan"] = scans[case, reservoir]
            needed = {"scan", "search", "train", "forecast"}
        else:
            needed = {"fit", "forecast"}
        if needed <= costs.keys():
            training = [cost for rule, cost in costs.items() if rule != "forecast"]
            total = Cost(
                sum(cost.seconds for cost in training), max(cost.memory_mib for cost in training)
            )
            kind = replace(name, seed=None).identifier
            lines.setdefault((case, kind), []).append((total, costs["forecast"]))
    if not lines:
        return ""
    head = (
        f"{'case':<10} {'forecaster':<26} {'number':>6} {'training [s]':>12} {'MiB':>5}"
        f" {'forecast [s]':>12} {'MiB':>5}"
    )
    return "\n".join(
        [head]
        + [
            f"{case:<10} {kind:<26} {len(both):>6}"
            + "".join(
                f" {median(cost.seconds for cost in costs):>12.1f}"
                f" {max(cost.memory_mib for cost in costs):>5.0f}"
                for costs in zip(*both, strict=True)
            )
            for (case, kind), both in lines.items()
        ]
    )


def _ratio(measured: float, prediction: float) -> str:
    ratio = measured / prediction
    return f" {ratio:>5.2f}" + (" " if 0.5 <= ratio <= 2 else "!")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the reports of a campaign."""
    jobs = predicted_jobs(sys.argv[1:] if arguments is None else arguments)
    print(report(jobs))
    if text := forecasters_report(jobs):
        print(f"\n{text}")


if __name__ == "__main__":
    main()

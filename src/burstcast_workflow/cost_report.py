"""Predicted costs of a campaign, and how they compare with what its jobs took.

::

    python -m burstcast_workflow.cost_report [options of snakemake]

All jobs of the campaign are listed by rule, as Snakemake plans them, with their predicted time.
Where results have ``benchmark:`` records, the median of their times and the largest memory are
compared with the predictions for the same jobs: ``!`` marks what is beyond a factor of two.
"""

import csv
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from statistics import median

from burstcast_workflow.costs import SECONDS_PER, Cost, CostModel
from burstcast_workflow.why import planned


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


def _ratio(measured: float, prediction: float) -> str:
    ratio = measured / prediction
    return f" {ratio:>5.2f}" + (" " if 0.5 <= ratio <= 2 else "!")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the report of a campaign."""
    print(report(predicted_jobs(sys.argv[1:] if arguments is None else arguments)))


if __name__ == "__main__":
    main()

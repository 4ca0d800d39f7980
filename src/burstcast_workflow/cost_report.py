"""Predicted costs of a campaign, and how they compare with what its jobs took.

::

    python -m burstcast_workflow.cost_report [--configfile FILE ...] [RESULTS]

Without results, the campaign's predicted time is listed by rule. With a directory of results, the
``benchmark:`` records below it are compared with the predictions for the same jobs.
"""

import argparse
import csv
import re
import statistics
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.costs import Cost, CostModel

_JOB = re.compile(
    r"(?P<reservoir>esn-N\d+-seed\d+)-(?P<strategies>[A-Z+]+)"
    r"|(?P<forecaster>[a-z][A-Za-z0-9_.-]*?)(-PT(?P<prediction_time_lt>[\d.]+))?"
)
_OF_A_CASE = ("simulate", "lyapunov", "evaluation_set", "events", "reference_statistics")
_OF_A_FORECASTER = ("forecast", "horizon")
_OF_ALL = ("dataset_table", "hyperparameters_table", "classification_table", "horizon_table")


@dataclass(frozen=True)
class Record:
    """What Snakemake measured of one job: seconds of wall time, MiB of its largest resident set."""

    rule: str
    wildcards: Mapping[str, str]
    seconds: float
    memory_mib: float


def jobs(campaign: Campaign) -> Iterator[tuple[str, dict[str, str]]]:
    """Rule and wildcards of the campaign's jobs, figures and the smallest tables left out."""
    for case in campaign.case_names:
        for rule in _OF_A_CASE:
            yield rule, {"case": case}
    scans = {(one.case, *campaign.scan_of(one.name.identifier)) for one in campaign.networks}
    for case, reservoir, strategies in sorted(scans):
        yield "scan", {"case": case, "reservoir": reservoir, "strategies": strategies}
    for one in campaign.forecasters:
        first = ("search", "train") if one in campaign.networks else ("fit",)
        for rule in (*first, *_OF_A_FORECASTER):
            yield rule, one.identity
    for one in campaign.long_term_forecasters:
        yield "long_term", one.identity
    for run in campaign.control_runs:
        time = f"{run.prediction_time_lt:g}"
        yield run.rule, {**run.forecaster.identity, "prediction_time_lt": time}
    for rule in _OF_ALL:
        yield rule, {}


def records(results: Path) -> Iterator[Record]:
    """Read all ``benchmark:`` records of a results directory."""
    root = results / "benchmarks"
    for path in sorted(root.rglob("*.tsv")):
        with path.open(encoding="utf-8") as file:
            row = list(csv.DictReader(file, delimiter="\t"))[-1]
        memory = row["max_rss"]
        yield Record(
            *_job(path.relative_to(root).with_suffix("")),
            float(row["s"]),
            float(memory) if memory not in ("-", "NA") else 0.0,
        )


def _job(path: Path) -> tuple[str, dict[str, str]]:
    """Rule and wildcards of a record from its place: rule, rule/case or rule/case/forecaster."""
    rule, *rest = path.parts
    if len(rest) < 2:
        return rule, {"case": rest[0]} if rest else {}
    match = _JOB.fullmatch(rest[1])
    assert match is not None  # the pattern's first part matches any name
    found = {name: value for name, value in match.groupdict().items() if value is not None}
    return rule, {"case": rest[0], **found}


def compare(campaign: Campaign, measured: Iterable[Record]) -> list[str]:
    """Lines that compare records with predictions, rule by rule."""
    model = CostModel(campaign)
    by_rule: dict[str, list[tuple[Record, Cost]]] = defaultdict(list)
    for record in measured:
        wildcards = record.wildcards
        if wildcards.get("case", "") not in ("", *campaign.cases):
            wildcards = {}  # a rule's own wildcard, such as the name of a table
        by_rule[record.rule].append((record, model.predicted(record.rule, wildcards)))
    lines = [
        f"{'rule':<28} {'jobs':>5} {'seconds':>9} {'predicted':>9} {'ratio':>6}"
        f" {'MiB':>7} {'predicted':>9} {'ratio':>6}"
    ]
    for rule, pairs in sorted(by_rule.items()):
        seconds = statistics.median(record.seconds for record, _ in pairs)
        predicted_seconds = statistics.median(cost.seconds for _, cost in pairs)
        # the memory of a job that is over at once is not sampled
        memory = max(record.memory_mib for record, _ in pairs)
        predicted_memory = max(cost.memory_mib for _, cost in pairs)
        lines.append(
            f"{rule:<28} {len(pairs):>5} {seconds:>9.1f} {predicted_seconds:>9.1f}"
            f" {_ratio(seconds, predicted_seconds):>6}"
            f" {memory:>7.0f} {predicted_memory:>9.0f} {_ratio(memory, predicted_memory):>6}"
        )
    lines.append(
        "seconds: the median of a rule's jobs; MiB: the largest; !: beyond a factor of two"
    )
    return lines


def _ratio(measured: float, prediction: float) -> str:
    ratio = measured / prediction
    return f"{ratio:.2f}" + (" " if 0.5 <= ratio <= 2 else "!")


def forecast_lines(campaign: Campaign, model: CostModel | None = None) -> list[str]:
    """Lines with the predicted time of a campaign, rule by rule and in total.

    Parameters
    ----------
    campaign
        The campaign.
    model
        Its costs; None: those of `burstcast_workflow.costs.SECONDS_PER`.
    """
    model = CostModel(campaign) if model is None else model
    seconds: dict[str, list[float]] = defaultdict(list)
    for rule, wildcards in jobs(campaign):
        seconds[rule].append(model.predicted(rule, wildcards).seconds)
    total = sum(sum(of_rule) for of_rule in seconds.values())
    lines = [f"{'rule':<28} {'jobs':>6} {'longest [s]':>12} {'all [min]':>10}"]
    lines += [
        f"{rule:<28} {len(of_rule):>6} {max(of_rule):>12.1f} {sum(of_rule) / 60:>10.1f}"
        for rule, of_rule in seconds.items()
    ]
    count = sum(len(of_rule) for of_rule in seconds.values())
    lines.append(f"{'total, on one core':<28} {count:>6} {'':>12} {total / 60:>10.1f}")
    return lines


def read_campaign(config_files: Sequence[Path]) -> Campaign:
    """Expand the campaign of ``config.yaml`` with overlays laid over it."""
    merged: dict[str, Any] = {}
    for path in config_files:
        _update(merged, yaml.safe_load(path.read_text(encoding="utf-8")))
    config = load(merged)
    return Campaign(config)


def _update(base: dict[str, Any], overlay: Mapping[str, Any]) -> None:
    """Lay a mapping over another as Snakemake does: mappings merge, everything else is replaced."""
    for key, value in overlay.items():
        if isinstance(value, Mapping) and isinstance(base.get(key), dict):
            _update(base[key], value)
        else:
            base[key] = value


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a comparison or a prediction."""
    parser = argparse.ArgumentParser(
        prog="python -m burstcast_workflow.cost_report",
        description="Predicted costs of a campaign, and how they compare with what its jobs took.",
    )
    parser.add_argument("results", type=Path, nargs="?", help="directory of results")
    parser.add_argument(
        "--configfile", type=Path, nargs="+", default=[], help="overlays on config.yaml"
    )
    options = parser.parse_args(arguments)
    campaign = read_campaign([Path("config.yaml"), *options.configfile])
    if options.results is None:
        print("\n".join(forecast_lines(campaign)))
    else:
        print("\n".join(compare(campaign, records(options.results))))


if __name__ == "__main__":
    main()

"""Score control by its costs and gains, with intervals over flows; compare runs."""

from collections.abc import Sequence
from dataclasses import fields

from burstcast import random_streams
from burstcast.arrays import IntArray
from burstcast.control.differences import ComparedRun, paired_differences
from burstcast.control.records import COSTS, FlowRecords, Span, flow_intervals, score_flows
from burstcast.control.setting_names import as_columns
from burstcast.forecasters._names import ForecasterName
from burstcast.tables.cells import Scores, medians_over_seeds, with_interval
from burstcast.tables.makers.registry import Declaration, Gathered, Rows

TABLES = Declaration(
    gathered={"flows": ""},
    settings={
        "case": "case",
        "root_seed": "random_seed",
        "noise": "case.training.noise",
        "resamples": "bootstrap.resamples",
        "confidence": "bootstrap.confidence",
    },
)


def make(
    *,
    flows: Sequence[Gathered],
    case: str,
    root_seed: int,
    noise: float,
    resamples: int,
    confidence: float,
) -> dict[str, Rows]:
    """A row for each run of control and score, and paired differences between runs."""
    rows: Rows = []
    flows_of: dict[str, tuple[IntArray, Span]] = {}
    scores_of: dict[str, list[tuple[ForecasterName, Scores]]] = {}
    for one in flows:
        found = {field.name: one.content[field.name] for field in fields(FlowRecords)}
        records = FlowRecords(**found)
        span = Span(**{field.name: int(one.content[field.name]) for field in fields(Span)})
        plan = dict(one.plan)
        # noise is the case's, unless the plan has one of its own: equations are given none
        settings = as_columns(plan.pop("settings"))
        keys = {**one.name.keys, "noise": noise, **settings, **plan}
        # all runs of a case are resampled alike: their flows are the same
        generator = random_streams.stream(root_seed, "control", case)
        costs = {name: one.content[name] for name in COSTS if name in one.content}
        scores = score_flows(records, span, resamples, generator, costs)
        rows += [
            {**keys, "metric": name, "value": score.value, "low": score.low, "high": score.high}
            for name, score in flow_intervals(scores, records, span, confidence).items()
        ]
        # whoever forecasts, flows of one strategy are the same
        flows_of[one.strategy] = records.row, span
        scores_of.setdefault(one.strategy, []).append((one.name, scores))
    compared = [
        ComparedRun(None if name == "none" else name, strategy, *flows_of[strategy], scores)
        for strategy, of_runs in scores_of.items()
        for name, scores in medians_over_seeds(of_runs).items()
    ]
    pairs = [
        {
            **{"compared": run.forecaster, "strategy": run.strategy},
            **{"other": other.forecaster, "other_strategy": other.strategy, "metric": metric},
            **with_interval(difference, confidence),
        }
        for run, other, metric, difference in paired_differences(compared)
    ]
    return {"control_strategies": rows, "control_differences": pairs}

"""Score all control by what it costs and gains, with intervals over flows; compare runs."""

from dataclasses import fields
from typing import Any

from burstcast import random_streams
from burstcast.arrays import IntArray
from burstcast.control.differences import ComparedRun, paired_differences
from burstcast.control.records import FlowRecords, Span, flow_intervals, score_flows
from burstcast.files.netcdf import read_attributes, read_netcdf
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.tables import Scores, medians_over_seeds, with_interval, write_tables


@job
def control_strategies_table(*, flows: list[str], tables: list[str], settings: Settings) -> None:
    """Write a row for each run of control and score, and paired differences between runs."""
    rows = []
    resamples, confidence = settings["bootstrap.resamples"], settings["bootstrap.confidence"]
    flows_of: dict[str, tuple[IntArray, Span]] = {}
    scores_of: dict[str, list[tuple[dict[str, Any], Scores]]] = {}
    for of_controller, origin in gathered(settings, flows):
        arrays, attributes = read_netcdf(origin.path), read_attributes(origin.path)
        records = FlowRecords(**{field.name: arrays[field.name] for field in fields(FlowRecords)})
        span = Span(**{field.name: int(attributes[field.name]) for field in fields(Span)})
        plan = dict(origin.settings["control.run"])
        keys = {
            **of_controller,
            # the case's, unless the plan has one of its own: equations are given none
            "noise": settings["case.training.noise"],
            **plan.pop("settings"),
            **plan,
        }
        # all runs of a case are resampled alike: their flows are the same
        generator = random_streams.stream(settings["random_seed"], "control", keys["case"])
        scores = score_flows(records, span, resamples, generator)
        rows += [
            {**keys, "metric": name, "value": score.value, "low": score.low, "high": score.high}
            for name, score in flow_intervals(scores, records, span, confidence).items()
        ]
        # whoever forecasts, flows of one strategy are the same
        strategy = origin.identity["strategy"]
        flows_of[strategy] = records.row, span
        scores_of.setdefault(strategy, []).append((keys, scores))
    compared = [
        ComparedRun(None if name == "none" else name, strategy, *flows_of[strategy], scores)
        for strategy, found in scores_of.items()
        for name, scores in medians_over_seeds(found).items()
    ]
    pairs = [
        {
            **{"case": settings["case"], "compared": run.forecaster, "strategy": run.strategy},
            **{"other": other.forecaster, "other_strategy": other.strategy, "metric": metric},
            **with_interval(difference, confidence),
        }
        for run, other, metric, difference in paired_differences(compared)
    ]
    write_tables(tables, settings, control_strategies=rows, control_differences=pairs)

"""Score control by its costs and gains, with intervals over flows; compare runs."""

from collections.abc import Sequence

from burstcast import random_streams
from burstcast.arrays import IntArray
from burstcast.control.differences import ComparedRun, paired_differences
from burstcast.control.records import Span, flow_intervals, score_flows
from burstcast.forecasters._names import ForecasterName
from burstcast.tables.cells import Scores, medians_over_seeds, with_interval
from burstcast.tables.makers._control_runs import FLOWS, flows_of, keys_of
from burstcast.tables.makers.registry import Declaration, Gathered, Rows

TABLES = Declaration(
    gathered={"flows": FLOWS},
    settings="case root_seed=random_seed case.training.noise bootstrap.resamples "
    "bootstrap.confidence",
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
    counted: dict[str, tuple[IntArray, Span]] = {}
    scores_of: dict[str, list[tuple[ForecasterName, Scores]]] = {}
    for one in flows:
        sample, keys = flows_of(one), keys_of(one, noise)
        records, span = sample.records, sample.span
        # all runs of a case are resampled alike: their flows are the same
        generator = random_streams.stream(root_seed, "control", case)
        scores = score_flows(records, span, resamples, generator, sample.costs)
        rows += [
            {**keys, "metric": name, "value": score.value, "low": score.low, "high": score.high}
            for name, score in flow_intervals(scores, records, span, confidence).items()
        ]
        # whoever forecasts, flows of one strategy are the same
        counted[one.strategy] = records.row, span
        scores_of.setdefault(one.strategy, []).append((one.name, scores))
    compared = [
        ComparedRun(None if name == "none" else name, strategy, *counted[strategy], scores)
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

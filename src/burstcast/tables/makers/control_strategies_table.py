"""Score control by its costs and gains, with intervals over flows."""

from collections.abc import Sequence

from burstcast.base import random_streams
from burstcast.base.declared import at, declaring, gathered
from burstcast.control.records import FlowSample, flow_intervals, score_flows
from burstcast.tables.makers._control_runs import FLOWS, keys_of
from burstcast.tables.makers.registry import Gathered, Rows


@declaring
def make(
    *,
    flows: Sequence[Gathered] = gathered("strategy_runs/flows.nc", FLOWS),
    case: str = at("case"),
    root_seed: int = at("random_seed"),
    noise: float = at("case.training.noise"),
    resamples: int = at("bootstrap.resamples"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """A row for each run of control and score."""
    rows: Rows = []
    for run in flows:
        sample, keys = FlowSample.of(run.content), keys_of(run, noise)
        # all runs of a case are resampled alike: their flows are the same
        generator = random_streams.stream(root_seed, "control", case)
        scores = score_flows(sample, resamples, generator)
        rows += [
            {**keys, "metric": name, "value": score.value, "low": score.low, "high": score.high}
            for name, score in flow_intervals(scores, sample, confidence).items()
        ]
    return {"control_strategies": rows}

"""Compare strategies at their best: settings are chosen on half of the flows, scored on the others.

`burstcast.control.choice.choose` defines the choice.
"""

from collections.abc import Sequence

from burstcast.base import random_streams
from burstcast.base.declared import at, declaring, gathered
from burstcast.control.choice import choose
from burstcast.control.records import COSTS, FlowSample, flow_intervals, score_flows
from burstcast.control.setting_names import as_columns
from burstcast.tables.makers._control_runs import FLOWS, conditions_of, keys_of
from burstcast.tables.makers.registry import Gathered, Rows

METRICS = (
    "exceedance_uncontrolled",
    "exceedance_controlled",
    "relative_exceedance",
    "control_fraction",
    *COSTS,
)
"""Scores of the chosen runs."""


@declaring
def make(
    *,
    flows: Sequence[Gathered] = gathered("chosen_runs/flows.nc", FLOWS),
    case: str = at("case"),
    root_seed: int = at("random_seed"),
    noise: float = at("case.training.noise"),
    tolerance: float = at("control.tolerated_exceedance"),
    resamples: int = at("bootstrap.resamples"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """A row for each strategy, condition, controller and score."""
    groups: dict[tuple[object, ...], list[Gathered]] = {}
    for run in flows:
        options = as_columns(run.plan["settings"]).get("options")
        groups.setdefault((run.name, options, *conditions_of(run).items()), []).append(run)
    rows: Rows = []
    for runs in groups.values():
        halves = [FlowSample.of(run.content).halves() for run in runs]
        number = choose([choosing for choosing, _ in halves], tolerance)
        chosen, (_, scored) = runs[number], halves[number]
        # all are resampled alike
        generator = random_streams.stream(root_seed, "control choice", case)
        scores = flow_intervals(score_flows(scored, resamples, generator), scored, confidence)
        keys = {**keys_of(chosen, noise), "candidates": len(runs), "scored_flows": len(scored)}
        rows += [
            {**keys, "metric": name, "value": score.value, "low": score.low, "high": score.high}
            for name, score in scores.items()
            if name in METRICS
        ]
    return {"control_choices": rows}

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
    for one in flows:
        options = as_columns(one.plan["settings"]).get("options")
        groups.setdefault((one.name, options, *conditions_of(one).items()), []).append(one)
    rows: Rows = []
    for runs in groups.values():
        halves = [FlowSample.of(one.content).halves() for one in runs]
        number = choose([choosing for choosing, _ in halves], tolerance)
        run, (_, scored) = runs[number], halves[number]
        # all are resampled alike
        generator = random_streams.stream(root_seed, "control choice", case)
        found = flow_intervals(score_flows(scored, resamples, generator), scored, confidence)
        keys = {**keys_of(run, noise), "candidates": len(runs), "scored_flows": len(scored)}
        rows += [
            {**keys, "metric": name, "value": one.value, "low": one.low, "high": one.high}
            for name, one in found.items()
            if name in METRICS
        ]
    return {"control_choices": rows}

"""Counts over flows with and without control, for every strategy."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.scores import COUNT_SCORES
from burstcast.control.simulation import ControlSimulation
from burstcast.events import upward_crossings
from burstcast.laminarisation import is_laminar
from burstcast.statistics.densities import histogram


@dataclass(frozen=True, kw_only=True)
class FlowCounts:
    """Counts over flows with and without control, over the same steps from the same states.

    An event is an upward crossing of the threshold. Events are counted from the first forecast of
    each flow to its last step, steps and histograms over the steps that count (`Clock`). The
    following always hold; ``given`` is the number of flows that were given:

    * given = flows + left_out + laminarised
    * steps = flows * steps per flow, with control and without
    * exceeding steps <= steps, actuated_integration_steps <= integration_steps

    Attributes
    ----------
    flows
        Flows that count.
    left_out
        Flows with an event before anything could be done about it.
    laminarised
        Flows that exceed the laminarisation threshold, with control or without it: they count in
        neither sample. Of them, ``laminarised_controlled`` do so with control and
        ``laminarised_uncontrolled`` without (some may do both).
    events_uncontrolled, events_controlled
        All events without and with control.
    steps
        Steps that count, in each of the two samples.
    steps_free
        Counted steps of the controlled flow without actuation.
    exceeding_uncontrolled, exceeding_controlled, exceeding_free
        Steps at or above the threshold: without control, with control, and with control but outside
        actuation.
    integration_steps, actuated_integration_steps
        Integration steps that count, and steps of the controlled flows under actuation.
    edges
        Edges of the histograms' bins, ``(bins + 1,)``.
    histogram_uncontrolled, histogram_controlled, histogram_free
        Steps of each flow that counts in each bin, ``(flows, bins)``, in the same three samples.
        Values outside the edges are in no bin.
    row
        Row of each of these flows among the given flows, ``(flows,)``.
    """

    flows: int
    left_out: int
    laminarised: int
    laminarised_controlled: int
    laminarised_uncontrolled: int
    events_uncontrolled: int
    events_controlled: int
    steps: int
    steps_free: int
    exceeding_uncontrolled: int
    exceeding_controlled: int
    exceeding_free: int
    integration_steps: int
    actuated_integration_steps: int
    edges: FloatArray
    histogram_uncontrolled: IntArray
    histogram_controlled: IntArray
    histogram_free: IntArray
    row: IntArray

    @property
    def exceedance_uncontrolled(self) -> float:
        """Probability that the observable is at or above the threshold, without control."""
        return share(self.exceeding_uncontrolled, self.steps)

    @property
    def exceedance_controlled(self) -> float:
        """Exceedance with control, including time under actuation."""
        return share(self.exceeding_controlled, self.steps)

    @property
    def exceedance_free(self) -> float:
        """Exceedance with control, excluding time under actuation."""
        return share(self.exceeding_free, self.steps_free)

    @property
    def reduction(self) -> float:
        """Share of the exceedance that control removes; NaN without any exceedance."""
        return 1.0 - share(self.exceeding_controlled, self.exceeding_uncontrolled)

    @property
    def control_fraction(self) -> float:
        """Share of the time that counts under actuation."""
        return share(self.actuated_integration_steps, self.integration_steps)

    def record(self) -> dict[str, int | float | None]:
        """All counts and scores by their names; None for a score that is not defined."""
        counts = {name: value for name, value in vars(self).items() if isinstance(value, int)}
        scores = {name: getattr(self, name) for name in COUNT_SCORES}
        return {
            **counts,
            **{name: value if math.isfinite(value) else None for name, value in scores.items()},
        }


@dataclass(frozen=True)
class Laminarisation:
    """Whether flows exceed the laminarisation threshold, ``(flows,)`` each.

    Attributes
    ----------
    controlled, uncontrolled
        With control, and without it.
    """

    controlled: BoolArray
    uncontrolled: BoolArray

    @property
    def neither(self) -> BoolArray:
        """Flows that count: that do so neither with control nor without it."""
        return ~(self.controlled | self.uncontrolled)


def laminarisation(flows: ControlSimulation[Any, Any], threshold: float | None) -> Laminarisation:
    """Mark flows that exceed the laminarisation threshold; None: no flow does."""
    return Laminarisation(
        controlled=is_laminar(flows.controlled.max(axis=1), threshold),
        uncontrolled=is_laminar(flows.uncontrolled.max(axis=1), threshold),
    )


def controlled_events(flows: ControlSimulation[Any, Any], counts: BoolArray) -> BoolArray:
    """Events of the controlled flows that count, from the first forecast on, ``(flows, steps)``."""
    upward = upward_crossings(flows.controlled, flows.threshold) & counts[:, np.newaxis]
    upward[:, : flows.timing.first_forecast + 1] = False
    return upward


def count_flows(
    flows: ControlSimulation[Any, Any], laminarisation_threshold: float | None, edges: FloatArray
) -> dict[str, Any]:
    """Fields of `FlowCounts`.

    Parameters
    ----------
    flows
        The flows.
    laminarisation_threshold
        A flow whose observable exceeds it, with or without control, counts in neither sample; None:
        all flows count.
    edges
        Edges of the histograms' bins, increasing, ``(bins + 1,)``.
    """
    laminar = laminarisation(flows, laminarisation_threshold)
    counts, timing = laminar.neither, flows.timing
    span = slice(timing.counted_from + 1, timing.counted_until + 1)
    uncontrolled = flows.uncontrolled[counts, span]
    controlled = flows.controlled[counts, span]
    actuated = flows.actuated[counts, span]
    free = controlled[~actuated]
    upward_uncontrolled = upward_crossings(flows.uncontrolled, flows.threshold)[counts]
    return {
        "flows": int(counts.sum()),
        "left_out": flows.left_out,
        "laminarised": int((~counts).sum()),
        "laminarised_controlled": int(laminar.controlled.sum()),
        "laminarised_uncontrolled": int(laminar.uncontrolled.sum()),
        "events_uncontrolled": int(upward_uncontrolled[:, timing.first_forecast + 1 :].sum()),
        "events_controlled": int(controlled_events(flows, counts).sum()),
        "steps": controlled.size,
        "steps_free": free.size,
        "exceeding_uncontrolled": int((uncontrolled >= flows.threshold).sum()),
        "exceeding_controlled": int((controlled >= flows.threshold).sum()),
        "exceeding_free": int((free >= flows.threshold).sum()),
        "integration_steps": controlled.size * timing.sampling_stride,
        "actuated_integration_steps": int(flows.actuated_integration_steps[counts].sum()),
        "edges": edges,
        "histogram_uncontrolled": _histograms(uncontrolled, edges),
        "histogram_controlled": _histograms(controlled, edges),
        "histogram_free": _histograms(
            [flow[~under] for flow, under in zip(controlled, actuated, strict=True)], edges
        ),
        "row": flows.rows[counts],
    }


def _histograms(flows: Iterable[FloatArray], edges: FloatArray) -> IntArray:
    """Steps of each flow in each bin, ``(flows, bins)``."""
    found = [histogram(flow, edges).counts for flow in flows]
    return np.array(found, dtype=np.int64).reshape(-1, len(edges) - 1)


def share(numerator: int, denominator: int) -> float:
    """Quotient of two counts; NaN where there is nothing to divide by."""
    return numerator / denominator if denominator else float("nan")

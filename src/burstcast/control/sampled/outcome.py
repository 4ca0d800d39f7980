"""Outcome of decisions at equal intervals, and scores of the decisions."""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, FloatArray
from burstcast.control.counts import FlowCounts, count_flows, laminarisation, share
from burstcast.control.sampled.simulation import SampledSimulation


@dataclass(frozen=True, kw_only=True)
class DecisionOutcome(FlowCounts):
    """Counts of control by decisions: common counts of all strategies, and counts of decisions.

    A decision is right if the actuation is on and the free flow from the present state would be at
    or above the event threshold within the horizon, or off and it would not. Decisions are counted
    apart by their washout: ``free`` ones saw the free flow alone, ``actuated`` ones some steps
    under actuation, too, unlike anything in the training data. Without a horizon all but
    ``decisions`` and ``alarms`` are zero. Otherwise the eight kinds add up to ``decisions``.

    Attributes
    ----------
    decisions, alarms
        All decisions, and those to act.
    free_true_alarms, actuated_true_alarms
        Acts, and there would be an event.
    free_false_alarms, actuated_false_alarms
        Acts, and there would be none.
    free_missed, actuated_missed
        Does not act, and there would be an event.
    free_quiet, actuated_quiet
        Does not act, and there would be none.
    """

    decisions: int
    alarms: int
    free_true_alarms: int
    free_false_alarms: int
    free_missed: int
    free_quiet: int
    actuated_true_alarms: int
    actuated_false_alarms: int
    actuated_missed: int
    actuated_quiet: int

    @property
    def alarm_rate(self) -> float:
        """Share of the decisions that switch the actuation on."""
        return share(self.alarms, self.decisions)


def count_decisions(
    flows: SampledSimulation, laminarisation_threshold: float | None, edges: FloatArray
) -> DecisionOutcome:
    """Count outcomes over flows (parameters: `burstcast.control.counts.count_flows`)."""
    counts = laminarisation(flows, laminarisation_threshold).neither
    on = flows.decisions.on[counts]
    actuated = flows.decisions.washout_actuated[counts]
    ahead = flows.decisions.event_ahead
    event = np.zeros_like(on) if ahead is None else ahead[counts]

    def among(mask: BoolArray) -> int:
        return 0 if ahead is None else int(mask.sum())

    return DecisionOutcome(
        **count_flows(flows, laminarisation_threshold, edges),
        decisions=on.size,
        alarms=int(on.sum()),
        free_true_alarms=among(~actuated & on & event),
        free_false_alarms=among(~actuated & on & ~event),
        free_missed=among(~actuated & ~on & event),
        free_quiet=among(~actuated & ~on & ~event),
        actuated_true_alarms=among(actuated & on & event),
        actuated_false_alarms=among(actuated & on & ~event),
        actuated_missed=among(actuated & ~on & event),
        actuated_quiet=among(actuated & ~on & ~event),
    )

"""Strategies that decide at equal intervals: what they share beside the monitor."""

from dataclasses import dataclass

from burstcast.arrays import FloatArray
from burstcast.control.decision_outcome import DecisionOutcome, count_decisions
from burstcast.control.decisions import DecidedFlows, run_decided_flows
from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.timing import DecisionTiming


@dataclass(frozen=True)
class DecidingStrategy(ControlStrategy):
    """Switches the actuation on or off at equal intervals.

    Attributes
    ----------
    decision_interval_lt
        From one decision to the next, in Lyapunov times; one step at least.
    """

    decision_interval_lt: float

    def timing(self, schedule: Schedule) -> DecisionTiming:
        """Decisions at equal intervals (see `ControlStrategy.timing`)."""
        return DecisionTiming(
            interval_lt=self.decision_interval_lt, delay_lt=schedule.delay_lt, **schedule.clock
        )

    def horizon(self, timing: DecisionTiming) -> int:
        """Steps that a decision looks ahead; 0 if it does not."""
        return 0

    def follow(
        self,
        experiment: ControlExperiment,
        monitor: Monitor,
        *,
        noise: FloatArray | None,
        keep_states: bool = False,
    ) -> DecidedFlows:
        """Follow the flows with and without control (see `ControlStrategy.follow`)."""
        timing = self.timing(experiment.schedule)
        return run_decided_flows(
            experiment.system,
            experiment.washouts,
            monitor,
            experiment.actuated_system,
            timing,
            experiment.threshold,
            noise=noise,
            quiet_starts=experiment.quiet_starts,
            horizon=self.horizon(timing),
            keep_states=keep_states,
        )

    def outcome(
        self, flows: DecidedFlows, laminarisation_threshold: float | None, edges: FloatArray
    ) -> DecisionOutcome:
        """Count what happened, and how good decisions were (see `ControlStrategy.outcome`)."""
        return count_decisions(flows, laminarisation_threshold, edges)

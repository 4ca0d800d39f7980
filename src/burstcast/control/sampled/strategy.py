"""Strategies that decide at equal intervals: what they share beside the monitor."""

from dataclasses import dataclass

from burstcast.arrays import FloatArray
from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.sampled.outcome import DecisionOutcome, count_decisions
from burstcast.control.sampled.simulation import SampledSimulation, SampledStepper
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.timing import DecisionTiming


@dataclass(frozen=True)
class SampledStrategy(ControlStrategy):
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

    def stepper(self, experiment: ControlExperiment, monitor: Monitor) -> SampledStepper:
        """How flows go on under decisions at equal intervals (see `ControlStrategy.stepper`)."""
        timing = self.timing(experiment.schedule)
        return SampledStepper(
            experiment.system,
            experiment.actuated_system,
            monitor,
            timing,
            experiment.threshold,
            self.horizon(timing),
        )

    def outcome(
        self, flows: SampledSimulation, laminarisation_threshold: float | None, edges: FloatArray
    ) -> DecisionOutcome:
        """Count what happened, and how good decisions were (see `ControlStrategy.outcome`)."""
        return count_decisions(flows, laminarisation_threshold, edges)

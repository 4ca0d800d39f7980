"""Base class of strategies that decide at equal intervals."""

from collections.abc import Sequence
from dataclasses import dataclass

from burstcast.arrays import FloatArray
from burstcast.control.actuation import ActuationValues
from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.sampled.outcome import DecisionOutcome, count_decisions
from burstcast.control.sampled.simulation import SampledSimulation, SampledStepper
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.timing import DecisionTiming
from burstcast.forecasters.base import Forecaster


@dataclass(frozen=True)
class SampledStrategy(ControlStrategy):
    """Switches the actuation on or off at equal intervals.

    Attributes
    ----------
    decision_interval_lt
        Time from one decision to the next, in Lyapunov times; one step at least.
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

    def hold(self, timing: DecisionTiming) -> int:
        """Steps of the actuation that an alarm sets off: until the next decision takes effect."""
        return timing.interval

    def stepper(self, experiment: ControlExperiment, monitor: Monitor) -> SampledStepper:
        """Advance flows under decisions at equal intervals (see `ControlStrategy.stepper`)."""
        timing = self.timing(experiment.schedule)
        return SampledStepper(
            experiment.system,
            experiment.actuated_system,
            monitor,
            timing,
            experiment.threshold,
            self.horizon(timing),
            self.told,
            self.hold(timing),
            reversed_system=experiment.reversed_system,
            sensor=experiment.sensor,
        )

    def outcome(
        self, flows: SampledSimulation, laminarisation_threshold: float | None, edges: FloatArray
    ) -> DecisionOutcome:
        """Count outcomes and score decisions (see `ControlStrategy.outcome`)."""
        return count_decisions(flows, laminarisation_threshold, edges)


def check_horizon(horizon: int, timing: DecisionTiming, horizon_lt: float, told: bool) -> None:
    """Check that forecasts look beyond a decision's effect.

    Parameters
    ----------
    horizon
        Steps that a decision looks ahead.
    timing
        Timing of the decisions.
    horizon_lt
        The horizon as it was set, for messages.
    told
        Whether only what comes after the delay counts.

    Raises
    ------
    ValueError
        If they do not.
    """
    if horizon < 1:
        raise ValueError(f"a horizon of {horizon_lt} Lyapunov times lasts no step")
    if told and horizon <= timing.delay:
        raise ValueError(
            f"a horizon of {horizon_lt} Lyapunov times does not reach beyond the delay of "
            f"{timing.delay_lt}: nothing that a decision can change is forecast"
        )


def values_to_tell(
    experiment: ControlExperiment, forecasters: Sequence[Forecaster]
) -> ActuationValues:
    """Values of the parameters that forecasters receive.

    Raises
    ------
    ValueError
        If the experiment has none, or a forecaster does not use them.
    """
    if experiment.values is None:
        raise ValueError("the actuation of this case has no parameter for forecasters")
    for forecaster in forecasters:
        if not forecaster.aware:
            raise ValueError(
                f"{type(forecaster).__name__} does not know the parameters: the strategy needs a "
                f"forecaster that does"
            )
    return experiment.values

"""The interface of a control strategy: a policy with its timing and settings.

A strategy is one module of this package with one concrete subclass of `ControlStrategy`, a frozen
dataclass whose fields are its settings: numbers, ``bool``, ``str`` or ``tuple[float, ...]``. It is
found by the module's name; nothing has to be registered. One that decides at equal intervals
subclasses `SampledStrategy`, and needs a policy alone.
"""

import abc
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.control.actuation import ActuationValues
from burstcast.control.experiment import ControlExperiment
from burstcast.control.loop import ControlledFlows, Looks, RunningFlows, simulate
from burstcast.control.policy import REACTIVE, Policy, check_fallback
from burstcast.control.timing import Schedule, Timing
from burstcast.systems.state_space import StateSpace


class ControlStrategy(abc.ABC):
    """Control strategy, independent of the forecaster."""

    #: whether it asks forecasters: some strategies do without
    forecasts = False
    #: whether its forecasters are classifiers, which give probabilities and no trajectories
    by_probability = False

    @property
    def informed(self) -> bool:
        """Whether its forecasters are given the past actuation and the one on its way."""
        return False

    @abc.abstractmethod
    def timing(self, schedule: Schedule) -> Timing:
        """Its looks, and the effect of an alarm; ValueError if a setting does not fit."""

    @abc.abstractmethod
    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        """Policy that decides at each look; ValueError if a setting does not fit.

        ``experiment``: What is controlled. ``forecaster``: A forecaster of trajectories, or an
        `EventClassifier` for strategies `by_probability`; None where the strategy does not
        forecast. Of a committee each member is asked by a policy of its own.
        """

    def check(self, schedule: Schedule) -> None:
        """Check all that can be checked before there are flows: raise ValueError otherwise."""
        self.timing(schedule)

    def check_system(self, system: StateSpace, reversible: bool) -> None:  # noqa: B027
        """Check the requirements on the flow: raise ValueError if a setting does not fit.

        ``reversible``: Whether the actuation can be reversed, since it is a force.
        """

    def judge(self, flows: RunningFlows, looks: Looks) -> Mapping[str, BoolArray]:
        """What is to be known of each look beside its alarm (`burstcast.control.loop.Judge`)."""
        return {}

    def categories(self, flows: ControlledFlows) -> Any:
        """Counts of its own in each flow, a dataclass of described arrays; None for none."""
        return None

    def simulate(
        self,
        experiment: ControlExperiment,
        policy: Policy,
        *,
        noise: FloatArray | None,
        keep_states: bool = False,
        costs: bool = False,
    ) -> ControlledFlows:
        """Simulate the flows with and without control (see `burstcast.control.loop.simulate`).

        ``policy``: Its own, or another that stands in for it.
        """
        return simulate(
            experiment,
            self.timing(experiment.schedule),
            policy,
            judge=self.judge,
            noise=noise,
            keep_states=keep_states,
            costs=costs,
        )


@dataclass(frozen=True)
class SampledStrategy(ControlStrategy):
    """Decides at equal intervals: the actuation is on until the next decision takes effect."""

    #: time from one decision to the next, in Lyapunov times; one step at least
    decision_interval_lt: float

    def hold(self, schedule: Schedule) -> int:
        """Steps of the actuation that an alarm sets off. No later decision ends it earlier."""
        return schedule.steps(self.decision_interval_lt)

    def timing(self, schedule: Schedule) -> Timing:
        """Decisions at equal intervals, each of which takes effect a delay later."""
        interval, delay = (
            schedule.steps(time) for time in (self.decision_interval_lt, schedule.delay_lt)
        )
        if interval < 1:
            raise ValueError("the interval between two decisions must last a step")
        first, stop = delay, delay + self.hold(schedule)
        effect = first * schedule.sampling_stride, stop * schedule.sampling_stride
        return Timing(schedule, (interval, interval), effect, settling=delay)


@dataclass(frozen=True)
class ForesightedStrategy(SampledStrategy):
    """Decides at equal intervals by forecasts up to a horizon."""

    forecasts = True

    #: how far forecasts look ahead, in Lyapunov times from the decision; one step at least
    horizon_lt: float
    #: by how much less than the event threshold counts as an event in a forecast, in units of the
    #: observable; a negative one asks for more
    margin: float = 0.0
    #: share of several forecasters that must act: the alarm probability at which a committee
    #: does
    vote_share: float = 0.5
    #: what decides where a forecast is invalid: "reactive", "off" or "on"
    #: (`burstcast.control.policy.Fallback`)
    fallback: str = REACTIVE

    def horizon(self, schedule: Schedule) -> int:
        """Steps that a decision looks ahead."""
        return schedule.steps(self.horizon_lt)

    def level(self, experiment: ControlExperiment) -> float:
        """Level of the observable at which a forecast holds an event."""
        return experiment.threshold - self.margin

    def check(self, schedule: Schedule) -> None:
        """Check the fallback, and that forecasts look beyond a decision's effect."""
        self.timing(schedule)
        check_fallback(self.fallback)
        horizon = self.horizon(schedule)
        if horizon < 1:
            raise ValueError(f"a horizon of {self.horizon_lt} Lyapunov times lasts no step")
        if self.informed and horizon <= schedule.steps(schedule.delay_lt):
            raise ValueError(
                f"a horizon of {self.horizon_lt} Lyapunov times does not reach beyond the delay of "
                f"{schedule.delay_lt}: nothing that a decision can change is forecast"
            )

    def values(self, experiment: ControlExperiment, forecaster: Any) -> ActuationValues:
        """Values of the parameters that a forecaster is given, which must know them."""
        if experiment.values is None:
            raise ValueError("the actuation of this case has no parameter for forecasters")
        if not forecaster.aware:
            raise ValueError(
                f"{type(forecaster).__name__} does not know the parameters: the strategy needs a "
                f"forecaster that does"
            )
        return experiment.values

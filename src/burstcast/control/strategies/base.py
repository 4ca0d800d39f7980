"""The interface of a control strategy: times of decisions, monitor and actuation.

A strategy is one module of this package with one concrete subclass of `ControlStrategy`, a frozen
dataclass whose fields are its settings: numbers, ``bool``, ``str`` or ``tuple[float, ...]``. It is
found by the module's name; nothing has to be registered.
"""

import abc
from collections.abc import Sequence
from typing import Any, ClassVar

from burstcast.arrays import FloatArray
from burstcast.control.counts import FlowCounts
from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.simulation import ControlSimulation, Stepper, simulate
from burstcast.control.timing import Clock
from burstcast.forecasters.base import Forecaster
from burstcast.systems.state_space import StateSpace


class ControlStrategy(abc.ABC):
    """Control strategy, independent of the forecaster."""

    forecasts: ClassVar[bool]
    """Whether it asks forecasters: some strategies do without."""
    by_probability: ClassVar[bool] = False
    """Whether its forecasters are classifiers, which give probabilities and no trajectories."""

    @property
    def told(self) -> bool:
        """Whether the monitor receives the past actuation and the one on its way."""
        return False

    @abc.abstractmethod
    def timing(self, schedule: Schedule) -> Clock:
        """When it looks, and which steps count.

        Raises
        ------
        ValueError
            If a setting does not fit.
        """

    def check(self, schedule: Schedule) -> None:
        """Check all that can be checked before there are flows.

        Raises
        ------
        ValueError
            If a setting does not fit.
        """
        self.timing(schedule)

    def check_system(self, system: StateSpace, reversible: bool) -> None:  # noqa: B027
        """Check the requirements on the flow.

        Parameters
        ----------
        system
            What states are.
        reversible
            Whether the actuation can be reversed: it is a force.

        Raises
        ------
        ValueError
            If a setting does not fit.
        """

    @abc.abstractmethod
    def monitor(self, experiment: ControlExperiment, forecasters: Sequence[Forecaster]) -> Monitor:
        """Monitor that raises alarms.

        Parameters
        ----------
        experiment
            What is controlled.
        forecasters
            One, or the members of a committee; none where the strategy does not forecast.

        Raises
        ------
        ValueError
            If a setting does not fit.
        """

    @abc.abstractmethod
    def stepper(self, experiment: ControlExperiment, monitor: Monitor) -> Stepper[Any, Any]:
        """Advance flows: times of decisions, and actuation after alarms.

        Parameters
        ----------
        experiment
            What is controlled.
        monitor
            Raises the alarms: `monitor`, or another that stands in for it.
        """

    def simulate(
        self,
        experiment: ControlExperiment,
        monitor: Monitor,
        *,
        noise: FloatArray | None,
        keep_states: bool = False,
    ) -> ControlSimulation[Any, Any]:
        """Simulate the flows with and without control.

        Parameters
        ----------
        experiment
            What is controlled.
        monitor
            As in `stepper`.
        noise, keep_states
            As in `burstcast.control.simulation.simulate`.
        """
        return simulate(
            self.stepper(experiment, monitor),
            experiment.washouts,
            noise=noise,
            quiet_starts=experiment.quiet_starts,
            keep_states=keep_states,
        )

    @abc.abstractmethod
    def outcome(
        self, flows: Any, laminarisation_threshold: float | None, edges: FloatArray
    ) -> FlowCounts:
        """Count outcomes of flows under this strategy.

        Parameters
        ----------
        flows
            Flows of `simulate`.
        laminarisation_threshold, edges
            As in `burstcast.control.counts.count_flows`.
        """

"""Case of a job: sampling, the unit of time, the system, the density of its observable."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.base import durations
from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.series_lengths import numbers_of
from burstcast.control.actuation import ActuatorShare
from burstcast.statistics.densities import bin_edges, edges_over
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import SHARE, Parameters, SystemParameters
from burstcast.systems.registry import make_space, make_system
from burstcast.systems.state_space import MEASURED, StateSpace
from burstcast_workflow.harness.settings import JobSettings, at, computed


class Sampling(JobSettings):
    """Steps of a forecast."""

    time_step: float = at("case.ensemble.time_step")
    stride: int = at("case.ensemble.sampling_stride")

    @property
    def interval(self) -> float:
        """Time between two steps of a forecast, in time units."""
        return float(self.time_step * self.stride)


class Clock(JobSettings):
    """The Lyapunov time in which durations are given, and steps of a forecast."""

    sampling_interval: float = computed("time_unit.sampling_interval")
    lyapunov_time: int = computed("time_unit.steps_per_lyapunov_time")

    def steps(self, duration: float) -> int:
        """Whole steps in a duration in Lyapunov times."""
        return durations.steps(duration, self.lyapunov_time)

    def positive_steps(self, duration: float, field: object) -> int:
        """Steps, at least one, in a duration, which is that of a field such as `Washout.lt`."""
        return durations.positive_steps(duration, self.lyapunov_time, str(field))


class Washout(JobSettings):
    """What forecasters are given before they forecast."""

    clock: Clock
    lt: float = at("washout_lt")

    @property
    def steps(self) -> int:
        """Steps of a washout."""
        return self.clock.positive_steps(self.lt, Washout.lt)


class System(JobSettings):
    """System of the job's case."""

    name: str = at("case.system")
    parameters: dict[str, Any] = at("case.parameters")

    @property
    def space(self) -> StateSpace:
        """States for forecasts and scores: of a dynamical system, or of measured series."""
        return make_space(self.name, self.parameters)

    @property
    def equations(self) -> DynamicalSystem:
        """Dynamical system; a `ValueError` if the case was measured and has no equations."""
        return make_system(self.name, self.parameters)

    def forecaster_parameters(
        self, names: Sequence[str], actuation: Mapping[str, Any] | None = None
    ) -> Parameters:
        """Parameters that forecasters know, by name; of a record, columns without values."""
        if self.name == MEASURED:
            return Parameters(tuple(names), ())
        if list(names) == [SHARE]:
            if actuation is None:
                return Parameters((SHARE,), (0.0,))
            return ActuatorShare.of(self.equations, actuation["parameters"], actuation["force"])
        return SystemParameters.of(self.equations, names)


class CaseData(JobSettings):
    """How the data of a case are made."""

    system: System
    time_step: float = at("case.ensemble.time_step")
    duration: float = at("case.ensemble.duration")
    training_series: int = at("case.training.series")
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")


class Density(JobSettings):
    """Density of the observable."""

    density: dict[str, Any] = at("case.density")

    def edges(self, ensemble: str) -> FloatArray:
        """Edges of its bins: over all the data where no range is said."""
        bins = self.density["bins"]
        if self.density["range"] is not None:
            low, high = self.density["range"]
            return bin_edges(low, high, bins)
        return edges_over(numbers_of(read_netcdf(ensemble, "observable")["observable"]), bins)

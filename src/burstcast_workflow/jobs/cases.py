"""Case of a job: sampling, the unit of time, the system, the data.

The unit of time is from the config, or from the exponent that a job computed.
"""

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
from burstcast_workflow.harness.settings import JobSettings, at, concerning


class Sampling(JobSettings):
    """Steps of a forecast."""

    time_step: float = at("case.ensemble.time_step")
    sampling_stride: int = at("case.ensemble.sampling_stride")

    @property
    def sampling_interval(self) -> float:
        """Time between two steps of a forecast, in time units."""
        return float(self.time_step * self.sampling_stride)


class Clock(Sampling):
    """Steps of a forecast, and the Lyapunov time in which durations are given."""

    time_unit: str = at("case.lyapunov.time_unit")
    given_exponent: float | None = at("case.lyapunov.given_exponent")

    @property
    def lyapunov_time(self) -> int:
        """Network steps in a Lyapunov time."""
        interval = self.sampling_interval
        exponent = durations.known_exponent(self.time_unit, self.given_exponent)
        if exponent is not None:
            return durations.steps_per_lyapunov_time(exponent, interval)
        assert self.computed_exponent is not None
        fields = f"{Clock.given_exponent}, {Clock.time_unit}"
        with concerning(f"the computed exponent ({fields})"):
            return durations.steps_per_lyapunov_time(self.computed_exponent, interval)

    def steps(self, duration: float) -> int:
        """Whole steps in a duration in Lyapunov times."""
        return durations.steps(duration, self.lyapunov_time)

    def positive_steps(self, field: Any) -> int:
        """Steps, at least one, in the duration of a field, such as ``Washed.washout_lt``."""
        duration = field.__get__(self, type(self))
        return durations.positive_steps(duration, self.lyapunov_time, str(field))


class Washed(Clock):
    """What forecasters are given before they forecast."""

    washout_lt: float = at("washout_lt")

    @property
    def washout(self) -> int:
        """Steps of a washout."""
        return self.positive_steps(Washed.washout_lt)


class System(JobSettings):
    """System of the job's case."""

    system: str = at("case.system")
    parameters: dict[str, Any] = at("case.parameters")

    @property
    def space(self) -> StateSpace:
        """States for forecasts and scores: of a dynamical system, or of measured series."""
        return make_space(self.system, self.parameters)

    @property
    def equations(self) -> DynamicalSystem:
        """Dynamical system; a `ValueError` if the case was measured and has no equations."""
        return make_system(self.system, self.parameters)

    def forecaster_parameters(
        self, names: Sequence[str], actuation: Mapping[str, Any] | None = None
    ) -> Parameters:
        """Parameters that forecasters know, by name; of a record, columns without values."""
        if self.system == MEASURED:
            return Parameters(tuple(names), ())
        if list(names) == [SHARE]:
            if actuation is None:
                return Parameters((SHARE,), (0.0,))
            return ActuatorShare.of(self.equations, actuation["parameters"], actuation["force"])
        return SystemParameters.of(self.equations, names)


class CaseData(System):
    """How the data of a case are made."""

    time_step: float = at("case.ensemble.time_step")
    duration: float = at("case.ensemble.duration")
    training_series: int = at("case.training.series")
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")
    event_threshold: float = at("case.event_threshold")


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

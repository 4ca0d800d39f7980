"""The unit of time of a case, from the config or from the exponent that a job computed."""

from typing import Any

from burstcast.base import durations
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

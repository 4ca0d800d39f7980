"""Observations that come one at a time, as a forecaster's washout takes them."""

import numbers
import warnings
from collections.abc import Mapping
from typing import Any, Self

import numpy as np

from burstcast.base.arrays import FloatArray, float_array

_TOLERANCE = 0.1
"""Of the time between two observations, relative to the sampling interval: clocks jitter."""


class ObservationStream:
    """The latest observations of one series: ``length`` of them, an ``interval`` apart."""

    def __init__(self, components: int, length: int, interval: float) -> None:
        self.components, self.length, self.interval = components, length, interval
        self.latest: list[FloatArray] = []
        self.time: float | None = None  # of the latest observation

    def append(self, observation: Any, time: float | None = None) -> None:
        """Take the next observation (`burstcast.EventForecaster.update`)."""
        values = float_array(observation, "the observation")
        if values.shape != (self.components,):
            shape = f"({self.components},), as the components of the training series"
            raise ValueError(f"an observation has the shape {shape}; this one has {values.shape}")
        self._advance(time)
        if np.isfinite(values).all():
            self.latest.append(values.copy())
            del self.latest[: -self.length]
        else:
            self._reset("an observation is not finite")

    @property
    def complete(self) -> bool:
        """Whether there are enough observations for a forecast."""
        return len(self.latest) == self.length

    @property
    def washout(self) -> FloatArray:
        """The latest observations as a single series, ``(1, washout, component)``."""
        return np.stack(self.latest)[np.newaxis]

    def record(self) -> dict[str, Any]:
        """Observations and time as JSON has them, all digits kept."""
        return {"latest": [observation.tolist() for observation in self.latest], "time": self.time}

    def restored(self, record: Mapping[str, Any]) -> Self:
        """Take over the observations of a `record`; returns this stream."""
        for observation in record["latest"]:
            self.append(observation)
        self.time = None if record["time"] is None else float(record["time"])
        return self

    def _advance(self, time: float | None) -> None:
        """Compare the time of an observation with the time of the last one."""
        if time is None:
            self.time = None if self.time is None else self.time + self.interval
            return
        if not isinstance(time, numbers.Real) or not np.isfinite(time):
            raise ValueError(
                "the time of an observation must be a finite number, in the unit of "
                f"sampling_interval, not {time!r}"
            )
        if self.time is not None:
            passed = (time - self.time) / self.interval
            if passed < 1.0 - _TOLERANCE:
                later = f"it is {time - self.time:g} later, and the sampling interval is"
                raise ValueError(
                    f"an observation at time {time!r} cannot follow one at time {self.time!r}: "
                    f"{later} {self.interval:g}"
                )
            if passed > 1.0 + _TOLERANCE:
                self._reset(f"no observation came between the times {self.time!r} and {time!r}")
        self.time = float(time)

    def _reset(self, reason: str) -> None:
        self.latest = []
        message = f"{reason}: the washout of {self.length} observations begins again"
        warnings.warn(message, stacklevel=4)

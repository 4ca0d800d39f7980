"""Observations that come one at a time, as a forecaster's washout takes them."""

import warnings
from collections import deque
from collections.abc import Mapping
from typing import Any, Self

import numpy as np

from burstcast.arrays import FloatArray, float_array

_TOLERANCE = 0.1
"""Of the time between two observations, relative to the sampling interval: clocks jitter."""


class ObservationStream:
    """The latest observations of one series, without a gap between them.

    Parameters
    ----------
    components
        Components of an observation.
    washout
        Observations that a forecast takes.
    sampling_interval
        Time between two observations.
    """

    def __init__(self, components: int, washout: int, sampling_interval: float) -> None:
        self._components, self._interval = components, sampling_interval
        self._latest: deque[FloatArray] = deque(maxlen=washout)
        self._time: float | None = None

    def append(self, observation: Any, time: float | None = None) -> None:
        """Take the next observation.

        A gap begins the washout again, and a warning says so: an observation that is not finite, or
        a time that is more than one sampling interval after the last one.

        Parameters
        ----------
        observation
            ``(component,)``.
        time
            When it was made, in the unit of the sampling interval; None: one sampling interval
            after the one before.

        Raises
        ------
        ValueError
            If it has other components than the training series, or the time is no finite number,
            goes back, or is between two samples.
        """
        values = float_array(observation, "the observation")
        if values.shape != (self._components,):
            raise ValueError(
                f"an observation has the shape ({self._components},), as the components of the "
                f"training series; this one has {values.shape}"
            )
        self._advance(time)
        if np.isfinite(values).all():
            self._latest.append(values.copy())
        else:
            self._reset("an observation is not finite")

    @property
    def waiting(self) -> int:
        """Observations that are still missing for a forecast."""
        assert self._latest.maxlen is not None
        return self._latest.maxlen - len(self._latest)

    @property
    def washout(self) -> FloatArray:
        """The latest observations as a single series, ``(1, washout, component)``."""
        return np.stack(self._latest)[np.newaxis]

    def record(self) -> dict[str, Any]:
        """Observations and time as JSON has them, all digits kept."""
        return {"latest": [one.tolist() for one in self._latest], "time": self._time}

    def restored(self, record: Mapping[str, Any]) -> Self:
        """Take over the observations of a `record`; returns this stream."""
        self._latest.extend(np.array(one, dtype=np.float64) for one in record["latest"])
        self._time = record["time"]
        return self

    def _advance(self, time: float | None) -> None:
        """Compare the time of an observation with the time of the last one."""
        if time is None:
            self._time = None if self._time is None else self._time + self._interval
            return
        if not np.isfinite(time):
            raise ValueError(f"the time of an observation must be a finite number, not {time}")
        if self._time is not None:
            passed = (time - self._time) / self._interval
            if passed < 1.0 - _TOLERANCE:
                raise ValueError(
                    f"an observation at time {time!r} cannot follow one at time {self._time!r}: it "
                    f"is {time - self._time:g} later, and the sampling interval is "
                    f"{self._interval:g}"
                )
            if passed > 1.0 + _TOLERANCE:
                self._reset(f"no observation came between the times {self._time!r} and {time!r}")
        self._time = float(time)

    def _reset(self, reason: str) -> None:
        self._latest.clear()
        warnings.warn(
            f"{reason}: the washout of {self._latest.maxlen} observations begins again",
            stacklevel=4,
        )

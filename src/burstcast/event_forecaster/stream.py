"""Observations that come one at a time, as a forecaster's washout takes them."""

import numbers
import warnings
from collections.abc import Mapping
from contextlib import suppress
from typing import Any, Self

import numpy as np

from burstcast.base.arrays import FloatArray, float_array

_TOLERANCE = 0.1
"""Of the time between two observations, relative to the sampling interval: clocks jitter."""


class ObservationStream:
    """The latest observations of one series: ``length`` of them, an ``interval`` apart.

    ``seconds``: The interval where times are dates; None: not known.
    """

    def __init__(
        self, components: int, length: int, interval: float, seconds: float | None = None
    ) -> None:
        self.components, self.length = components, length
        self.interval, self.seconds = interval, seconds
        self.latest: list[FloatArray] = []
        self.time: float | None = None  # of the latest observation
        self.kind = "number"  # or "date", in seconds, or "row"

    def append(self, observation: Any, time: Any = None, row: int | None = None) -> None:
        """Take the next observation (`burstcast.EventForecaster.update`).

        ``row``: Number of its row in a table without times.
        """
        values = float_array(observation, "the observation")
        if values.shape != (self.components,):
            shape = f"({self.components},), as the components of the training series"
            raise ValueError(f"an observation has the shape {shape}; this one has {values.shape}")
        self._advance(time, row)
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
        latest = [observation.tolist() for observation in self.latest]
        return {"latest": latest, "time": self.time, "kind": self.kind}

    def restored(self, record: Mapping[str, Any]) -> Self:
        """Take over the observations of a `record`; returns this stream."""
        for observation in record["latest"]:
            self.append(observation)
        self.time = None if record["time"] is None else float(record["time"])
        self.kind = str(record.get("kind", "number"))
        return self

    def _advance(self, time: Any, row: int | None) -> None:
        """Compare the time of an observation with the time of the last one."""
        if time is None and row is None:
            step = 1 if self.kind == "row" else self._interval(self.kind)
            self.time = None if self.time is None else self.time + step
            return
        now, kind = (float(row), "row") if row is not None else moment(time)
        interval = self._interval(kind)
        if self.time is not None and kind != self.kind:
            raise ValueError(
                f"the observation at {_written(now, kind)} follows one at "
                f"{_written(self.time, self.kind)}: give times of one kind"
            )
        if self.time is not None and kind == "row":
            # whole numbers may be times, too
            if now - self.time not in (1.0, interval):
                self._reset(f"row {row} does not follow row {self.time:g}")
        elif self.time is not None:
            passed = (now - self.time) / interval
            if passed < 1.0 - _TOLERANCE:
                later = f"it is {now - self.time:g} later, and the sampling interval is"
                raise ValueError(
                    f"an observation at time {_written(now, kind)} cannot follow one at time "
                    f"{_written(self.time, kind)}: {later} {interval:g}"
                )
            if passed > 1.0 + _TOLERANCE:
                between = f"{_written(self.time, kind)} and {_written(now, kind)}"
                self._reset(f"no observation came between the times {between}")
        self.time, self.kind = now, kind

    def _interval(self, kind: str) -> float:
        """Time between two observations, in seconds for dates."""
        if kind != "date":
            return self.interval
        if self.seconds is None:
            raise ValueError(
                "the time of an observation must be a finite number, in the unit of "
                "sampling_interval, since the training series had no dates: for dates, give "
                "sampling_interval with a unit, such as '10 minutes'"
            )
        return self.seconds

    def _reset(self, reason: str) -> None:
        self.latest = []
        message = f"{reason}: the washout of {self.length} observations begins again"
        warnings.warn(message, stacklevel=4)


def moment(time: Any) -> tuple[float, str]:
    """Time of an observation as a number, and its kind: "number", or "date", in seconds."""
    if isinstance(time, numbers.Real) and not isinstance(time, bool):
        if np.isfinite(float(time)):
            return float(time), "number"
    else:
        from burstcast.data.times import TimesError, is_number, times_in  # loads pandas

        with suppress(TimesError, TypeError):
            (seconds,) = times_in([time], "second")
            is_text = isinstance(time, str) and is_number(time)
            if np.isfinite(seconds):
                return float(seconds), "number" if is_text else "date"
    date = "" if isinstance(time, numbers.Real) else ", or a date"
    raise ValueError(
        f"the time of an observation must be a finite number, in the unit of sampling_interval"
        f"{date}, not {time!r}"
    )


def _written(time: float, kind: str) -> str:
    """A time as messages have it."""
    return str(np.datetime64(round(time * 1e6), "us")) if kind == "date" else repr(time)

"""Cycles of a known period in measured records: of the day, of the year."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.data.measured_data import Run
from burstcast.data.time_stamps import SECONDS, YEAR

CALENDAR = {"day": 1.0, "week": 7.0, "year": YEAR}
"""Cycles of the calendar, in days, whose waves are called day_cos, day_sin, and so on."""

_WAVE_OF_CALENDAR = re.compile(rf"\b(?:{'|'.join(CALENDAR)})_(?:cos|sin)\b")

PHASES = 4
"""Parts of the shortest wave of a cycle in which there must be training samples: with an empty one,
a wave is fitted to what is elsewhere."""


@dataclass(frozen=True)
class Cycle:
    """A cycle: a period with its first harmonics."""

    period: float  #: period in time units
    harmonics: int  #: number of waves: of the period, half the period, a third of it,

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the waves as components: cycle_cos, cycle_sin, cycle_cos_2, cycle_sin_2, ..."""
        return tuple(
            f"cycle_{wave}{f'_{number}' if number > 1 else ''}"
            for number in range(1, self.harmonics + 1)
            for wave in ("cos", "sin")
        )

    def waves(self, time: FloatArray) -> FloatArray:
        """Cosine and sine of each harmonic at some times, ``(time, 2 harmonics)``."""
        phase = 2 * np.pi * np.mod(time, self.period) / self.period
        angles = np.arange(1, self.harmonics + 1) * phase[:, np.newaxis]
        return np.stack([np.cos(angles), np.sin(angles)], axis=2).reshape(len(time), -1)

    def fit(self, time: FloatArray, values: FloatArray) -> FloatArray:
        """Mean and amplitudes of the waves by least squares, ``(1 + 2 harmonics, columns)``.

        ``time``: Times of the samples, ``(samples,)``. ``values``: ``(samples, columns)``.
        """
        parts = PHASES * self.harmonics
        part = np.minimum(np.floor(np.mod(time, self.period) / self.period * parts), parts - 1)
        filled = len(np.unique(part))
        if filled < parts:
            raise ValueError(
                f"data.cycle: the training series have samples in {filled} of {parts} equal parts "
                f"of the period, {self.period:g}: to fit {self.harmonics} harmonics, they must "
                f"have some in all of them (training.series, data.cycle.harmonics)"
            )
        return np.asarray(np.linalg.lstsq(self._terms(time), values, rcond=None)[0], np.float64)

    def values(self, time: FloatArray, fitted: FloatArray) -> FloatArray:
        """The fitted cycle, its mean included, at some times: ``(time, columns)``."""
        return np.asarray(self._terms(time) @ fitted)

    def _terms(self, time: FloatArray) -> FloatArray:
        return np.column_stack([np.ones(len(time)), self.waves(time)])


def with_waves(runs: Sequence[Run], cycle: Cycle, time: str) -> list[Run]:
    """Runs with the waves of a cycle as further columns."""
    return _with_columns(
        runs,
        lambda run: dict(zip(cycle.names, cycle.waves(run.columns[time]).T, strict=True)),
        "as a wave of data.cycle is called: rename it, or leave the waves out "
        "(data.cycle.components: false)",
    )


def calendar_names(texts: Sequence[str]) -> list[str]:
    """Waves of the calendar that columns or expressions name, each once.

    Examples
    --------
    >>> calendar_names(["rain", "twice_a_day = 2 * day_sin * day_cos", "day_cos"])
    ['day_sin', 'day_cos']
    """
    return list(dict.fromkeys(name for text in texts for name in _WAVE_OF_CALENDAR.findall(text)))


def with_calendar(runs: Sequence[Run], names: Sequence[str], time: str, unit: str) -> list[Run]:
    """Runs with waves of the calendar as further columns, of phase 0 at 1970-01-01T00:00 UTC.

    ``unit``: Their unit, one of `burstcast.data.time_stamps.SECONDS`.
    """

    def waves(run: Run) -> dict[str, FloatArray]:
        found = {}
        for name in names:
            cycle, _, wave = name.partition("_")
            whole = Cycle(CALENDAR[cycle] * SECONDS["day"] / SECONDS[unit], 1)
            found[name] = whole.waves(run.columns[time])[:, ("cos", "sin").index(wave)]
        return found

    return _with_columns(runs, waves, "as a wave of the calendar is called: rename it")


def _with_columns(
    runs: Sequence[Run], made: Callable[[Run], Mapping[str, FloatArray]], reason: str
) -> list[Run]:
    """Runs with further columns, which must not be there already."""
    found = []
    for run in runs:
        columns = made(run)
        if taken := [name for name in columns if name in run.columns]:
            raise ValueError(f"{run.name} has a column {taken[0]!r}, {reason}")
        found.append(replace(run, columns={**run.columns, **columns}))
    return found


def without_cycle(
    runs: Sequence[Run], cycle: Cycle, time: str, names: Sequence[str], training: Sequence[slice]
) -> list[Run]:
    """Runs with some columns as departures from their cycle, which training samples tell.

    ``names``: Columns that the cycle is removed from, its mean included. ``training``: Rows of a
    run that belong to training series, for each of the first runs.
    """
    of_training = list(zip(runs, training, strict=False))
    times = np.concatenate([run.columns[time][rows] for run, rows in of_training])
    values = np.concatenate(
        [np.stack([run.columns[name][rows] for name in names], axis=1) for run, rows in of_training]
    )
    fitted, found = cycle.fit(times, values), []
    for run in runs:
        usual = cycle.values(run.columns[time], fitted)
        rest = {name: run.columns[name] - usual[:, place] for place, name in enumerate(names)}
        found.append(replace(run, columns={**run.columns, **rest}))
    return found

"""The ensemble filter of a model that is driven by samples, such as a network.

Its members are states of the model, such as reservoirs. Each predicts the next sample, to which it
adds an error as large as the model's; the observation of this sample then moves the predictions,
and with them the states, as in `burstcast.forecasters._square_root_filter`; the corrected
predictions drive the states. With past samples among the rows that are corrected, it is a fixed-lag
smoother (Evensen & van Leeuwen, Monthly Weather Review 128, 2000). The errors are additive and
independent from step to step, and their variance follows the innovations (Desroziers et al.,
Quarterly Journal of the Royal Meteorological Society 131, 2005).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.forecasters._square_root_filter import combinations

_FIRST_ERROR = 0.2
"""Error of the model, in units of the noise, from which its estimate starts."""
LEAST_ERROR = 0.01
"""Least estimated error of the model, in units of the noise."""
_ADAPTATION = 0.02
"""Share of an innovation by which the variance of the model's error follows it."""


class DrivenModel(Protocol):
    """What the filter asks of a model: its states are driven by samples, and predict the next.

    States are ``(rows, batch, members)``, samples ``(dimension, batch, members)``.
    """

    @property
    def hidden(self) -> slice:
        """Rows of the states that are smoothed with the samples."""

    def begin(self, samples: FloatArray, number: FloatArray) -> FloatArray:
        """States before a first sample, with the numbers of their members."""

    def predict(self, states: FloatArray) -> FloatArray:
        """Next sample."""

    def drive(self, states: FloatArray, samples: FloatArray, number: FloatArray) -> FloatArray:
        """States after samples, with the numbers of their members."""


@dataclass(frozen=True)
class Followed:
    """Results of an ensemble filter along series.

    Attributes
    ----------
    states
        States of the members that have seen all observations, ``(rows, batch, members)``.
    smoothed
        Series as the smoother estimates them, ``(series, time, dimension + hidden)``, NaN where
        they have ended; without a lag, the filter's estimates.
    spread
        Standard deviation of the members of the smoother, root mean square, of each of these
        components.
    model_error
        Standard deviation of the additive error of the model, ``(dimension,)``.
    consistency
        Mean square of the innovations over the one that filter and noise expect, ``(dimension,)``.
    kept
        Mean states after the samples that were to be kept, by step, ``(rows, batch)``.
    """

    states: FloatArray
    smoothed: FloatArray
    spread: FloatArray
    model_error: FloatArray
    consistency: FloatArray
    kept: dict[int, FloatArray]


def opposite_pairs(random_seed: int, dimension: int, members: int) -> Iterator[FloatArray]:
    """Standard normal numbers ``(dimension, members)`` of each step, in pairs of opposite signs.

    They are the same for all points and series, so that no result depends on a batch.
    """
    generator = random_streams.stream(random_seed, "ensemble of a network", dimension, members)
    while True:
        half = generator.standard_normal((dimension, members // 2))
        yield np.concatenate([half, -half], axis=1)


def follow(
    model: DrivenModel,
    observed: FloatArray,
    noise: FloatArray,
    numbers: Iterator[FloatArray],
    model_error: FloatArray | None,
    *,
    start_up: int,
    lag: int = 0,
    lengths: IntArray | None = None,
    keep: Sequence[int] = (),
) -> Followed:
    """Follow series by an ensemble of a model's states.

    ``observed``: Series or washouts, ``(series, time, dimension)``, held after their ends.
    ``noise``: Standard deviation of its errors, ``(dimension,)``. ``numbers``: Random numbers of
    each step (`opposite_pairs`), with as many rows as samples have components, or more.
    ``model_error``: As in `Followed`; None: it is estimated. ``start_up``: Steps in which members
    follow the observations, with errors as large as the noise. ``lag``: Steps by which later
    observations correct a sample. ``lengths``: Samples of each series; None: all. ``keep``: Steps
    of `Followed.kept`.
    """
    batch, steps, dimension = observed.shape
    samples = np.ascontiguousarray(observed.transpose(1, 2, 0))
    ends = np.full(batch, steps) if lengths is None else lengths
    variance, adaptive = np.square(noise), model_error is None
    error = np.square(_FIRST_ERROR * noise if model_error is None else model_error)
    number = next(numbers)
    members = number.shape[1]
    drawn = noise[:, np.newaxis] * number[:dimension]
    current = samples[0][..., np.newaxis] + drawn[:, np.newaxis]
    states = model.begin(current, number)
    size = dimension + len(states[model.hidden])
    past = np.empty((lag, size, batch, members))
    smoothed, spread = np.full((steps, size, batch), np.nan), np.zeros(size)
    ratios, errors, counts = np.zeros(dimension), np.zeros(dimension), np.zeros(3)
    kept: dict[int, FloatArray] = {}

    def settle(step: int, estimate: FloatArray, some: BoolArray) -> None:
        """Note the final estimate of a sample, ``(dimension, batch, members)``, of some series."""
        smoothed[step][:, some] = estimate[:, some].mean(axis=2)
        spread[:] += estimate[:, some].var(axis=2, ddof=1).sum(axis=1)
        counts[0] += np.count_nonzero(some)

    for step, observation in enumerate(samples):
        running = ends > step
        if step:
            number = next(numbers)
        if 0 < step < start_up:
            drawn = noise[:, np.newaxis] * number[:dimension]
            current = observation[..., np.newaxis] + drawn[:, np.newaxis]
        elif step:
            drawn = np.sqrt(error)[:, np.newaxis] * number[:dimension]
            current = model.predict(states) + drawn[:, np.newaxis]
            weights = combinations(current, observation, noise)
            expected = current[:, running].var(axis=2, ddof=1).mean(axis=1) + variance
            off = observation - current.mean(axis=2)
            innovation = np.square(off[:, running]).mean(axis=1)
            if 4 * step >= steps:
                ratios += innovation / np.where(expected > 0, expected, 1.0)
                counts[1] += 1
            if adaptive:
                error = error + _ADAPTATION * (innovation - expected)
                error = np.maximum(error, LEAST_ERROR**2 * variance)
                if 2 * step >= steps:
                    errors += error
                    counts[2] += 1
            current, states = combined(current, weights), combined(states, weights)
            if lag:
                rows = combined(past.reshape(-1, batch, members), weights)
                past = rows.reshape(past.shape)
        whole = np.concatenate([current, states[model.hidden]])
        if lag == 0:
            settle(step, whole, running)
        else:
            if step >= lag:
                settle(step - lag, past[step % lag], running)
            past[step % lag] = whole
            ended = ends == step + 1
            if ended.any():
                for back in range(lag):
                    if step - back >= 0:
                        settle(step - back, past[(step - back) % lag], ended)
        states = model.drive(states, current, number)
        if step in keep:
            kept[step] = states.mean(axis=2)
    estimate = np.sqrt(errors / counts[2] if adaptive and counts[2] else error)
    return Followed(
        states,
        np.ascontiguousarray(smoothed.transpose(2, 0, 1)),
        np.sqrt(spread / counts[0]),
        estimate,
        ratios / max(counts[1], 1),
        kept,
    )


def combined(rows: FloatArray, weights: FloatArray) -> FloatArray:
    """Members ``(rows, batch, members)`` after the update by `combinations`."""
    after = np.empty_like(rows)
    with np.errstate(invalid="ignore", over="ignore"):  # of members that diverge
        np.matmul(rows.transpose(1, 0, 2), weights, out=after.transpose(1, 0, 2))
    return after


def joined(parts: Sequence[Followed], sizes: Sequence[int]) -> Followed:
    """Results along several batches of series of these sizes, whose estimates are averaged."""
    if len(parts) == 1:
        return parts[0]

    def average(name: str, power: int) -> FloatArray:
        values = np.array([getattr(part, name) for part in parts])
        mean = np.average(values**power, axis=0, weights=sizes)
        return np.asarray(mean ** (1 / power))

    return Followed(
        np.concatenate([part.states for part in parts], axis=1),
        np.concatenate([part.smoothed for part in parts]),
        average("spread", 2),
        average("model_error", 2),
        average("consistency", 1),
        {
            step: np.concatenate([part.kept[step] for part in parts], axis=1)
            for step in parts[0].kept
        },
    )

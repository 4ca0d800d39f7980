"""Survival in the chaotic phase: survival curve and escape rate.

Chaos in the shear flow is transient: once a series has forgotten where it began, it laminarises
with the same probability per unit of time, so that lifetimes are exponential. A forecaster with
another escape rate has another flow (Pershin, Beaume, Li & Tobias, arXiv:2111.06783).
"""

from dataclasses import dataclass

import numpy as np
import scipy

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.poisson import poisson_interval


@dataclass(frozen=True)
class Lifetimes:
    """Lifetimes of many series, all watched for equally long."""

    #: steps until each series left the chaotic phase; the whole length of one that did not,
    #: ``(series,)``
    steps: IntArray
    escaped: BoolArray  #: whether it did, ``(series,)``; the others are censored
    length: int  #: steps that each series is watched for


@dataclass(frozen=True)
class EscapeRate:
    """Escapes from the chaotic phase per time unit that a series spends in it."""

    escapes: int  #: number of series that left
    time_at_risk: float  #: time that all series together were in the chaotic phase, in time units
    #: rate, low, high: with its interval, in inverse time units; NaN where there was no time at
    #: risk
    rate: float
    low: float
    high: float


def survival_curve(
    lifetimes: Lifetimes, times: IntArray, confidence: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Share of the series that are still in the chaotic phase after some steps, with its interval.

    All are watched for equally long: this is the Kaplan-Meier estimate. The intervals are exact
    ones of a share (Clopper & Pearson, Biometrika 26 (1934) 404), at each time by itself.
    """
    if lifetimes.steps.size == 0:
        raise ValueError("a survival curve needs a series")
    if (times > lifetimes.length).any():
        raise ValueError(f"the series are watched for {lifetimes.length} steps only")
    ends = np.sort(lifetimes.steps[lifetimes.escaped])
    count = lifetimes.steps.size
    alive = count - np.searchsorted(ends, times, side="right")
    tail = (1 - confidence) / 2
    # at the ends, where no such quantile is defined, an interval reaches to 0 and to 1
    quantile = scipy.special.betaincinv
    low = np.where(alive > 0, quantile(np.maximum(alive, 1), count - alive + 1, tail), 0.0)
    high = np.where(alive < count, quantile(alive + 1, np.maximum(count - alive, 1), 1 - tail), 1.0)
    return alive / count, low, high


def escape_rate(
    lifetimes: Lifetimes, sampling_interval: float, confidence: float, start: int | None = None
) -> EscapeRate:
    """Rate of the exponential distribution of lifetimes, by maximum likelihood.

    It is the number of escapes over the time at risk, with the exact interval of a Poisson count
    (`burstcast.base.poisson`). ``start``: Steps at the beginning of each series that are
    left out, in which it still remembers where it began; None: the first quarter.
    """
    if start is None:
        start = lifetimes.length // 4
    if not 0 <= start < lifetimes.length:
        raise ValueError(
            f"an escape rate cannot be measured from step {start} of {lifetimes.length} on"
        )
    escapes = int((lifetimes.escaped & (lifetimes.steps > start)).sum())
    time = float(np.maximum(lifetimes.steps - start, 0).sum() * sampling_interval)
    if time == 0:
        return EscapeRate(escapes, time, *[float("nan")] * 3)
    return EscapeRate(escapes, time, escapes / time, *poisson_interval(escapes, time, confidence))

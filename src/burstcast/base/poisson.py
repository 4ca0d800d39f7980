"""Exact intervals of the rate of a Poisson process."""

import math

import scipy


def poisson_interval(events: float, time: float, confidence: float) -> tuple[float, float]:
    """Central interval of a rate from a count of events (Garwood, Biometrika 28 (1936) 437).

    ``events``: Need not be whole: counts that were divided by their dispersion are not. ``time``:
    Time of observation, positive. The lower end is 0 without an event.

    Examples
    --------
    >>> low, high = poisson_interval(12, 1.7e6, 0.95)
    >>> round(1 / high), round(1 / low)
    (81101, 274168)
    """
    tail = (1 - confidence) / 2
    low = float(scipy.special.gammaincinv(events, tail)) if events else 0.0
    high = float(scipy.special.gammaincinv(events + 1, 1 - tail))
    return low / time, high / time


def rate_bound(time: float, confidence: float) -> float:
    """Upper bound of a rate where no event was observed, -log(1 - confidence) / time.

    At a confidence of 0.95 it is 3.0 / time, the rule of three: a process with this rate has no
    event with probability 0.05.

    Examples
    --------
    >>> round(1 / rate_bound(5320.0, 0.95))
    1776
    """
    return -math.log(1 - confidence) / time

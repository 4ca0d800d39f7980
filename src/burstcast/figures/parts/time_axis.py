"""Lyapunov times on the axes of figures that show series."""

from collections.abc import Mapping
from typing import Any

from burstcast.durations import steps_per_lyapunov_time


def samples_per_lyapunov_time(
    exponents: Mapping[str, Any] | None,
    published_exponent: float,
    time_step: float,
    sampling_stride: int,
) -> int:
    """Samples of a series in one Lyapunov time.

    ``exponents``: Computed Lyapunov exponents, if they are the unit of time; None: the published
    one is. ``published_exponent``: Published leading Lyapunov exponent, in inverse time units.
    """
    exponent = exponents["leading"]["mean"] if exponents else published_exponent
    return steps_per_lyapunov_time(exponent, time_step * sampling_stride)

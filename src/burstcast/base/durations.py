"""Durations in Lyapunov times, and the steps of the network that they stand for."""

import math


def steps_per_lyapunov_time(exponent: float, sampling_interval: float) -> int:
    """Whole network steps in one Lyapunov time, floor(1 / (exponent * sampling_interval)).

    A quotient that misses a whole number by rounding error only counts as that whole number.
    ``exponent``: Leading Lyapunov exponent, in inverse time units. ``sampling_interval``: In time
    units.

    Examples
    --------
    >>> steps_per_lyapunov_time(0.0163, 1.0)
    61
    """
    if not (exponent > 0 and math.isfinite(exponent)):
        raise ValueError(f"the leading Lyapunov exponent must be positive, not {exponent}")
    if not (sampling_interval > 0 and math.isfinite(sampling_interval)):
        raise ValueError(f"the sampling interval must be positive, not {sampling_interval}")
    count = math.floor(1.0 / (exponent * sampling_interval) + 1e-9)
    if count < 1:
        raise ValueError(
            f"a Lyapunov time of {1 / exponent:.3g} time units is shorter than one step of the "
            f"network ({sampling_interval} time units): sample the ensemble more often"
        )
    return count


def known_exponent(time_unit: str, given: float | None) -> float | None:
    """Given Lyapunov exponent that sets the unit of time; None where it is computed."""
    return given if time_unit == "given" else None


def steps(duration_lt: float, steps_per_lyapunov_time: int) -> int:
    """Whole network steps in a duration given in Lyapunov times, rounded down.

    A duration that misses a whole number by rounding error only counts as that whole number.

    Examples
    --------
    >>> steps(0.5, 61)
    30
    """
    return math.floor(duration_lt * steps_per_lyapunov_time + 1e-9)


def positive_steps(duration_lt: float, steps_per_lyapunov_time: int, name: str) -> int:
    """Whole network steps in a duration that must have one at least (see `steps`)."""
    count = steps(duration_lt, steps_per_lyapunov_time)
    if count < 1:
        raise ValueError(
            f"{name} is {duration_lt} Lyapunov times, which is shorter than one step of a "
            f"forecast: a Lyapunov time has {steps_per_lyapunov_time}; give a longer duration, or "
            "sample more finely"
        )
    return count

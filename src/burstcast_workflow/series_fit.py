"""Whether what is asked of a time series fits into it.

Checked with the config where the Lyapunov time is known from it, and otherwise in the first job
that knows it. Samples are those of one series, at the networks' sampling interval.
"""

from collections.abc import Mapping
from typing import Any

from burstcast import durations


def check_kept_series(kept: int, needs: Mapping[str, int]) -> None:
    """Check that an ensemble has as many series as are taken from it.

    Parameters
    ----------
    kept
        Series that did not laminarise.
    needs
        How many of them each setting asks for, by its name; no series is taken twice.

    Raises
    ------
    ValueError
        If they are too few.
    """
    wanted = sum(needs.values())
    if wanted > kept:
        listed = " and ".join(f"{name} is {count}" for name, count in needs.items())
        raise ValueError(
            f"{listed}, but only {kept} series did not laminarise and were kept: "
            f"raise ensemble.series, or ask for at most {kept}"
            f"{' in all' if len(needs) > 1 else ''}"
        )


def check_single_shot_validation(
    samples: int, steps_per_lyapunov_time: int, washout_lt: float, interval_lt: float
) -> None:
    """Check that something is left to train on before the validation interval.

    Raises
    ------
    ValueError
        If the series is too short, or the washout or the interval shorter than one step.
    """
    washout = _steps("network.washout_lt", washout_lt, steps_per_lyapunov_time)
    interval = _steps("search.interval_lt", interval_lt, steps_per_lyapunov_time)
    if washout + interval >= samples:
        raise ValueError(
            f"Single Shot Validation trains on nothing: a series has {samples} steps, the washout "
            f"(network.washout_lt) takes {washout} of them and the validation interval "
            f"(search.interval_lt) {interval}; lengthen ensemble.duration"
        )


def check_recycle_validation(
    samples: int,
    steps_per_lyapunov_time: int,
    washout_lt: float,
    interval_lt: float,
    intervals_per_series: int,
) -> None:
    """Check that the validation intervals fit into a series after the washout.

    Raises
    ------
    ValueError
        If they do not, or the washout or an interval is shorter than one step.
    """
    washout = _steps("network.washout_lt", washout_lt, steps_per_lyapunov_time)
    interval = _steps("search.interval_lt", interval_lt, steps_per_lyapunov_time)
    if washout + intervals_per_series * interval > samples:
        most = max(0, (samples - washout) // interval)
        raise ValueError(
            f"recycle_validation.intervals_per_series is {intervals_per_series}, but only {most} "
            f"intervals of {interval} steps (search.interval_lt) after a washout of {washout} fit "
            f"into the {samples} steps of a series (ensemble.duration)"
        )


def check_classification(
    samples: int,
    steps_per_lyapunov_time: int,
    washout_lt: float,
    start_spacing_lt: float,
    resolution_lt: float,
    reach_lt: float,
) -> None:
    """Check that a series has room for a washout and a forecast up to ``reach_lt``.

    Raises
    ------
    ValueError
        If it has not, or a duration is shorter than one step.
    """
    washout = _steps("network.washout_lt", washout_lt, steps_per_lyapunov_time)
    _steps("classification.start_spacing_lt", start_spacing_lt, steps_per_lyapunov_time)
    _steps("classification.resolution_lt", resolution_lt, steps_per_lyapunov_time)
    reach = durations.steps(reach_lt, steps_per_lyapunov_time)
    if washout + reach > samples:
        raise ValueError(
            f"forecasts up to classification.longest_prediction_time_lt plus window_lt take "
            f"{reach} steps, and their washout {washout}, but a series has {samples} "
            f"(ensemble.duration)"
        )


def check_horizon(
    samples: int,
    steps_per_lyapunov_time: int,
    washout_lt: float,
    longest_start_lt: float,
    start_step_lt: float | None = None,
) -> None:
    """Check that a series has room for the longest start before an event, and its washout.

    The distance of two starts is looked at where it is given.

    Raises
    ------
    ValueError
        If it has not, or a duration is shorter than one step.
    """
    washout = _steps("network.washout_lt", washout_lt, steps_per_lyapunov_time)
    if start_step_lt is not None:
        _steps("horizon.start_step_lt", start_step_lt, steps_per_lyapunov_time)
    start = _steps("horizon.longest_start_lt", longest_start_lt, steps_per_lyapunov_time)
    if washout + start > samples:
        raise ValueError(
            f"forecasts from horizon.longest_start_lt before an event take {start} steps, and "
            f"their washout {washout}, but a series has {samples} (ensemble.duration)"
        )


def misfits(
    config: Mapping[str, Any], record: Mapping[str, Any], samples: int, steps_per_lt: int
) -> list[str]:
    """All that does not fit into a series of one case, as messages.

    Parameters
    ----------
    config
        The whole configuration.
    record
        The record of the case.
    samples
        Samples of a series.
    steps_per_lt
        Steps of the network in a Lyapunov time.
    """
    search, horizon = config["search"], config["horizon"]
    classification = config["classification"]
    washout_lt = config["network"]["washout_lt"]
    messages = []
    for check, arguments in (
        (check_single_shot_validation, (search["interval_lt"],)),
        (
            check_recycle_validation,
            (search["interval_lt"], record["recycle_validation"]["intervals_per_series"]),
        ),
        (
            check_classification,
            (
                classification["start_spacing_lt"],
                classification["resolution_lt"],
                classification["longest_prediction_time_lt"] + classification["window_lt"],
            ),
        ),
        (check_horizon, (horizon["longest_start_lt"], horizon["start_step_lt"])),
    ):
        try:
            check(samples, steps_per_lt, washout_lt, *arguments)
        except ValueError as error:
            messages.append(str(error))
    return list(dict.fromkeys(messages))


def _steps(name: str, duration_lt: float, steps_per_lyapunov_time: int) -> int:
    count = durations.steps(duration_lt, steps_per_lyapunov_time)
    if count < 1:
        raise ValueError(
            f"{name} is {duration_lt} Lyapunov times, which is shorter than one step of the "
            f"network: a Lyapunov time has {steps_per_lyapunov_time}"
        )
    return count

"""Whether what is asked of a time series fits into it.

Checked with the config where the Lyapunov time is known from it, and otherwise in the first job
that knows it. Samples are those of one series, at the sampling interval of forecasts. What does not
fit is a ValueError, and so is a duration that is shorter than one step of the network.
"""

from collections.abc import Mapping
from typing import Any

from burstcast import durations

CALIBRATION_SPACING = "probability.start_spacing_lt"
"""Setting of the distance of the starting points that probabilities are calibrated on."""


def check_kept_series(kept: int, needs: Mapping[str, int]) -> None:
    """Check that an ensemble has as many series as are taken from it.

    Parameters
    ----------
    kept
        Series that did not laminarise.
    needs
        How many of them each setting asks for, by its name; no series is taken twice.
    """
    if sum(needs.values()) > kept:
        listed = " and ".join(f"{name} is {count}" for name, count in needs.items())
        raise ValueError(
            f"{listed}, but only {kept} series did not laminarise and were kept: "
            f"raise ensemble.series, or ask for at most {kept}"
            f"{' in all' if len(needs) > 1 else ''}"
        )


def check_single_shot_validation(
    samples: int, steps_per_lyapunov_time: int, washout_lt: float, interval_lt: float
) -> None:
    """Check that something is left to train on before the validation interval."""
    washout = _steps("washout_lt", washout_lt, steps_per_lyapunov_time)
    interval = _steps("search.interval_lt", interval_lt, steps_per_lyapunov_time)
    if washout + interval >= samples:
        raise ValueError(
            f"Single Shot Validation trains on nothing: a series has {samples} steps, the washout "
            f"(washout_lt) takes {washout} of them and the validation interval "
            f"(search.interval_lt) {interval}; lengthen ensemble.duration"
        )


def check_recycle_validation(
    samples: int,
    steps_per_lyapunov_time: int,
    washout_lt: float,
    interval_lt: float,
    intervals_per_series: int,
) -> None:
    """Check that the validation intervals fit into a series after the washout."""
    washout = _steps("washout_lt", washout_lt, steps_per_lyapunov_time)
    interval = _steps("search.interval_lt", interval_lt, steps_per_lyapunov_time)
    most = max(0, (samples - washout) // interval)
    if intervals_per_series > most:
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
    spacing: str = "classification.start_spacing_lt",
) -> None:
    """Check that a series has room for a washout and a forecast up to ``reach_lt``.

    ``spacing`` is the setting of the distance of starting points.
    """
    _steps(spacing, start_spacing_lt, steps_per_lyapunov_time)
    _steps("classification.resolution_lt", resolution_lt, steps_per_lyapunov_time)
    what = "forecasts up to classification.longest_prediction_time_lt plus window_lt"
    reach = durations.steps(reach_lt, steps_per_lyapunov_time)
    _check_room(samples, steps_per_lyapunov_time, washout_lt, what, reach)


def check_horizon(
    samples: int,
    steps_per_lyapunov_time: int,
    washout_lt: float,
    longest_lead_time_lt: float,
    lead_time_step_lt: float | None = None,
) -> None:
    """Check that a series has room for the longest start before an event, and its washout.

    The distance of two starts is looked at where it is given.
    """
    if lead_time_step_lt is not None:
        _steps("horizon.lead_time_step_lt", lead_time_step_lt, steps_per_lyapunov_time)
    what = "forecasts from horizon.longest_lead_time_lt before an event"
    start = _steps("horizon.longest_lead_time_lt", longest_lead_time_lt, steps_per_lyapunov_time)
    _check_room(samples, steps_per_lyapunov_time, washout_lt, what, start)


def check_learnt_equations(samples: int, steps_per_lyapunov_time: int, window_lt: float) -> None:
    """Check that the window that equations are learnt from is a step at least, and in a series."""
    name = "forecasters.quadratic.window_lt"
    window = _steps(name, window_lt, steps_per_lyapunov_time)
    if window >= samples:
        raise ValueError(
            f"{name} is {window} steps, but a series has {samples} samples (ensemble.duration)"
        )


def misfits(
    config: Mapping[str, Any], record: Mapping[str, Any], samples: int, steps_per_lt: int
) -> list[str]:
    """All that does not fit into a series of the case with this record, as messages."""
    horizon, classification = config["horizon"], config["classification"]
    interval_lt, washout_lt = config["search"]["interval_lt"], config["washout_lt"]
    intervals = record["recycle_validation"]["intervals_per_series"]
    spacing_lt = classification["start_spacing_lt"]
    denser_lt = config["probability"]["start_spacing_lt"]
    resolution_lt = classification["resolution_lt"]
    reach_lt = classification["longest_prediction_time_lt"] + classification["window_lt"]
    messages = []
    for check, arguments in (
        (check_single_shot_validation, (interval_lt,)),
        (check_recycle_validation, (interval_lt, intervals)),
        (check_classification, (spacing_lt, resolution_lt, reach_lt)),
        (check_classification, (denser_lt, resolution_lt, reach_lt, CALIBRATION_SPACING)),
        (check_horizon, (horizon["longest_lead_time_lt"], horizon["lead_time_step_lt"])),
    ):
        try:
            check(samples, steps_per_lt, washout_lt, *arguments)
        except ValueError as error:
            messages.append(str(error))
    return list(dict.fromkeys(messages))


def _check_room(
    samples: int, steps_per_lyapunov_time: int, washout_lt: float, what: str, steps: int
) -> None:
    washout = _steps("washout_lt", washout_lt, steps_per_lyapunov_time)
    if washout + steps > samples:
        raise ValueError(
            f"{what} take {steps} steps, and their washout {washout}, but a series has {samples} "
            f"(ensemble.duration)"
        )


def _steps(name: str, duration_lt: float, steps_per_lyapunov_time: int) -> int:
    count = durations.steps(duration_lt, steps_per_lyapunov_time)
    if count < 1:
        raise ValueError(
            f"{name} is {duration_lt} Lyapunov times, which is shorter than one step of the "
            f"network: a Lyapunov time has {steps_per_lyapunov_time}"
        )
    return count

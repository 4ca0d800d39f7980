"""One event as the committees of a case see it, with the probabilities that follow from it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.files.described import Described
from burstcast.files.units import LYAPUNOV_TIMES, NUMBER, OBSERVABLE
from burstcast.forecast.window_forecasts import member_forecasts
from burstcast.forecasters.base import Forecaster
from burstcast.probability.alarm_rule import CALIBRATED, rules_of
from burstcast.probability.alarm_sources import AlarmSource
from burstcast.probability.forecast_points import ForecastPoints


@dataclass(frozen=True)
class CommitteeEvent:
    """An event from one starting point; without one, no time and no member is shown."""

    time_lt: Annotated[
        FloatArray,
        Described("time", LYAPUNOV_TIMES, "time after the starting point"),
    ]
    true: Annotated[FloatArray, Described("time", OBSERVABLE, "true observable")]
    observed: Annotated[
        FloatArray, Described("time", OBSERVABLE, "observable of what was observed")
    ]
    prediction_time_lt: Annotated[
        FloatArray, Described("window", LYAPUNOV_TIMES, "beginning of each window")
    ]
    happened: Annotated[BoolArray, Described("window", NUMBER, "whether an event began in it")]
    committee: Annotated[IntArray, Described("member", NUMBER, "committee of each member")]
    forecast: Annotated[FloatArray, Described("member time", OBSERVABLE, "forecast observable")]
    votes: Annotated[
        FloatArray,
        Described("committees window", NUMBER, "share of the members that forecast an event"),
    ]
    probability: Annotated[
        FloatArray, Described("committees window", NUMBER, "calibrated probability of an event")
    ]
    alarm_threshold: Annotated[
        FloatArray,
        Described("committees window", NUMBER, "alarm threshold of the probability"),
    ]


def see_event(
    true: FloatArray,
    observed: FloatArray,
    forecasts: Sequence[FloatArray],
    prediction_times_lt: Sequence[float],
    happened: Sequence[bool],
    chances: FloatArray,
    steps_per_lyapunov_time: int,
) -> CommitteeEvent:
    """Lay out an event on one axis of time.

    ``true``: True observable from the start of the washout to the end of the forecasts,
    ``(time,)``; empty without an event. ``observed``: Observable of the washout; the last entry
    belongs to the starting point. ``forecasts``: By committee: forecast observables of its members
    after that, ``(members, steps)``. ``prediction_times_lt``, ``happened``: Beginnings of windows,
    and whether an event began in each. ``chances``: Shares of votes, calibrated probabilities and
    thresholds of alarms, ``(3, committees, windows)``.
    """
    length, now = len(true), len(observed)
    seen = np.full(length, np.nan)
    seen[:now] = observed
    drawn = np.full((sum(map(len, forecasts)), length), np.nan)
    if len(drawn):
        drawn[:, now:] = np.concatenate(forecasts)
    return CommitteeEvent(
        np.arange(length) / steps_per_lyapunov_time - (now - 1) / steps_per_lyapunov_time,
        true,
        seen,
        np.array(prediction_times_lt, dtype=np.float64),
        np.array(happened, dtype=bool),
        np.repeat(np.arange(len(forecasts)), [len(fan) for fan in forecasts]),
        drawn,
        *chances,
    )


def committee_chances(
    points: ForecastPoints,
    point: int,
    committees: Sequence[AlarmSource],
    chosen: Mapping[str, Any],
    prediction_times_lt: Sequence[float],
    event_threshold: float,
) -> FloatArray:
    """Shares of votes, calibrated probabilities and alarm thresholds at one starting point.

    ``points``, ``point``: Starting points of the case, and the row of this one. Shape ``(3,
    committees, windows)``.
    """
    chances = np.full((3, len(committees), len(prediction_times_lt)), np.nan)
    for number, committee in enumerate(committees):
        for column, time in enumerate(prediction_times_lt):
            rule = rules_of(chosen, committee.identifier, time)[CALIBRATED]
            votes = points.values(committee, time, event_threshold)[point : point + 1]
            chances[:, number, column] = votes[0], rule.calibration(votes)[0], rule.threshold
    return chances


def member_observables(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    washout: FloatArray,
    steps: int,
    parameters: FloatArray | None = None,
) -> FloatArray:
    """Observable that each member forecasts after one washout, ``(members, steps)``.

    ``washout``: Observed states up to the starting point, ``(steps, dimension)``. ``parameters``:
    Schedule over washout and forecast, from each state to the next, ``(washout - 1 + steps,
    parameters)``; None: the case's own values.
    """
    given = np.ascontiguousarray(washout[:, :, np.newaxis])
    in_force = None if parameters is None else parameters[np.newaxis]
    states = member_forecasts(forecaster, given, steps, in_force)[..., 0]
    return observable(states.transpose(1, 0, 2)).T

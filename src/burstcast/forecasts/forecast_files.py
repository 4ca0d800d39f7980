"""Forecasts as files: starting points, windows, events, prediction horizons."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import COMPONENT, LYAPUNOV_TIMES, NUMBER, OBSERVABLE
from burstcast.base.series_lengths import numbers_of
from burstcast.data.starting_points import SeriesPoints, segments
from burstcast.forecasts.points import ObservedPoints
from burstcast.forecasts.probabilities import EventProbabilities
from burstcast.forecasts.windows import WindowForecasts


def point_variables(
    observations: ObservedPoints, true_states: FloatArray, name: str
) -> dict[str, Variable]:
    """Variables of a set of starting points of series with true states."""
    points, truth = observations.points, observations.truth
    each, in_windows = ("point",), ("point", "window")
    return {
        "series": Variable(each, points.series, NUMBER, "row among the series of this set"),
        "step": Variable(each, points.step, NUMBER, "step of the starting point"),
        "washout": Variable(
            ("point", "washout_step", "component"),
            observations.washouts,
            COMPONENT,
            "observed states up to the starting point",
        ),
        "true_washout": Variable(
            ("point", "washout_step", "component"),
            segments(true_states, points, observations.washouts.shape[1] - 1, 0),
            COMPONENT,
            "true states up to the starting point, for forecasters that see them",
        ),
        "observable_now": Variable(
            each, observations.seen[:, -1], OBSERVABLE, f"observed {name} at the starting point"
        ),
        "washout_maximum": Variable(
            each,
            observations.seen.max(axis=1),
            OBSERVABLE,
            f"largest observed {name} of the washout",
        ),
        "first": Variable(
            in_windows, truth.first, OBSERVABLE, f"true {name} at the first step of each window"
        ),
        "largest": Variable(
            in_windows, truth.largest, OBSERVABLE, f"largest true {name} in each window"
        ),
    }


def schedule_variables(
    observations: ObservedPoints, schedules: FloatArray, horizon: int
) -> dict[str, Variable]:
    """Variable of the parameters over the washouts and forecasts of points."""
    washout = observations.washouts.shape[1]
    return {
        "parameter": Variable(
            ("point", "step_in_force", "parameter_name"),
            segments(schedules, observations.points, washout - 1, horizon - 1),
            None,
            "value of each parameter in force from each sample of the washout and of the forecast "
            "to the next",
        )
    }


def forecast_variables(forecasts: WindowForecasts, name: str) -> dict[str, Variable]:
    """Variables of forecasts of the observable called ``name``, and of an ensemble's members."""
    points, members = ("point", "window"), ("point", "member", "window")
    first = f"forecast {name} at the first step of each window"
    largest = f"largest forecast {name} in each window"
    lost = "whether the forecast has diverged"
    variables = {
        "first": Variable(points, forecasts.first, OBSERVABLE, first),
        "largest": Variable(points, forecasts.largest, OBSERVABLE, largest),
        "diverged": Variable(("point",), forecasts.diverged, NUMBER, lost),
    }
    if forecasts.member_first.size:
        for name, meaning in (("member_first", first), ("member_largest", largest)):
            values = getattr(forecasts, name)
            variables[name] = Variable(members, values, OBSERVABLE, f"{meaning}, by each member")
    return variables


def forecasts_from(arrays: Mapping[str, Any]) -> WindowForecasts | EventProbabilities:
    """Forecasts, or probabilities of events by a classifier, from the variables of their file."""
    if "probability" in arrays:
        return EventProbabilities(
            **{field.name: arrays[field.name] for field in fields(EventProbabilities)}
        )
    none = np.empty((len(arrays["first"]), 0, arrays["first"].shape[1]))
    return WindowForecasts(
        **{field.name: arrays.get(field.name, none) for field in fields(WindowForecasts)}
    )


def event_summary(
    observable: FloatArray, threshold: float, training: int, crossings: int, usable: int
) -> dict[str, float]:
    """Summary of the events of all kept series.

    ``observable``: True observable, ``(series, time)``; NaN counts nowhere. ``crossings``,
    ``usable``: Number of events in all series, and of those whose prediction horizon can be
    measured.
    """
    everywhere, in_training = numbers_of(observable), numbers_of(observable[:training])
    return {
        "event_share": float((everywhere >= threshold).mean()),
        "training_event_share": float((in_training >= threshold).mean()),
        "events_per_series": crossings / len(observable),
        "usable_events": usable,
        "largest_observable": float(np.max(everywhere)),
    }


def event_variables(
    points: SeriesPoints,
    first: int,
    observed: FloatArray,
    states: FloatArray,
    observable: FloatArray,
    before: int,
    schedules: FloatArray | None = None,
) -> dict[str, Variable]:
    """Variables of events: their places, and observed and true series up to them.

    ``points``, ``first``: Events in all kept series; the first of these in ``observed`` and
    ``states``. ``observable``: Of all kept series. ``before``: Steps before each event.
    ``schedules``: Parameters from each sample to the next.
    """
    in_part = SeriesPoints(points.series - first, points.step)
    step_by_step = ("event", "step_before", "component")
    in_force = {}
    if schedules is not None:
        in_force["parameter"] = Variable(
            ("event", "step_in_force", "parameter_name"),
            segments(schedules, SeriesPoints(in_part.series, points.step - 1), before - 1, 0),
            None,
            "value of each parameter in force from each sample before the event to the next",
        )
    return {
        **in_force,
        **_which(points.series, points.step),
        "observed": Variable(
            step_by_step,
            segments(observed, in_part, before, 0),
            COMPONENT,
            "observed states up to the event",
        ),
        "true_state": Variable(
            step_by_step,
            segments(states, in_part, before, 0),
            COMPONENT,
            "true states up to the event, for forecasters that see them",
        ),
        "truth": Variable(
            ("event", "step_before"),
            segments(observable, points, before, 0),
            OBSERVABLE,
            "true observable up to the event",
        ),
    }


def horizon_variables(
    series: IntArray, step: IntArray, horizons: FloatArray
) -> dict[str, Variable]:
    """Variables of prediction horizons in Lyapunov times, by the series and step of the event."""
    meaning = "prediction horizon of the event"
    horizon = Variable(("event",), horizons, LYAPUNOV_TIMES, meaning)
    return {**_which(series, step), "prediction_horizon_lt": horizon}


def _which(series: IntArray, step: IntArray) -> dict[str, Variable]:
    return {
        "series": Variable(("event",), series, NUMBER, "row among the kept series"),
        "step": Variable(("event",), step, NUMBER, "step at which the event begins"),
    }

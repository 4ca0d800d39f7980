"""Single forecasts worth looking at: one of each outcome, and the last ones before a success."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import LYAPUNOV_TIMES, NUMBER, OBSERVABLE
from burstcast.data.starting_points import SeriesPoints
from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.horizon import HorizonSearch, accurate_steps
from burstcast.forecasts.windows import WindowSummaries, crosses

OUTCOMES = ("true positive", "false positive", "false negative")


def outcome_examples(
    forecast: WindowSummaries,
    truth: WindowSummaries,
    washout_maximum: FloatArray,
    *,
    first_window: int,
    windows: int,
    threshold: float,
) -> dict[str, int]:
    """One starting point for each outcome that occurs.

    Of all points with an outcome the one is taken whose burst (the true one; the forecast one for a
    false positive) has the median height in the window. Clear misses and clear false alarms come
    first: those in which the one without an event stays below the threshold in the neighbouring
    windows as well. Points whose washout reaches the threshold are not scored. ``first_window``,
    ``windows``: See `burstcast.forecasts.windows.crosses`.
    """
    span = slice(first_window, first_window + windows)
    wider = slice(max(0, first_window - windows), first_window + 2 * windows)
    predicted = crosses(forecast, first_window, windows, threshold)
    happened = crosses(truth, first_window, windows, threshold)
    scored = washout_maximum < threshold
    quiet_truth, quiet_forecast = (
        summaries.largest[:, wider].max(axis=1) < threshold for summaries in (truth, forecast)
    )
    heights = {
        "true positive": (predicted & happened, predicted, truth),
        "false positive": (predicted & ~happened, quiet_truth, forecast),
        "false negative": (~predicted & happened, quiet_forecast, truth),
    }
    examples = {}
    for outcome in OUTCOMES:
        matches, clear, summaries = heights[outcome]
        points = np.flatnonzero(matches & scored & clear)
        if not points.size:
            points = np.flatnonzero(matches & scored)
        if points.size:
            height = summaries.largest[points, span].max(axis=1)
            examples[outcome] = int(points[np.argsort(height, kind="stable")[points.size // 2]])
    return examples


@dataclass(frozen=True)
class OutcomeExamples:
    """Forecasts with each outcome that occurs, and the truth."""

    outcome: Annotated[
        IntArray,
        Described(
            "example",
            NUMBER,
            f"outcome ({', '.join(f'{number}: {text}' for number, text in enumerate(OUTCOMES))})",
        ),
    ]
    example_time_lt: Annotated[
        FloatArray,
        Described("example_step", LYAPUNOV_TIMES, "time after the starting point"),
    ]
    example_truth: Annotated[
        FloatArray, Described("example example_step", OBSERVABLE, "true observable")
    ]
    example_forecast: Annotated[
        FloatArray, Described("example example_step", OBSERVABLE, "forecast observable")
    ]


def forecast_outcomes(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    truth: FloatArray,
    points: SeriesPoints,
    outcomes: Sequence[str],
    *,
    before: int,
    reach: int,
    steps_per_lyapunov_time: int,
) -> OutcomeExamples:
    """Forecast from starting points that stand for outcomes; ``truth`` is ``(series, time)``."""
    true = np.full((len(outcomes), before + 1 + reach), np.nan)
    forecasts = np.full_like(true, np.nan)
    for number, (row, step) in enumerate(zip(points.series, points.step, strict=True)):
        true[number] = stretch(truth[row], step - before, true.shape[1])
    if outcomes:
        forecasts[:, before + 1 :] = forecast_observable(forecaster, observable, washouts, reach)
    return OutcomeExamples(
        np.array([OUTCOMES.index(outcome) for outcome in outcomes], dtype=np.int64),
        np.arange(-before, reach + 1) / steps_per_lyapunov_time,
        true,
        forecasts,
    )


def horizon_example(
    horizons: FloatArray, lead_times_lt: list[float], wanted_lt: float, evaluations: int = 4
) -> tuple[int, tuple[float, ...]] | None:
    """Event whose horizon is nearest to the wanted one, with its last evaluations.

    These are the lead times that failed to forecast it, and the first that did at the end.
    """
    # an event that every start has failed on has a horizon below the shortest start
    match = np.isclose(horizons[:, np.newaxis], np.asarray(lead_times_lt))
    success = np.where(match.any(axis=1), match.argmax(axis=1), -1)
    usable = np.flatnonzero(success >= evaluations - 1)
    if usable.size == 0:
        usable = np.flatnonzero(success >= 0)
    if usable.size == 0:
        return None
    event = int(usable[np.argmin(np.abs(horizons[usable] - wanted_lt))])
    last = int(success[event])
    return event, tuple(lead_times_lt[max(0, last - evaluations + 1) : last + 1])


@dataclass(frozen=True)
class Evaluations:
    """Forecasts of one event from several starts; nothing is shown where there is none."""

    evaluation_time_lt: Annotated[
        FloatArray,
        Described("event_step", LYAPUNOV_TIMES, "time after the event"),
    ]
    evaluation_truth: Annotated[FloatArray, Described("event_step", OBSERVABLE, "true observable")]
    evaluation_forecast: Annotated[
        FloatArray, Described("evaluation event_step", OBSERVABLE, "forecast observable")
    ]
    evaluation_lead_time_lt: Annotated[FloatArray, Described("evaluation", LYAPUNOV_TIMES, "tau_e")]
    evaluation_horizon_lt: Annotated[FloatArray, Described("evaluation", LYAPUNOV_TIMES, "horizon")]
    allowed_error: Annotated[
        float, Described("", OBSERVABLE, "error at which a prediction is lost")
    ]


def evaluate_lead_times(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    observed: FloatArray,
    truth: FloatArray,
    lead_times_lt: Sequence[float],
    search: HorizonSearch,
) -> Evaluations:
    """Forecast one event from several starts, and beyond it.

    ``observed``: States up to the event. ``truth``: True observable of the same steps and of those
    after the event. Forecasts are NaN up to their start; the horizon of one that reaches the event
    is its tau_e.
    """
    event, steps = search.steps_before_event, search.steps_per_lyapunov_time
    forecast = np.full((len(lead_times_lt), len(truth)), np.nan)
    horizon = np.full(len(lead_times_lt), np.nan)
    for number, lead_time_lt in enumerate(lead_times_lt):
        start = event - durations.steps(lead_time_lt, steps)
        washout = observed[np.newaxis, start - search.washout + 1 : start + 1]
        forecast[number, start + 1 :] = forecast_observable(
            forecaster, observable, washout, len(truth) - 1 - start
        )
        accurate = accurate_steps(
            forecaster,
            observable,
            np.ascontiguousarray(washout.transpose(1, 2, 0)),
            np.ascontiguousarray(truth[start + 1 : event + 1, np.newaxis]),
            search.tolerance,
        )[0]
        # a Lyapunov time is cut to whole steps: a success is worth all of tau_e
        reached = accurate == event - start
        horizon[number] = lead_time_lt if reached else accurate / steps
    time = (np.arange(len(truth)) - event) / steps
    lead_times = np.array(lead_times_lt, dtype=np.float64)
    return Evaluations(time, truth, forecast, lead_times, horizon, search.tolerance)


def evaluate_event(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    observed: FloatArray,
    points: SeriesPoints,
    truth_of: Callable[[int], FloatArray],
    horizons: FloatArray,
    search: HorizonSearch,
    *,
    wanted_lt: float,
    after_lt: float,
) -> Evaluations:
    """Forecast the event of `horizon_example` from its last starts; nothing if there is none.

    ``observed``: ``(events, search.steps_before_event + 1, dimension)``.
    """
    example = horizon_example(horizons, search.lead_times_lt, wanted_lt)
    before = search.steps_before_event
    shown = before + 1 + durations.steps(after_lt, search.steps_per_lyapunov_time)
    truth, starts = np.full(shown, np.nan), tuple[float, ...]()
    before_event = np.full(observed.shape[1:], np.nan)
    if example is not None:
        event, starts = example
        truth = stretch(
            truth_of(int(points.series[event])), int(points.step[event]) - before, shown
        )
        before_event = observed[event]
    return evaluate_lead_times(forecaster, observable, before_event, truth, starts, search)


def forecast_observable(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    steps: int,
) -> FloatArray:
    """Observable of whole forecasts, ``(points, steps)``, from one step after the start on."""
    memory = forecaster.start(np.ascontiguousarray(washouts.transpose(1, 2, 0)))
    states, _ = forecaster.advance(memory, steps)
    return observable(states.transpose(1, 0, 2)).T


def stretch(series: FloatArray, first: int, count: int) -> FloatArray:
    """Cut ``count`` samples out of a series from ``first`` on; NaN beyond its ends."""
    result = np.full(count, np.nan)
    start, stop = max(first, 0), min(first + count, len(series))
    if start < stop:
        result[start - first : stop - first] = series[start:stop]
    return result

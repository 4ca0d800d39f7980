"""Single forecasts for figures: one of each outcome, the last ones before a success, one event.

Source: the paper's figures of the midplane and of the vorticity during an event. There the flow
slowly laminarises (t_1 to t_3) until the laminar structure suddenly breaks down into vortices
(t_4). Which event of the test set to show is our choice, and is made by rule.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import COMPONENT, LYAPUNOV_TIMES, NUMBER, OBSERVABLE
from burstcast.data.events import upward_crossings
from burstcast.data.starting_points import SeriesPoints, segments
from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.horizon import HorizonSearch, accurate_steps
from burstcast.forecasts.windows import WindowSummaries, crosses
from burstcast.systems.state_space import StateSpace

CANDIDATES_PER_BATCH = 64
"""Events that are forecast side by side: bounds the time and memory, changes no result."""


@dataclass(frozen=True)
class EventCriterion:
    """Conditions on events for figures.

    The excursion of an event reaches from the last step at or below the calm level before it to the
    first one after it. Isolated events are the only one within their excursion and ``quiet`` steps
    on both sides.
    """

    threshold: float  #: the event threshold, k_e
    calm: float  #: the calm level, below the threshold, such as the mean of the observable
    quiet: int  #: steps below the threshold that are required on each side of the excursion
    longest: int  #: largest number of steps from t_1 to t_4
    wanted_peak: float  #: largest observable of the best event; others rank by their distance to it

    def __post_init__(self) -> None:
        if not self.calm < self.threshold:
            raise ValueError(
                f"the calm level {self.calm} must lie below the event threshold {self.threshold}"
            )


@dataclass(frozen=True)
class ExampleEvent:
    """An event to show."""

    series: int  #: row of its series
    #: steps t_1 < t_2 < t_3 < t_4 in the series: the last calm step before the event; on the rise,
    #: the first step at or above the middle between the calm level and the peak; the peak, where
    #: the flow is closest to laminar; and the first step after it below the threshold, when the
    #: laminar structure has broken down
    times: tuple[int, int, int, int]
    peak: float  #: largest observable


def isolated_events(
    observable: FloatArray, criterion: EventCriterion, before: int = 0
) -> list[ExampleEvent]:
    """All events that meet a criterion, the best first; equally good ones in their order.

    ``observable``: ``(series, time)``. ``before``: Steps that the series must have before t_1.
    """
    events = []
    for row, values in enumerate(observable):
        calm = values <= criterion.calm
        above = values >= criterion.threshold
        crossings = np.flatnonzero(upward_crossings(values, criterion.threshold))
        for crossing in crossings.tolist():
            calm_before = np.flatnonzero(calm[:crossing])
            calm_after = np.flatnonzero(calm[crossing:])
            if calm_before.size == 0 or calm_after.size == 0:
                continue
            begin, end = int(calm_before[-1]), crossing + int(calm_after[0])
            quiet_begin, quiet_end = begin - criterion.quiet, end + criterion.quiet
            if begin < before or quiet_begin < 0 or quiet_end >= len(values):
                continue
            # the only crossing between the two quiet stretches, and no event is under way at first
            inside = (crossings > quiet_begin) & (crossings <= quiet_end)
            if above[quiet_begin] or inside.sum() != 1:
                continue
            event = _timed(row, values, begin, end, criterion)
            if event.times[3] - event.times[0] <= criterion.longest:
                events.append(event)
    return sorted(events, key=lambda event: abs(event.peak - criterion.wanted_peak))


def _timed(
    row: int, values: FloatArray, begin: int, end: int, criterion: EventCriterion
) -> ExampleEvent:
    """Event with its four times, from the first and last step of its excursion."""
    peak = begin + int(values[begin:end].argmax())
    height = float(values[peak])
    middle = begin + int((values[begin:end] >= 0.5 * (criterion.calm + height)).argmax())
    broken_down = peak + int((values[peak : end + 1] < criterion.threshold).argmax())
    return ExampleEvent(row, (begin, middle, peak, broken_down), height)


def predicted_event(
    events: list[ExampleEvent],
    forecaster: Forecaster,
    observed: FloatArray,
    states: FloatArray,
    *,
    lead: int,
    washout: int,
    tolerance: float,
) -> ExampleEvent | None:
    """Best event that a forecaster predicts from its build-up to its breakdown.

    The forecast starts ``lead`` steps before t_1; its state must stay within the tolerance up to
    t_4. Without such an event, the one with the largest share of accurate steps; None without
    events. ``events``: The best first, with at least ``lead + washout - 1`` steps before t_1.
    """
    best: tuple[float, ExampleEvent] | None = None
    for first in range(0, len(events), CANDIDATES_PER_BATCH):
        batch = events[first : first + CANDIDATES_PER_BATCH]
        points = SeriesPoints(
            series=np.array([event.series for event in batch]),
            step=np.array([event.times[0] - lead for event in batch]),
        )
        needed = np.array([event.times[3] for event in batch]) - points.step
        ahead = int(needed.max())
        # NaN beyond the breakdown: no forecast counts as accurate there
        true = np.full((ahead, states.shape[2], len(batch)), np.nan)
        for column, event in enumerate(batch):
            start = int(points.step[column])
            true[: needed[column], :, column] = states[event.series, start + 1 : event.times[3] + 1]
        memory = forecaster.start(
            np.ascontiguousarray(segments(observed, points, washout - 1, 0).transpose(1, 2, 0))
        )
        forecast, _ = forecaster.advance(memory, ahead)
        # a forecast that is no longer finite is not near either
        near = np.linalg.norm(forecast - true, axis=1) < tolerance
        accurate = np.logical_and.accumulate(near).sum(axis=0)
        for event, share in zip(batch, accurate / needed, strict=True):
            if share >= 1:
                return event
            if best is None or share > best[0]:
                best = (float(share), event)
    return None if best is None else best[1]


@dataclass(frozen=True)
class FlowEvent:
    """An event and its forecast, with states at the event's times; without an event, no time."""

    time_lt: Annotated[
        FloatArray,
        Described("time", LYAPUNOV_TIMES, "time after the start of the forecast"),
    ]
    true: Annotated[FloatArray, Described("time", OBSERVABLE, "true observable")]
    forecast: Annotated[FloatArray, Described("time", OBSERVABLE, "forecast observable")]
    mark: Annotated[IntArray, Described("mark", NUMBER, "entries of time that the states are for")]
    true_state: Annotated[FloatArray, Described("mark component", COMPONENT, "true states")]
    forecast_state: Annotated[FloatArray, Described("mark component", COMPONENT, "forecast states")]


def forecast_event(
    event: ExampleEvent | None,
    forecaster: Forecaster,
    space: StateSpace,
    observed: FloatArray,
    states: FloatArray,
    *,
    lead: int,
    washout: int,
    after: int,
    steps_per_lyapunov_time: int,
) -> FlowEvent:
    """Forecast an event, from its washout to some steps after its breakdown."""
    if event is None:
        nothing = np.empty((0, space.dimension))
        time, shown, forecast, marks = np.empty(0), nothing, nothing, np.empty(0, dtype=np.int64)
    else:
        start = event.times[0] - lead
        steps = np.arange(start - washout + 1, event.times[3] + after + 1)
        time = (steps - start) / steps_per_lyapunov_time
        shown = states[event.series, steps]
        forecast = np.full_like(shown, np.nan)
        # the forecast starts from the observed state
        forecast[washout - 1] = observed[event.series, start]
        memory = forecaster.start(observed[event.series, steps[:washout], :, np.newaxis])
        outputs, _ = forecaster.advance(memory, len(steps) - washout)
        forecast[washout:] = outputs[:, :, 0]
        marks = np.array(event.times, dtype=np.int64) - steps[0]
    return FlowEvent(
        time,
        space.observable(shown.T),
        space.observable(forecast.T),
        marks,
        shown[marks],
        forecast[marks],
    )


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
            search.largest_error,
        )[0]
        # a Lyapunov time is cut to whole steps: a success is worth all of tau_e
        reached = accurate == event - start
        horizon[number] = lead_time_lt if reached else accurate / steps
    time = (np.arange(len(truth)) - event) / steps
    lead_times = np.array(lead_times_lt, dtype=np.float64)
    return Evaluations(time, truth, forecast, lead_times, horizon, search.largest_error)


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
    return observable(forecaster.valid(states).transpose(1, 0, 2)).T


def stretch(series: FloatArray, first: int, count: int) -> FloatArray:
    """Cut ``count`` samples out of a series from ``first`` on; NaN beyond its ends."""
    result = np.full(count, np.nan)
    start, stop = max(first, 0), min(first + count, len(series))
    if start < stop:
        result[start - first : stop - first] = series[start:stop]
    return result

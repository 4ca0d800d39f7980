"""Why an event forecaster has no skill: causes that its series, its durations and its kind show.

A symptom says that forecasts are invalid, or that alarms are no better than chance. Each cause here
is tested by itself, and its sentence says what to change.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import FloatArray
from burstcast.base.exogenous import up_to_sample
from burstcast.base.series_lengths import samples_of
from burstcast.data.observation_noise import coarse_sampling, estimate_noise, spiky_components
from burstcast.data.starting_points import SeriesPoints, segments
from burstcast.event_forecaster.events import FEW_EVENTS, EventTiming
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasts.windows import POINTS_PER_BATCH

_STEP_ERROR = 0.1
"""Error of the first step, over what a component changes by in it, of a model that cannot be right:
it grows exponentially with the steps. Of the noise, what both must have is left out."""
_FEW_INTERVALS = 3
"""Intervals in the window of a regression, below which its quadrature is of low order."""
_FEW_SAMPLES_A_TURN = 8
"""Samples of a turn of the trajectory, below which the sampling is coarse for any model."""
_LARGEST_NOISE = 0.1
"""Change that noise makes from sample to sample, in variances of a component, at most."""
_FEW_SAMPLES = 4
"""Samples of a prediction window, or of a washout, below which it is short."""
_WINDOW_FACTORS = (0.5, 2, 4)
"""Windows of learnt equations that are tried, in units of the given one."""
_WINDOW_POINTS = 200
"""Starting points that judge windows, at most."""
_LEAST_AHEAD = 5
"""Least samples of the forecasts that judge windows."""
_WINDOW_GAIN = 0.05
"""Least gain of another window that is worth a word, in log10 of the mean square error."""


def causes(
    kind: Any,
    timing: EventTiming,
    observed: FloatArray,
    names: Sequence[str],
    *,
    washout: int,
    events: int,
) -> Iterator[str]:
    """Causes that the series, the durations and the options of a kind show.

    ``kind``: The unfitted forecaster or classifier. ``observed``: Training series, ``(series, time,
    component)``. ``names``: Of the components. ``washout``: Its samples. ``events``: Events in the
    training series.
    """
    if events < FEW_EVENTS:
        number = f"{events} event is" if events == 1 else f"{events} events are"
        yield f"{number} too few to learn from (lower event_threshold, or give more series)"
    options = kind.options
    if options.get("noise", 0.0) is None:
        yield from coarse_sampling(observed, names)
    if kind.has_trajectories and (spiky := spiky_components(observed, names)):
        yield (
            f"the sampling is coarse for the spikes of {', '.join(spiky)}, which last a few "
            "samples: sample more finely"
        )
    if kind.has_trajectories and timing.unit > 1:  # in maps, a step is a turn
        yield from _few_samples_a_turn(observed, names)
    if "window_lt" in options:
        intervals = durations.steps(options["window_lt"], timing.unit)
        if intervals < _FEW_INTERVALS:
            yield (
                f"the regression integrates over windows of {intervals} sampling "
                f"interval{'s' if intervals > 1 else ''} (option window_lt, "
                f"{options['window_lt']:g}): try a longer one, or sample more finely"
            )
    shortest = min(end - start for start, end in map(timing.span, timing.times))
    if shortest < _FEW_SAMPLES:
        yield (
            f"the prediction window has {shortest + 1} samples: lengthen window, or sample more "
            "finely"
        )
    # kinds that start from the last state need no washout
    if (kind.has_filter or kind.has_search or not kind.has_trajectories) and washout < _FEW_SAMPLES:
        number = f"{washout} sample{'s' if washout > 1 else ''}"
        yield f"the washout has {number}: lengthen washout, or sample more finely"


def _few_samples_a_turn(observed: FloatArray, names: Sequence[str]) -> Iterator[str]:
    """A sentence about components that oscillate within a few samples.

    The mean square change in a sample of an oscillation of n samples a period is
    2 (1 - cos(2 pi / n)) times its variance; twice that of the noise is left out, but for an
    estimate so large that it may be the oscillation itself.
    """
    if observed.shape[1] <= 8:
        return
    variance = samples_of(observed).var(axis=0)
    noise = np.minimum(2 * np.square(estimate_noise(observed)), _LARGEST_NOISE * variance)
    change = np.square(samples_of(np.diff(observed, axis=1))).mean(axis=0) - noise
    ratio = np.clip(change / np.where(variance > 0, variance, np.inf), 1e-12, 4.0)
    period = 2 * np.pi / np.arccos(1 - 0.5 * ratio)
    fast = [
        f"{names[component]} {period[component]:.2g}"
        for component in np.flatnonzero(period < _FEW_SAMPLES_A_TURN).tolist()
    ]
    if fast:
        yield (
            f"the sampling is coarse: samples in a turn of the trajectory: {', '.join(fast)}; "
            f"sample more finely, {_FEW_SAMPLES_A_TURN} or more in a turn"
        )


def step_error(
    forecaster: Forecaster,
    case: ForecastingCase,
    training: FloatArray,
    points: SeriesPoints,
    washout: int,
    names: Sequence[str],
) -> Iterator[str]:
    """A sentence about a model whose first step errs by much of what the state changes by.

    ``training``: With the inputs of aware kinds as further components. ``points``: In series that
    the forecaster has not learnt from.
    """
    dimension = case.system.dimension
    inputs = training.shape[2] - dimension
    points = SeriesPoints(points.series[:POINTS_PER_BATCH], points.step[:POINTS_PER_BATCH])
    around = segments(training, points, washout - 1, 1)
    washouts = up_to_sample(around, washout, inputs) if inputs else around[:, :washout]
    now, then = around[:, washout - 1, :dimension], around[:, washout, :dimension]
    memory = forecaster.start(np.ascontiguousarray(washouts.transpose(1, 2, 0)))
    with np.errstate(over="ignore", invalid="ignore"):
        forecast = forecaster.advance(memory, 1)[0][0].T
    states = training[..., :dimension]
    if states.shape[1] <= 8:
        return
    # an observation has its noise, and so has the state that the forecast starts from
    noise = 2 * np.square(estimate_noise(states))
    scale = samples_of(states).var(axis=0)
    error = np.square(forecast - then).mean(axis=0) - noise
    change = np.square(then - now).mean(axis=0) - noise
    judged = (change > 1e-6 * scale) & (change > noise)
    ratio = np.sqrt(np.maximum(error, 0.0) / np.where(judged, change, 1.0))
    ratio = np.where(judged, np.where(np.isfinite(ratio), ratio, np.inf), 0.0)
    worst = int(np.argmax(ratio))
    if ratio[worst] > _STEP_ERROR:
        size = f"{ratio[worst]:.0%} of" if ratio[worst] < 10 else "far more than"
        yield (
            f"one sample ahead its forecast of {names[worst]} errs by {size} what this changes by: "
            "models of this kind cannot follow the dynamics at this sampling, or have too few "
            "series to learn them from; take another kind, sample more finely, or give more series"
        )


def better_window(
    kind: Any, case: ForecastingCase, training: FloatArray, points: SeriesPoints
) -> Iterator[str]:
    """A sentence about a window of learnt equations that forecasts series left out better.

    Half and multiples of the kind's ``window_lt`` are compared with it: equations of one half of
    the series forecast the other half from single observations, over a Lyapunov time. ``points``:
    Starting points.
    """
    unit, series = case.steps_per_lyapunov_time, len(training)
    ahead = max(unit, _LEAST_AHEAD)
    given = durations.steps(kind.window_lt, unit)
    windows = sorted({given, *(int(given * factor) for factor in _WINDOW_FACTORS)} - {0})
    inside = points.step + ahead < training.shape[1]
    chosen = np.flatnonzero(inside)[:: max(1, -(-int(inside.sum()) // _WINDOW_POINTS))]
    points = SeriesPoints(points.series[chosen], points.step[chosen])
    around = segments(training, points, 0, ahead)
    whole = np.isfinite(around).all(axis=(1, 2))
    if not whole.any():
        return
    errors = {}
    for window in windows:
        model = QuadraticModel(degree=kind.degree, window_lt=window / unit, noise=kind.noise)
        logs = np.full(len(points), np.nan)
        for fold in range(2):
            here = (points.series % 2 == fold) & whole
            try:
                fitted = model.fit(training[np.arange(series) % 2 != fold], case)
            except ValueError:  # series too short, or nothing but noise
                break
            logs[here] = _log_errors(fitted, around[here], samples_of(training).std(axis=0))
        errors[window] = logs[whole]
    errors = {window: logs for window, logs in errors.items() if np.isfinite(logs).all()}
    if given not in errors:
        return
    best = min(errors, key=lambda window: float(errors[window].mean()))
    gain = errors[given] - errors[best]
    # points of a series are no independent witnesses: their means by series are
    rows = points.series[whole]
    means = np.array([gain[rows == row].mean() for row in np.unique(rows)])
    scatter = means.std(ddof=1) / np.sqrt(len(means)) if len(means) > 1 else np.inf
    if best != given and means.mean() > max(_WINDOW_GAIN, 2 * scatter):
        yield (
            f"equations learnt over windows of {best} sampling intervals forecast training series "
            f"that were left out with {10 ** -means.mean():.2g} times the mean square error of "
            f"those over {given}: try options={{'window_lt': {best / unit:.3g}}}"
        )


def _log_errors(forecaster: Forecaster, around: FloatArray, scale: FloatArray) -> FloatArray:
    """Log10 of the mean square error of forecasts from first samples, ``(points,)``, at most 0.3.

    ``around``: ``(points, 1 + steps, dimension)``. ``scale``: Unit of the errors.
    """
    batch = np.ascontiguousarray(around.transpose(1, 2, 0))
    with np.errstate(over="ignore", invalid="ignore"):
        outputs, _ = forecaster.advance(forecaster.start(batch[:1]), len(batch) - 1)
        square = np.square((outputs - batch[1:]) / scale[:, np.newaxis]).mean(axis=(0, 1))
    # two states that have nothing to do with each other are apart by twice the variance
    return np.asarray(np.log10(np.clip(np.nan_to_num(square, nan=2.0, posinf=2.0), 1e-12, 2.0)))


def diagnosed(symptoms: Sequence[str], found: Sequence[str]) -> list[str]:
    """Symptoms, and a sentence that names their causes; nothing without a symptom."""
    if not symptoms:
        return []
    if found:
        return [*symptoms, f"likely cause{'s' if len(found) > 1 else ''}: {'; '.join(found)}"]
    return [
        *symptoms,
        "no cause is seen in sampling, noise, windows or number of events: the observed components "
        "may hold too little about events so far ahead, or the kind does not suit them (compare "
        "analogues and esn, and a shorter prediction time)",
    ]

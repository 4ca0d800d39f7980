"""Check that a forecaster keeps to the interface: shapes, batches, no state between calls, records.

All checks are trials with noisy series of Lorenz's flow: only the class of the forecaster is
needed.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.discovery import UnsoundError
from burstcast.forecasters._event_classifier import EventClassifier, LabelledPoints
from burstcast.forecasters.base import Forecaster, ForecasterKind, ForecastingCase
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63

_INTERVAL, _STRIDE = 0.02, 2
_STEPS_PER_LYAPUNOV_TIME = 55
_SERIES, _SAMPLES, _WASHOUT = 8, 600, 28
_BATCH, _STEPS = 6, 12
_TOLERANCE = 1e-9
"""Relative difference between a forecast in a batch and the same forecast alone: rounding."""


def check_forecaster(unfitted: ForecasterKind, generator: np.random.Generator) -> str:
    """Report on a forecaster, after it has learnt from series of Lorenz's flow.

    ``unfitted``: The forecaster, or classifier, with its options. ``generator``: Of the initial
    conditions and the observation noise. Raises UnsoundError with all violations of the interface
    that were noticed.

    Examples
    --------
    >>> from burstcast.forecasters.nvar import NVAR
    >>> print(check_forecaster(NVAR(), np.random.default_rng(0)).splitlines()[0])
    NVAR(lags=2, ridge=1e-06): keeps to the interface
    """
    start = np.array([[1.0], [1.0], [20.0]]) + generator.normal(size=(3, _SERIES))
    states = integrate(Lorenz63(), start, _INTERVAL / _STRIDE, 1500 * _STRIDE, stride=_STRIDE)
    series = np.ascontiguousarray(states[-_SAMPLES:].transpose(2, 0, 1))
    series += 0.01 * generator.normal(size=series.shape)
    training, seen = series[:-1], series[-1]
    case = ForecastingCase(Lorenz63(), _INTERVAL / _STRIDE, _STRIDE, _STEPS_PER_LYAPUNOV_TIME)
    starts = np.linspace(0, _SAMPLES - _WASHOUT - _STEPS_PER_LYAPUNOV_TIME - 1, _BATCH, dtype=int)
    washouts = np.stack([seen[first : first + _WASHOUT] for first in starts])
    problems: list[str] = []
    if isinstance(unfitted, EventClassifier):
        points = _labelled(training, generator)
        fitted = _fitted(unfitted, lambda: unfitted.fit(points, case), points.washouts, problems)
        if fitted is not None:
            problems += _classifier_problems(unfitted, fitted, washouts, case)
        report: dict[str, str] = {"gives": "probabilities of events, without a trajectory"}
    elif isinstance(unfitted, Forecaster) and not unfitted.has_search:
        fitted = _fitted(unfitted, lambda: unfitted.fit(training, case), training, problems)
        batch = np.ascontiguousarray(washouts.transpose(1, 2, 0))
        if fitted is not None:
            problems += _forecaster_problems(unfitted, fitted, batch, case)
        truth = [seen[first + _WASHOUT :][:_STEPS_PER_LYAPUNOV_TIME] for first in starts]
        report = {"gives": "trajectories"}
        if not problems and fitted is not None:
            report |= _skill(fitted, batch, np.stack(truth, axis=2), seen.std(axis=0))
    else:
        kind = type(unfitted).__name__
        raise UnsoundError([f"{kind} has a search of its own, which is not tried here"])
    if problems:
        raise UnsoundError(problems)
    assert fitted is not None
    arrays = {name: array.shape for name, array in fitted.record().arrays.items()}
    report["saved arrays"] = (
        ", ".join(f"{name} {shape}" for name, shape in arrays.items()) or "none"
    )
    lines = [f"  {name:20s} {text}\n" for name, text in report.items()]
    return f"{unfitted!r}: keeps to the interface\n{''.join(lines)}"


def _labelled(training: FloatArray, generator: np.random.Generator) -> LabelledPoints:
    """Points of the series, with events in two windows: a large third component soon, or later."""
    spots = [
        (row, step)
        for row in range(len(training))
        for step in range(_WASHOUT, _SAMPLES - _STEPS_PER_LYAPUNOV_TIME, 10)
    ]
    washouts = np.stack([training[row, step - _WASHOUT : step] for row, step in spots])
    happened = [
        [training[row, step + first :][:20, 2].max() > 35.0 for first in (0, 20)]
        for row, step in spots
    ]
    return LabelledPoints(washouts, np.array(happened), np.array([row for row, _ in spots]))


def _fitted(
    unfitted: Any, fit: Callable[[], Any], learnt: FloatArray, problems: list[str]
) -> Any | None:
    """What `fit` returns; None where it fails, with the reason among the problems."""
    before = learnt.copy()
    try:
        fitted = fit()
    except Exception as error:  # whatever the forecaster raises
        problems.append(f"fit fails for series {learnt.shape}: {type(error).__name__}: {error}")
        return None
    if type(fitted) is not type(unfitted):
        problems.append(f"fit returns {type(fitted).__name__}, not {type(unfitted).__name__}")
        return None
    if not np.array_equal(learnt, before):
        problems.append("fit changes the series that it is given")
    if fitted.options != unfitted.options:
        problems.append("fit returns a forecaster with other options")
    return fitted


def _forecaster_problems(
    unfitted: Forecaster, fitted: Forecaster, washout: FloatArray, case: ForecastingCase
) -> Iterator[str]:
    """Violations by a fitted forecaster of trajectories, after washouts (steps, 3, batch)."""
    dimension, before = washout.shape[1], washout.copy()

    def forecast(forecaster: Forecaster, columns: slice = slice(None)) -> FloatArray:
        some = np.ascontiguousarray(washout[..., columns])
        return np.asarray(forecaster.advance(forecaster.start(some), _STEPS)[0])

    try:
        memory = fitted.start(washout)
        outputs, later = fitted.advance(memory, _STEPS)
        ensemble = fitted.ensemble(washout)
    except Exception as error:  # whatever the forecaster raises
        yield f"a forecast fails: {type(error).__name__}: {error}"
        return
    if memory.shape[-1] != _BATCH or later.shape != memory.shape:
        yield (
            f"memories of {_BATCH} washouts have the shapes {memory.shape} and, after a forecast, "
            f"{later.shape}: the last axis is the batch, and both are equal"
        )
        return
    expected = (_STEPS, dimension, _BATCH)
    if outputs.shape != expected or outputs.dtype != np.float64:
        yield (
            f"advance returns states {outputs.shape} of type {outputs.dtype}, not {expected} of "
            "type float64: (steps, dimension, batch)"
        )
        return
    if not np.array_equal(washout, before):
        yield "start changes the washout that it is given"
    yield from _memory_problems(fitted, memory, outputs)
    alone = np.concatenate([forecast(fitted, slice(n, n + 1)) for n in range(_BATCH)], axis=2)
    if not np.allclose(alone[0], outputs[0], rtol=_TOLERANCE, atol=_TOLERANCE, equal_nan=True):
        yield "a forecast in a batch differs from the same forecast alone"
    members = ensemble.shape[-2] if ensemble.ndim > 1 else 0
    if ensemble.shape[-1] != _BATCH or (members > 1) != fitted.provides_ensemble:
        yield (
            f"ensemble returns the shape {ensemble.shape}: (..., members, batch), with several "
            "members where provides_ensemble is true"
        )
    elif not np.array_equal(fitted.combined(ensemble), memory, equal_nan=True):
        yield "combined(ensemble(washout)) differs from start(washout)"
    yield from _record_problems(unfitted, fitted, case, forecast)


def _memory_problems(fitted: Forecaster, memory: FloatArray, outputs: FloatArray) -> Iterator[str]:
    """Violations by forecasts in parts, again, and of the memory that is given."""
    kept, half = memory.copy(), _STEPS // 2
    if not np.array_equal(fitted.advance(memory, _STEPS)[0], outputs, equal_nan=True):
        yield "the same forecast twice gives other states: there is a state between calls"
        return
    if not np.array_equal(memory, kept, equal_nan=True):
        yield "advance changes the memory that it is given"
        return
    first, memory = fitted.advance(memory, half)
    second, _ = fitted.advance(memory, _STEPS - half)
    if not np.array_equal(np.concatenate([first, second]), outputs, equal_nan=True):
        yield "a forecast in two parts differs from the same forecast at once"


def _classifier_problems(
    unfitted: EventClassifier, fitted: EventClassifier, washouts: FloatArray, case: ForecastingCase
) -> Iterator[str]:
    """Violations by a fitted classifier, after washouts ``(points, steps, 3)``."""
    before = washouts.copy()
    try:
        probabilities = np.asarray(fitted.probabilities(washouts))
    except Exception as error:  # whatever the classifier raises
        yield f"probabilities fails: {type(error).__name__}: {error}"
        return
    if probabilities.shape != (_BATCH, 2):
        yield (
            f"probabilities returns the shape {probabilities.shape}, not (points, windows) "
            f"{(_BATCH, 2)}"
        )
        return
    if not ((probabilities >= 0) & (probabilities <= 1)).all():
        yield "probabilities are not between 0 and 1"
    if not np.array_equal(washouts, before):
        yield "probabilities changes the washouts that it is given"
    alone = np.concatenate([fitted.probabilities(washouts[[n]]) for n in range(_BATCH)])
    if not np.allclose(alone, probabilities, rtol=_TOLERANCE, atol=_TOLERANCE):
        yield "a probability in a batch differs from the same probability alone"
    yield from _record_problems(
        unfitted, fitted, case, lambda classifier: classifier.probabilities(washouts)
    )


def _record_problems(
    unfitted: Any, fitted: Any, case: ForecastingCase, result: Callable[[Any], FloatArray]
) -> Iterator[str]:
    """Violations by the record of what was fitted."""
    try:
        restored = unfitted.restore(fitted.record(), case)
        if not np.array_equal(result(restored), result(fitted), equal_nan=True):
            yield "a forecaster restored from its record forecasts otherwise"
    except Exception as error:  # whatever the forecaster raises
        yield f"what is fitted cannot be saved and restored: {type(error).__name__}: {error}"


def _skill(
    fitted: Forecaster, washout: FloatArray, truth: FloatArray, scale: FloatArray
) -> dict[str, str]:
    """Error after one Lyapunov time, and of persistence; ``truth`` is ``(steps, 3, batch)``."""
    outputs = fitted.advance(fitted.start(washout), len(truth))[0]

    def error(states: FloatArray) -> str:
        apart = (states - truth[-1]) / scale[:, np.newaxis]
        return f"{np.sqrt(np.median((apart**2).mean(axis=0))):.2g}"

    of_persistence = error(washout[-1])
    return {
        "error after 1 LT": f"{error(outputs[-1])} standard deviations on Lorenz's flow "
        f"(persistence: {of_persistence})"
    }

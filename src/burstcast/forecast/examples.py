"""Single forecasts worth looking at: one of each outcome, and the last ones before a success."""

from dataclasses import dataclass

import numpy as np

from burstcast.forecast.windows import WindowSummaries, crosses
from burstcast.systems.base import FloatArray

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
    false positive) has the median height in the window: neither the tallest nor a marginal one.

    Parameters
    ----------
    forecast, truth, washout_maximum, first_window, windows, threshold
        As in `burstcast.forecast.classification.score_forecasts`.

    Returns
    -------
    Rows of the points, by outcome.
    """
    span = slice(first_window, first_window + windows)
    predicted = crosses(forecast, first_window, windows, threshold)
    happened = crosses(truth, first_window, windows, threshold)
    scored = washout_maximum < threshold
    heights = {
        "true positive": (predicted & happened, truth),
        "false positive": (predicted & ~happened, forecast),
        "false negative": (~predicted & happened, truth),
    }
    examples = {}
    for outcome in OUTCOMES:
        matches, summaries = heights[outcome]
        points = np.flatnonzero(matches & scored)
        if points.size:
            height = summaries.largest[points, span].max(axis=1)
            examples[outcome] = int(points[np.argsort(height, kind="stable")[points.size // 2]])
    return examples


@dataclass(frozen=True)
class HorizonExample:
    """An event and the starts from which it was last forecast in vain, then with success.

    Attributes
    ----------
    event
        Row of the event.
    starts_lt
        tau_e of the last evaluations, the successful one at the end.
    """

    event: int
    starts_lt: tuple[float, ...]


def horizon_example(
    horizons: FloatArray, starts_lt: list[float], wanted_lt: float, evaluations: int = 4
) -> HorizonExample | None:
    """Event whose prediction horizon lies nearest to the wanted one, with its last evaluations.

    Parameters
    ----------
    horizons
        PH_ee of the events in Lyapunov times, ``(events,)``.
    starts_lt
        All tau_e in the order of the search.
    wanted_lt
        Wanted horizon.
    evaluations
        Evaluations to show; fewer where the search ended sooner.

    Returns
    -------
    None where no event was predicted from any start.
    """
    # an event that every start has failed on has a horizon below the shortest start
    match = np.isclose(horizons[:, np.newaxis], np.asarray(starts_lt))
    success = np.where(match.any(axis=1), match.argmax(axis=1), -1)
    usable = np.flatnonzero(success >= evaluations - 1)
    if usable.size == 0:
        usable = np.flatnonzero(success >= 0)
    if usable.size == 0:
        return None
    event = int(usable[np.argmin(np.abs(horizons[usable] - wanted_lt))])
    last = int(success[event])
    return HorizonExample(event, tuple(starts_lt[max(0, last - evaluations + 1) : last + 1]))

"""Alarms from probabilities: raised where the probability reaches a threshold."""

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.forecasts.classification import ContingencyTable, ratio
from burstcast.forecasts.outcomes import Outcomes


def counts_at(outcomes: Outcomes, threshold: float) -> ContingencyTable:
    """Counts of alarms, raised where the forecast is at or above the threshold."""
    alarm = outcomes.levels >= threshold
    points, events = outcomes.points, outcomes.events
    quiet = points - events
    return ContingencyTable(
        true_positive=events[..., alarm].sum(axis=-1),
        false_positive=quiet[..., alarm].sum(axis=-1),
        false_negative=events[..., ~alarm].sum(axis=-1),
        true_negative=quiet[..., ~alarm].sum(axis=-1),
    )


def best_threshold(probabilities: FloatArray, points: IntArray) -> float:
    """Threshold whose alarms have the largest F-score that probabilities let expect.

    Of n forecasts of the probability p, n p are expected to come true, so that alarms from a level
    on have the F-score 2 sum_alarms(n p) / (sum_alarms(n) + sum(n p)) (Lewis, SIGIR 1995). The
    threshold is the middle between the level from which alarms are raised and the next lower one;
    of equally good ones it is the highest. It is 0 where alarms are raised always, and 1 where no
    event is expected at all.

    ``probabilities``, ``points``: Levels, rising, and forecasts of each, ``(levels,)``.
    """
    expected = points * probabilities
    whole = float(expected.sum())
    if whole == 0:
        return 1.0
    hits, raised = np.cumsum(expected[::-1]), np.cumsum(points[::-1])
    level = probabilities.size - 1 - int(np.argmax(2 * hits / (raised + whole)))
    if level == 0:
        return 0.0
    return float(probabilities[level - 1] + probabilities[level]) / 2


def useless_votes(outcomes: Outcomes) -> str:
    """Reason why votes carry no information about events; empty if they do.

    It is that the area below the receiver operating characteristic is within two standard errors of
    a half (Mann & Whitney, Ann. Math. Stat. 18, 1947), as if all points were independent.
    """
    events, points = int(outcomes.events.sum()), int(outcomes.points.sum())
    quiet = points - events
    if not events or not quiet:
        return f"an event follows {events} of {points} starting points: there is nothing to learn"
    area = float(roc_area(outcomes))
    error = float(np.sqrt((points + 1) / (12 * events * quiet)))
    if area > 0.5 + 2 * error:
        return ""
    return (
        f"votes do not tell the {events} starting points that an event follows from the {quiet} "
        f"others (area below the ROC curve {area:.2f}, chance 0.50 +- {error:.2f}): alarms are no "
        f"better than chance"
    )


def roc_area(outcomes: Outcomes) -> FloatArray:
    """Area below the receiver operating characteristic; NaN where all outcomes are alike.

    The probability that an event had a larger forecast than a quiet point, ties counting half.
    """
    quiet = outcomes.points - outcomes.events
    below = np.cumsum(quiet, axis=-1) - 0.5 * quiet
    pairs = outcomes.events.sum(axis=-1) * quiet.sum(axis=-1)
    return ratio((outcomes.events * below).sum(axis=-1), pairs)


def average_precision(outcomes: Outcomes) -> FloatArray:
    """Area below the precision-recall curve, in steps; NaN without events."""
    # alarms with each level as the threshold, from the highest
    gained, raised = outcomes.events[..., ::-1], outcomes.points[..., ::-1].cumsum(axis=-1)
    precision = np.nan_to_num(ratio(gained.cumsum(axis=-1), raised))
    return ratio((gained * precision).sum(axis=-1), outcomes.events.sum(axis=-1))

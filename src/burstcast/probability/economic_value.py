"""The relative economic value of probability forecasts in the cost-loss model.

A user may protect at a cost C, and has a loss L if an event hits unprotected. Knowing the
probability p, the user protects where p >= C / L. Source: Richardson, "Skill and relative economic
value of the ECMWF ensemble prediction system", Quarterly Journal of the Royal Meteorological
Society 126 (2000).
"""

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.forecast.classification import ratio
from burstcast.probability.alarms import counts_at
from burstcast.probability.brier import base_rate
from burstcast.probability.outcomes import Outcomes


def economic_value(outcomes: Outcomes, cost_loss_ratio: float) -> FloatArray:
    """Savings by forecasts as a share of the savings by perfect forecasts, against climatology.

    The mean expense, in units of L, is C/L for each protection and 1 for each event missed;
    climatology protects always or never, whichever costs less.

    Returns 1: perfect; 0: no better than climatology; negative: worse. NaN where all outcomes are
    alike.
    """
    counts, rate = counts_at(outcomes, cost_loss_ratio), base_rate(outcomes)
    protections = counts.true_positive + counts.false_positive
    expense = ratio(
        cost_loss_ratio * protections + counts.false_negative, outcomes.points.sum(axis=-1)
    )
    climatology = np.minimum(cost_loss_ratio, rate)
    return ratio(climatology - expense, climatology - cost_loss_ratio * rate)

"""Prediction horizon of extreme events, PH_ee.

Source: section "Prediction horizon of extreme events" of the paper.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.exogenous import up_to_sample
from burstcast.forecasters.base import Forecaster

STEPS_BETWEEN_CHECKS = 16
"""Forecast steps between two checks of the tolerance: changes no result."""

EVENTS_PER_BATCH = 512
"""Forecasts that run side by side: bounds the memory, changes no result."""


@dataclass(frozen=True)
class HorizonSearch:
    """Settings of the search for the prediction horizon of an event."""

    #: first tau_e: the forecast starts this long before the event, in Lyapunov times
    longest_lead_time_lt: float
    lead_time_step_lt: float  #: decrease of tau_e after each forecast that fails
    #: errors of an accurate forecast are below this, in the observable's units: 0.2 (k_e - mean k)
    #: in the paper
    largest_error: float
    washout: int  #: inputs of the washout; the last one is the starting point itself
    steps_per_lyapunov_time: int  #: steps of a forecast in a Lyapunov time

    def __post_init__(self) -> None:
        if not self.largest_error > 0:
            raise ValueError(
                f"the tolerance of the prediction horizon must be positive, not "
                f"{self.largest_error}: "
                f"the event threshold must exceed the mean of the observable"
            )
        if not 0 < self.lead_time_step_lt <= self.longest_lead_time_lt:
            raise ValueError(
                f"the lead time must decrease by a step in (0, {self.longest_lead_time_lt}], the "
                f"longest lead time, not by {self.lead_time_step_lt} Lyapunov times"
            )
        if not self.lead_times_lt:
            raise ValueError(
                f"the longest lead time, {self.longest_lead_time_lt} Lyapunov times, is shorter "
                f"than a step of the network: a Lyapunov time has {self.steps_per_lyapunov_time}"
            )

    @property
    def lead_times_lt(self) -> list[float]:
        """All tau_e in the order in which they are tried, in Lyapunov times."""
        # down to the last one that is positive
        count = math.ceil(self.longest_lead_time_lt / self.lead_time_step_lt - 1e-9)
        starts = [
            self.longest_lead_time_lt - index * self.lead_time_step_lt for index in range(count)
        ]
        # a start less than a step before the event leaves nothing to forecast
        return [start for start in starts if self.steps(start) > 0]

    def steps(self, duration_lt: float) -> int:
        """Steps of a forecast in a duration of Lyapunov times, rounded down."""
        return durations.steps(duration_lt, self.steps_per_lyapunov_time)

    @property
    def steps_before_event(self) -> int:
        """Steps before an event that the search uses: the longest lead time and the washout."""
        return self.steps(self.longest_lead_time_lt) + self.washout - 1


@np.errstate(over="ignore", invalid="ignore")
def accurate_steps(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    truth: FloatArray,
    tolerance: float,
) -> IntArray:
    """Steps during which each forecast stays within the tolerance of the truth (paper, eq. 11).

    ``washouts``: ``(steps, dimension, batch)``. ``truth``: True observable from one step after the
    starting point, ``(steps, batch)``. ``tolerance``: Error that counts as lost, in the
    observable's units. Returns accurate steps, ``(batch,)``; all the steps of ``truth`` where the
    forecast never leaves it.
    """
    steps, batch = truth.shape
    accurate = np.full(batch, steps, dtype=np.int64)
    running = np.arange(batch)
    memory = forecaster.start(washouts)
    for start in range(0, steps, STEPS_BETWEEN_CHECKS):
        chunk = min(STEPS_BETWEEN_CHECKS, steps - start)
        outputs, memory = forecaster.advance(memory, chunk)
        outputs = forecaster.valid(outputs)
        error = np.abs(
            observable(outputs.transpose(1, 0, 2)) - truth[start : start + chunk, running]
        )
        # a forecast that is invalid has left the tolerance, too
        lost = ~(error < tolerance)
        failed = lost.any(axis=0)
        accurate[running[failed]] = start + lost[:, failed].argmax(axis=0)
        if failed.any():
            running = running[~failed]
            memory = np.ascontiguousarray(memory[..., ~failed])
        if running.size == 0:
            break
    return accurate


def prediction_horizons(
    forecaster: Forecaster,
    observable: Callable[[FloatArray], FloatArray],
    observed: FloatArray,
    truth: FloatArray,
    search: HorizonSearch,
    inputs: int = 0,
) -> FloatArray:
    """PH_ee of each event, in Lyapunov times, ``(events,)``.

    The forecast starts tau_e before the event. If it stays within the tolerance up to the event,
    PH_ee is tau_e; if not, tau_e is shortened and the forecast repeated. If even the shortest tau_e
    fails, PH_ee is the time for which that forecast is accurate.

    ``observed``: Observed states up to the event, ``(events, search.steps_before_event + 1,
    dimension + inputs)``. ``truth``: True observable of the same steps, ``(events,
    search.steps_before_event + 1)``. ``inputs``: Number of exogenous inputs of the forecaster,
    which are the last components of the observed states. Returns prediction horizons in Lyapunov
    times, ``(events,)``.
    """
    if observed.shape[1] != search.steps_before_event + 1 or truth.shape != observed.shape[:2]:
        raise ValueError("the segments before the events do not fit the search for the horizon")
    horizons = np.full(len(truth), np.nan)
    event = observed.shape[1] - 1
    undecided = np.arange(len(truth))
    for lead_time_lt in search.lead_times_lt:
        if undecided.size == 0:
            break
        start = event - search.steps(lead_time_lt)
        accurate = np.empty(len(undecided), dtype=np.int64)
        for first in range(0, len(undecided), EVENTS_PER_BATCH):
            batch = slice(first, first + EVENTS_PER_BATCH)
            rows, steps = undecided[batch], search.washout
            washouts = up_to_sample(observed[rows, start - steps + 1 :], steps, inputs)
            accurate[batch] = accurate_steps(
                forecaster,
                observable,
                np.ascontiguousarray(washouts.transpose(1, 2, 0)),
                np.ascontiguousarray(truth[rows, start + 1 :].T),
                search.largest_error,
            )
        horizons[undecided] = accurate / search.steps_per_lyapunov_time
        predicted = accurate == event - start
        horizons[undecided[predicted]] = lead_time_lt
        undecided = undecided[~predicted]
    return horizons


def resampled_averages(horizons_lt: FloatArray, weights: IntArray) -> tuple[FloatArray, FloatArray]:
    """Mean and median horizon of each bootstrap sample of events, ``(resamples,)`` each.

    ``weights``: How often each event is in each sample, ``(resamples, events)``.
    """
    if horizons_lt.size == 0:
        return np.empty(0), np.empty(0)
    order = np.argsort(horizons_lt, kind="stable")
    ordered, count = horizons_lt[order], int(weights[0].sum())
    reached = np.cumsum(weights[:, order], axis=1)
    # the two in the middle of the sample, which are one if their number is odd
    middle = [ordered[(reached > rank).argmax(axis=1)] for rank in ((count - 1) // 2, count // 2)]
    return (weights * horizons_lt).sum(axis=1) / count, 0.5 * (middle[0] + middle[1])

"""The monitor that asks all members of an ensemble: an alarm where enough of them forecast one."""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.vote import VoteMonitor
from burstcast.probability.members import EnsembleForecaster

FLOWS_PER_CALL = 64
"""Flows whose members forecast side by side: bounds the memory, changes no result."""


@dataclass(frozen=True)
class MemberForecasts:
    """The members of an ensemble side by side, asked by monitors like a forecaster.

    Attributes
    ----------
    forecaster
        Whose ensemble it is.
    """

    forecaster: EnsembleForecaster

    def start(self, washout: FloatArray) -> FloatArray:
        """Memories of all members after an observed washout, ``(..., members * batch)``."""
        memory = self.forecaster.ensemble(washout)
        *rest, members, batch = memory.shape
        return np.ascontiguousarray(memory.reshape(*rest, members * batch))

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Forecast with each (`burstcast.forecasters.base.Forecaster.advance`)."""
        return self.forecaster.advance(memory, steps)


@dataclass(frozen=True)
class _Raised(Monitor):
    """Alarms that were raised already, ``(batch,)``."""

    raised: BoolArray

    def alarms(self, rows: IntArray, forecast_number: IntArray, washout: FloatArray) -> BoolArray:
        """Repeat them (see `Monitor.alarms`)."""
        return self.raised


@dataclass(frozen=True)
class MembersMonitor(Monitor):
    """Raises an alarm if a share of an ensemble's members does: the alarm probability of a filter.

    Attributes
    ----------
    monitor
        Of `MemberForecasts`: raises alarms of all members of all flows.
    share
        Of the members, as of `VoteMonitor`.
    """

    monitor: Monitor
    share: float

    def alarms(self, rows: IntArray, forecast_number: IntArray, washout: FloatArray) -> BoolArray:
        """Count the members' alarms (see `Monitor.alarms`)."""
        raised = np.zeros(len(rows), dtype=bool)
        for start in range(0, len(rows), FLOWS_PER_CALL):
            flows = slice(start, start + FLOWS_PER_CALL)
            given = rows[flows], forecast_number[flows], washout[:, :, flows]
            members = self.monitor.alarms(*given).reshape(-1, len(rows[flows]))
            raised[flows] = VoteMonitor([_Raised(one) for one in members], self.share).alarms(
                *given
            )
        return raised

"""Monitor by the members of an ensemble: an alarm where enough members forecast an event."""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.vote import check_share, enough
from burstcast.forecast.window_forecasts import side_by_side
from burstcast.forecasters.base import Forecaster

FLOWS_PER_CALL = 64
"""Flows whose members forecast side by side: bounds the memory, changes no result."""


@dataclass(frozen=True)
class MemberForecasts:
    """The members of an ensemble side by side, asked by monitors like a forecaster.

    Attributes
    ----------
    forecaster
        Forecaster that provides the ensemble.
    """

    forecaster: Forecaster

    @property
    def aware(self) -> bool:
        """Whether it uses schedules of parameters."""
        return self.forecaster.aware

    def start(self, washout: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        """Memories of all members after an observed washout, ``(..., members * batch)``."""
        return side_by_side(self.forecaster.ensemble(washout, parameters))

    def advance(
        self, memory: FloatArray, steps: int, parameters: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Forecast with each (`burstcast.forecasters.base.Forecaster.advance`)."""
        return self.forecaster.advance(memory, steps, parameters)


@dataclass(frozen=True)
class MembersMonitor(Monitor):
    """Raises an alarm if a share of an ensemble's members does: the alarm probability of a filter.

    Attributes
    ----------
    monitor
        Monitor of `MemberForecasts`: raises alarms of all members of all flows.
    share
        Share of the members, as of `burstcast.control.monitors.vote.VoteMonitor`.
    """

    monitor: Monitor
    share: float

    def __post_init__(self) -> None:
        """Raise ValueError if the share is not in (0, 1]."""
        check_share(self.share)

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Count the members' alarms (see `Monitor.alarms`)."""
        raised = np.zeros(len(rows), dtype=bool)
        for start in range(0, len(rows), FLOWS_PER_CALL):
            flows = slice(start, start + FLOWS_PER_CALL)
            known = None if acting is None else acting[:, flows]
            given = rows[flows], forecast_number[flows], washout[:, :, flows], known
            members = self.monitor.alarms(*given).reshape(-1, len(rows[flows]))
            raised[flows] = enough(members.sum(axis=0), len(members), self.share)
        return raised

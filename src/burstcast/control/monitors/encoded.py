"""The monitor of an encoded flow: it sees the channels that an encoder makes of observations."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.monitors.base import Decision, Monitor


@dataclass(frozen=True)
class EncodedMonitor(Monitor):
    """Encodes what is observed, with its noise, for another monitor.

    Attributes
    ----------
    monitor
        Receives the channels.
    encode
        Function from observations ``(observed, ...)`` to channels ``(channel, ...)``.
    """

    monitor: Monitor
    encode: Callable[[FloatArray], FloatArray]

    @property
    def plans(self) -> bool:  # type: ignore[override]  # of other monitors a class variable
        """Whether decisions of the other monitor have a plan."""
        return self.monitor.plans

    def decide(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> Decision:
        """Decide as the other monitor does (see `Monitor.decide`)."""
        return self.monitor.decide(rows, forecast_number, self._channels(washout), acting)

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Raise the alarms of the other monitor (see `Monitor.alarms`)."""
        return self.monitor.alarms(rows, forecast_number, self._channels(washout), acting)

    def _channels(self, washout: FloatArray) -> FloatArray:
        encoded = self.encode(np.ascontiguousarray(washout.transpose(1, 0, 2)))
        return np.ascontiguousarray(encoded.transpose(1, 0, 2))

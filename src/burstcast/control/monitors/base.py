"""Who watches the flow: the interface of a monitor, which raises alarms from what was observed.

Source: section "Control of extreme events" of the paper.
"""

import abc

from burstcast.arrays import BoolArray, FloatArray, IntArray


class Monitor(abc.ABC):
    """Raises alarms in many flows at once, in each independently of the others."""

    @abc.abstractmethod
    def alarms(self, rows: IntArray, forecast_number: IntArray, washout: FloatArray) -> BoolArray:
        """Whether an event is expected in the window.

        Parameters
        ----------
        rows
            Which flows they are, ``(batch,)``.
        forecast_number
            Number of the forecast in each of them, from 0, ``(batch,)``.
        washout
            Observed states up to and including now, ``(steps, dimension, batch)``.

        Returns
        -------
        ``(batch,)``.
        """

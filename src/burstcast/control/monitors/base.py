"""The interface of a monitor, which raises alarms from observations of a flow.

Source: section "Control of extreme events" of the paper.
"""

import abc
from dataclasses import dataclass
from typing import ClassVar

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray


@dataclass(frozen=True)
class Decision:
    """Decision of a monitor: alarms and actuation.

    Attributes
    ----------
    alarm
        Whether it raises an alarm, ``(batch,)``.
    plan
        Actuation during each of the coming steps, what is on its way already included: 0 is none, 1
        the actuation, 2 the reversed one, ``(steps, batch)``; None: the monitor does not plan.
    reverse
        Whether an alarm sets off the reversed actuation, ``(batch,)``; None: it never does.
    """

    alarm: BoolArray
    plan: ByteArray | None = None
    reverse: BoolArray | None = None


class Monitor(abc.ABC):
    """Raises alarms in many flows at once, in each independently of the others."""

    plans: ClassVar[bool] = False
    """Whether its decisions have a plan."""

    def decide(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> Decision:
        """Decide on the actuation; by default a monitor only raises alarms.

        Parameters
        ----------
        rows, forecast_number, washout, acting
            As in `alarms`.
        """
        return Decision(self.alarms(rows, forecast_number, washout, acting))

    @abc.abstractmethod
    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Whether an event is expected in the window.

        Parameters
        ----------
        rows
            Which flows they are, ``(batch,)``.
        forecast_number
            Number of the forecast in each of them, from 0, ``(batch,)``.
        washout
            Observed states up to and including now, ``(steps, dimension, batch)``.
        acting
            Actuation from each of them to the next, and, after those, during the steps before this
            decision takes effect, ``(steps - 1 + delay, batch)``: 0 is none, 1 the actuation, 2 the
            reversed one; None: unknown.

        Returns
        -------
        ``(batch,)``.
        """

"""The monitor that plans: it forecasts a family of action sequences and takes the cheapest."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.actuation import REVERSED, ActuationValues
from burstcast.control.monitors.base import Decision, Monitor
from burstcast.control.monitors.horizon import told_memory
from burstcast.forecasters.base import Forecaster

TRAJECTORIES_PER_CALL = 2048
"""Forecasts that run side by side: bounds the memory, changes no result."""


@dataclass(frozen=True)
class PlannedMonitor(Monitor):
    """Raises an alarm if the best plan has the actuator on as soon as the decision takes effect.

    If the forecast without any further actuation stays below a level up to the horizon, nothing is
    planned. Otherwise each plan is forecast. Of those whose forecast stays below the level, the
    cheapest is the best, that with the fewest steps on; of equally cheap ones, that with the lowest
    peak. If none does, the best is that with the fewest steps at or above the level, then with the
    lowest peak, then the cheapest. The next decision plans anew.

    A forecast under a plan that leaves the finite numbers counts as being above the level.

    Attributes
    ----------
    forecaster
        Forecaster that knows the parameters.
    observable
        Function from states ``(dimension, ...)`` to the observable ``(...)``.
    level
        Level of the observable: the event threshold less a margin.
    values
        Values of the parameters with the actuator off and on.
    sequences
        Plans: the actuation of each, step by step from the effect of the decision to the horizon,
        ``(plans, steps)``: 0 is none, 1 the actuation, 2 the reversed one.
    """

    plans: ClassVar[bool] = True

    forecaster: Forecaster
    observable: Callable[[FloatArray], FloatArray]
    level: float
    values: ActuationValues
    sequences: ByteArray

    def alarms(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> BoolArray:
        """Act if the best plan does at once (see `Monitor.alarms`)."""
        return self.decide(rows, forecast_number, washout, acting).alarm

    def decide(
        self,
        rows: IntArray,
        forecast_number: IntArray,
        washout: FloatArray,
        acting: ByteArray | None = None,
    ) -> Decision:
        """Choose a plan for each trajectory of the forecaster's batch (see `Monitor.decide`)."""
        memory, delay = told_memory(self.forecaster, washout, acting, self.values)
        assert acting is not None
        batch, steps = memory.shape[-1], self.sequences.shape[1]
        chosen = np.zeros((steps, batch), dtype=np.uint8)
        without = self._forecast(memory, chosen)
        acts = np.flatnonzero((np.isfinite(without) & (without >= self.level)).any(axis=0))
        at_once = max(1, TRAJECTORIES_PER_CALL // len(self.sequences))
        for start in range(0, len(acts), at_once):
            some = acts[start : start + at_once]
            chosen[:, some] = self.sequences[self._best(memory[..., some])].T
        pending = np.tile(acting[len(washout) - 1 :], (1, batch // washout.shape[-1]))
        assert len(pending) == delay
        plan = np.concatenate([pending, chosen])
        reverse = chosen[0] == REVERSED if (self.sequences == REVERSED).any() else None
        return Decision(chosen[0] != 0, plan, reverse)

    def _best(self, memory: FloatArray) -> IntArray:
        """Number of the best plan of each trajectory, ``(batch,)``."""
        number, batch = len(self.sequences), memory.shape[-1]
        side_by_side = np.ascontiguousarray(np.tile(memory, number))
        plans = np.repeat(self.sequences, batch, axis=0).T
        forecast = self._forecast(side_by_side, plans).reshape(-1, number, batch)
        height = np.where(np.isfinite(forecast), forecast, np.inf)
        above, peak = (height >= self.level).sum(axis=0), height.max(axis=0)
        steps_on = (self.sequences != 0).sum(axis=1)
        cost = np.broadcast_to(steps_on[:, np.newaxis], above.shape)
        # among sufficient plans the cheapest goes first; the others are ordered by the steps
        # above the level
        first = np.where(above == 0, cost, above)
        order = np.lexsort((cost, peak, first, above > 0), axis=0)
        return np.asarray(order[0], dtype=np.int64)

    @np.errstate(over="ignore", invalid="ignore")
    def _forecast(self, memory: FloatArray, acting: ByteArray) -> FloatArray:
        """Observable under an actuation ``(steps, batch)``, of the same shape."""
        outputs, _ = self.forecaster.advance(
            memory, len(acting), self.values.schedule(np.ascontiguousarray(acting))
        )
        return self.observable(outputs.transpose(1, 0, 2))

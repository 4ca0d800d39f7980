"""Planned control: forecast the effect of several actuations, and take the cheapest.

Model-predictive control (e.g. Rawlings, Mayne & Diehl, "Model Predictive Control", 2017) with an
actuator that is on or off: the optimisation is a search through a list of plans. Plans have the
actuator on once, from one of several starts and for one of several durations.

If the forecast without any further actuation stays below a level up to the horizon, nothing is
planned. Otherwise each plan is forecast. Of those whose forecast stays below the level, the
cheapest is the best, that with the fewest steps on; of equally cheap ones, that with the lowest
peak. If none does, the best is that with the fewest steps at or above the level, then with the
lowest peak, then the cheapest. It acts if the best plan does as soon as the decision takes effect;
the next decision plans anew. Where the forecast without any further actuation is invalid, the
fallback decides; an invalid forecast under a plan counts as being above the level.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base.arrays import BoolArray, ByteArray, FloatArray
from burstcast.base.exogenous import carry
from burstcast.control.actuation import REVERSED, ActuationValues
from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import Fallback, Look, Policy, informed_memory, is_invalid
from burstcast.control.strategies.base import ForesightedStrategy
from burstcast.control.timing import Schedule
from burstcast.systems.state_space import StateSpace

TRAJECTORIES_PER_CALL = 2048
"""Forecasts that run side by side: bounds the memory, changes no result."""


@dataclass(frozen=True)
class Planned(ForesightedStrategy):
    """Forecasts plans, begins with the best one, and plans anew at each decision.

    Of several forecasters, each plans for itself.
    """

    #: whether each plan is forecast with the reversed force, too
    reversible: bool = False
    #: starts of the actuation after the effect of a decision, in Lyapunov times; 0 among them, or
    #: it never acts
    starts_lt: tuple[float, ...] = (0.0, 0.25, 0.5, 1.0)
    #: durations of the actuation, in Lyapunov times; one step at least
    durations_lt: tuple[float, ...] = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)

    @property
    def informed(self) -> bool:
        """Forecasters receive the actuation."""
        return True

    def plans(self, schedule: Schedule) -> BoolArray:
        """Whether the actuator is on at each step from the effect of a decision to the horizon.

        ``(plans, steps)``, no two alike, for all pairs of starts and durations.
        """
        steps = self.horizon(schedule) - schedule.steps(schedule.delay_lt)
        starts = [schedule.steps(start) for start in self.starts_lt]
        lengths = [schedule.steps(duration) for duration in self.durations_lt]
        if 0 not in starts:
            raise ValueError(f"no plan acts at once: starts_lt is {list(self.starts_lt)}")
        if not lengths or min(lengths) < 1:
            raise ValueError(
                f"an actuation lasts no step: durations_lt is {list(self.durations_lt)}"
            )
        if max(lengths) > steps or max(starts) >= steps:
            raise ValueError(
                f"plans are longer than the horizon: {self.horizon_lt} Lyapunov times less a delay "
                f"of {schedule.delay_lt}, but durations_lt is {list(self.durations_lt)} and "
                f"starts_lt is {list(self.starts_lt)}"
            )
        return pulses(starts, lengths, steps)

    def check(self, schedule: Schedule) -> None:
        """Check that forecasts look beyond a decision's effect, and plans end within them."""
        super().check(schedule)
        self.plans(schedule)

    def check_system(self, system: StateSpace, reversible: bool) -> None:
        """Check that a force is there to be reversed."""
        if self.reversible and not reversible:
            raise ValueError("plans cannot be reversible: only a force can be reversed")

    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        """Act where the best plan acts at once."""
        self.check(experiment.schedule)
        self.check_system(experiment.system, experiment.reversed_system is not None)
        plans = self.plans(experiment.schedule).astype(np.uint8)
        if self.reversible:
            plans = np.concatenate([plans, REVERSED * plans])
        values, level = self.values(experiment, forecaster), self.level(experiment)
        observable = experiment.observed_space.observable
        fallback = Fallback(self.fallback, experiment)

        def decide(look: Look) -> ByteArray:
            chosen, invalid = best_plans(look, forecaster, values, observable, level, plans)
            return fallback.where(invalid, chosen[0], look)

        return decide


def pulses(starts: Sequence[int], lengths: Sequence[int], steps: int) -> BoolArray:
    """Plans that are on once: from each start, for each length in steps; cut at their end.

    ``(plans, steps)``, no two alike, in the order of starts and lengths.
    """
    plans: dict[bytes, BoolArray] = {}
    for start in starts:
        for length in lengths:
            plan = np.zeros(steps, dtype=bool)
            plan[start : start + length] = True
            if plan.any():
                plans.setdefault(plan.tobytes(), plan)
    return np.array(list(plans.values())).reshape(-1, steps)


def best_plans(
    look: Look,
    forecaster: Any,
    values: ActuationValues,
    observable: Callable[[FloatArray], FloatArray],
    level: float,
    plans: ByteArray,
) -> tuple[ByteArray, BoolArray]:
    """Best plan of each flow, or of each member (see the module), ``(steps, batch)``.

    Also returns whether the forecast without any further actuation is invalid, ``(batch,)``: then
    no plan is made. ``plans``: The actuation of each, step by step from the effect of the decision
    to the horizon, ``(plans, steps)``.
    """

    @np.errstate(over="ignore", invalid="ignore")
    def ahead(memory: FloatArray, acting: ByteArray) -> FloatArray:
        schedule = values.schedule(np.ascontiguousarray(acting))
        outputs, _ = forecaster.advance(carry(memory, schedule), len(acting))
        return np.asarray(forecaster.valid(outputs).transpose(1, 0, 2))

    memory, number = informed_memory(forecaster, look, values), len(plans)
    chosen: ByteArray = np.zeros((plans.shape[1], memory.shape[-1]), dtype=np.uint8)
    without = ahead(memory, chosen)
    invalid = is_invalid(without)
    acts = np.flatnonzero((observable(without) >= level).any(axis=0) & ~invalid)
    at_once = max(1, TRAJECTORIES_PER_CALL // number)
    for start in range(0, len(acts), at_once):
        some = acts[start : start + at_once]
        side_by_side = np.ascontiguousarray(np.tile(memory[..., some], number))
        forecast = observable(ahead(side_by_side, np.repeat(plans, len(some), axis=0).T))
        height = np.where(np.isfinite(forecast), forecast, np.inf).reshape(-1, number, len(some))
        above, peak = (height >= level).sum(axis=0), height.max(axis=0)
        cost = np.broadcast_to((plans != 0).sum(axis=1)[:, np.newaxis], above.shape)
        # among sufficient plans the cheapest goes first; the others are ordered by the steps
        # above the level
        first = np.where(above == 0, cost, above)
        best = np.lexsort((cost, peak, first, above > 0), axis=0)[0]
        chosen[:, some] = plans[best].T
    return chosen, invalid

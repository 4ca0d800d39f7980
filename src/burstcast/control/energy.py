"""Energy of controlled flows: their budget, and the cost of the actuation.

An actuation changes the right-hand side of the equations from f to f'. Whether it adds a force or
changes a parameter, it acts as the force g(x) = f'(x) - f(x) does, by which different actuators are
compared.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from burstcast.base.arrays import ByteArray, FloatArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import COMPONENT, POWER
from burstcast.systems.base import DynamicalSystem, EnergyBudget
from burstcast.systems.flow_map import FlowMap


@dataclass(frozen=True)
class ActuationCost:
    """Cost of the actuation of each flow, averaged over all steps that count, ``(flows,)``.

    The energy is half the squared length of the state: power is the mean of abs(x . g).
    """

    effort: Annotated[
        FloatArray,
        Described("flow", COMPONENT, "mean length of the force that acts as the actuation"),
    ]
    power: Annotated[
        FloatArray, Described("flow", POWER, "mean energy that this force puts in or takes out")
    ]


def actuation_cost(
    systems: Sequence[DynamicalSystem], states: FloatArray, actuation: ByteArray
) -> ActuationCost | None:
    """Cost of the actuation under which flows came to their states ``(flows, steps, dimension)``.

    ``actuation``: Number of the system under which they came there, ``(flows, steps)``. None if the
    equations are a map, which has no right-hand side.
    """
    if any(isinstance(system, FlowMap) for system in systems):
        return None
    effort, power = np.zeros(actuation.shape), np.zeros(actuation.shape)
    for number, system in enumerate(systems[1:], start=1):
        under = actuation == number
        state = np.ascontiguousarray(states[under].T)
        force = system.right_hand_side(state) - systems[0].right_hand_side(state)
        effort[under] = np.sqrt(np.square(force).sum(axis=0))
        power[under] = np.abs((state * force).sum(axis=0))
    return ActuationCost(effort.mean(axis=1), power.mean(axis=1))


def energy_means(
    systems: Sequence[DynamicalSystem], states: FloatArray, actuation: ByteArray
) -> EnergyBudget | None:
    """Energy input and dissipation of flows, means over their steps, ``(flows,)`` each.

    A step's budget is computed by the equations under which the flow came to it: ``actuation`` as
    in `actuation_cost`. None if the equations have no energy budget.
    """
    components = np.ascontiguousarray(states.transpose(2, 0, 1))
    budgets = [system.energy_budget(components) for system in systems]
    defined = [budget for budget in budgets if budget is not None]
    if len(defined) < len(budgets):
        return None
    inputs = [budget.input for budget in defined]
    dissipations = [budget.dissipation for budget in defined]
    return EnergyBudget(
        np.choose(actuation, inputs).mean(axis=1), np.choose(actuation, dissipations).mean(axis=1)
    )

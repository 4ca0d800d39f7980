"""Costs of an actuation: effort and power of the equivalent force.

An actuation changes the right-hand side of the equations from f to f'. Whether it adds a force or
changes a parameter, it acts as the force g(x) = f'(x) - f(x) does, by which different actuators are
compared.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import ByteArray, FloatArray
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.flow_map import FlowMap


@dataclass(frozen=True)
class ActuationCost:
    """Cost of the actuation of each flow, averaged over all steps that count, ``(flows,)``.

    Attributes
    ----------
    effort
        Mean length of the equivalent force g.
    power
        Mean of abs(x . g), the energy that the actuation puts in or takes out per unit of time. The
        energy is half the squared length of the state.
    """

    effort: FloatArray
    power: FloatArray


def actuation_cost(
    systems: Sequence[DynamicalSystem], states: FloatArray, actuation: ByteArray
) -> ActuationCost | None:
    """Cost of the actuation under which flows came to their states.

    Parameters
    ----------
    systems
        The equations without actuation, and under each.
    states
        ``(flows, steps, dimension)``.
    actuation
        Number of the system under which the flows came to these states, 0 for no actuation,
        ``(flows, steps)``.

    Returns
    -------
    None if the equations are a map, which has no right-hand side.
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

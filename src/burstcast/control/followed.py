"""Flows that were followed with and without control: what every strategy leaves behind."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.timing import Clock
from burstcast.systems.base import DynamicalSystem, EnergyBudget


@dataclass(frozen=True)
class EnergyMeans:
    """Energy input and dissipation of each flow, averaged over the steps that count, ``(flows,)``.

    Attributes
    ----------
    input
        Work of the forces per unit of time (see `DynamicalSystem.energy_budget`).
    dissipation
        Energy that viscosity takes per unit of time.
    """

    input: FloatArray
    dissipation: FloatArray


@dataclass(frozen=True)
class FollowedFlows:
    """Flows with and without control, from the same states over the same steps.

    Attributes
    ----------
    timing
        Which steps count.
    threshold
        The event threshold, k_e.
    rows
        Which of the given flows these are, ``(flows,)``.
    left_out
        How many of the given flows were not, since they had an event at the start.
    uncontrolled, controlled
        Observable, ``(flows, timing.length)``.
    actuated
        Whether the controlled flow came to each step under actuation, ``(flows, timing.length)``.
    actuated_integration_steps
        Integration steps under actuation among those that count, ``(flows,)``.
    switchings
        How often the actuation was switched on among the integration steps that count: one that is
        on at the first of them counts, ``(flows,)``.
    uncontrolled_energy, controlled_energy
        Energy input and dissipation; None for a system that does not tell them.
    uncontrolled_states, controlled_states
        States, ``(flows, timing.length, dimension)``; None unless asked for.
    """

    timing: Clock
    threshold: float
    rows: IntArray
    left_out: int
    uncontrolled: FloatArray
    controlled: FloatArray
    actuated: BoolArray
    actuated_integration_steps: IntArray
    switchings: IntArray
    uncontrolled_energy: EnergyMeans | None
    controlled_energy: EnergyMeans | None
    uncontrolled_states: FloatArray | None
    controlled_states: FloatArray | None

    def __len__(self) -> int:
        """Return the number of flows."""
        return len(self.rows)


def actuated_samples(acting: BoolArray, timing: Clock) -> BoolArray:
    """Whether flows came to each step under actuation, ``(flows, timing.length)``.

    Parameters
    ----------
    acting
        Whether each integration step since step 0 is under actuation, ``(flows, integration
        steps)``: as many as there are up to the last step that counts, or more.
    timing
        Of the flows.
    """
    stride = timing.sampling_stride
    actuated = np.zeros((len(acting), timing.length), dtype=bool)
    actuated[:, 1:] = acting[:, stride - 1 :: stride][:, : timing.length - 1]
    return actuated


def counted_actuation(acting: BoolArray, timing: Clock) -> tuple[IntArray, IntArray]:
    """Integration steps under actuation among those that count, and how often it was switched on.

    Parameters are those of `actuated_samples`; both results are ``(flows,)``.
    """
    stride = timing.sampling_stride
    counted = acting[:, timing.counted_from * stride : timing.counted_until * stride]
    before = np.pad(counted[:, :-1], ((0, 0), (1, 0)))
    steps: IntArray = np.sum(counted, axis=1, dtype=np.int64)
    switchings: IntArray = np.sum(counted & ~before, axis=1, dtype=np.int64)
    return steps, switchings


def energy_means(
    system: DynamicalSystem,
    states: FloatArray,
    actuated_system: DynamicalSystem | None = None,
    actuated: BoolArray | None = None,
) -> EnergyMeans | None:
    """Energy input and dissipation of flows, averaged over their steps.

    A step's budget is that of the equations under which the flow came to it.

    Parameters
    ----------
    system
        The equations.
    states
        At the steps that count, ``(flows, steps, dimension)``.
    actuated_system, actuated
        The equations under actuation, and whether the flows came to these steps under it,
        ``(flows, steps)``; None for flows without control.

    Returns
    -------
    The means; None if the equations do not tell their budget.
    """
    components = np.ascontiguousarray(states.transpose(2, 0, 1))
    budget = system.energy_budget(components)
    if budget is None:
        return None
    if actuated_system is not None and actuated is not None:
        under_actuation = actuated_system.energy_budget(components)
        if under_actuation is None:
            return None
        budget = EnergyBudget(
            *(
                np.where(actuated, there, here)
                for there, here in zip(under_actuation, budget, strict=True)
            )
        )
    return EnergyMeans(input=budget.input.mean(axis=1), dissipation=budget.dissipation.mean(axis=1))


def concatenated(batches: Sequence[FollowedFlows]) -> dict[str, Any]:
    """Fields of `FollowedFlows`, but for the timing, of several batches one after the other."""

    def joined(name: str) -> Any:
        return np.concatenate([getattr(batch, name) for batch in batches])

    def energy(name: str) -> EnergyMeans | None:
        means = [mean for batch in batches if (mean := getattr(batch, name)) is not None]
        return (
            EnergyMeans(
                input=np.concatenate([mean.input for mean in means]),
                dissipation=np.concatenate([mean.dissipation for mean in means]),
            )
            if means
            else None
        )

    def states(name: str) -> FloatArray | None:
        kept = [part for batch in batches if (part := getattr(batch, name)) is not None]
        return np.concatenate(kept) if kept else None

    arrays = ("rows", "uncontrolled", "controlled", "actuated")
    return {
        "threshold": batches[0].threshold,
        "left_out": sum(batch.left_out for batch in batches),
        **{name: joined(name) for name in (*arrays, "actuated_integration_steps", "switchings")},
        **{name: energy(name) for name in ("uncontrolled_energy", "controlled_energy")},
        **{name: states(name) for name in ("uncontrolled_states", "controlled_states")},
    }

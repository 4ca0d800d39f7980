"""Quantities of a flow that its continuous symmetries do not change.

A flow that may be shifted has one event at every place. An encoding without the place has it once,
and is learnt from fewer data (`DynamicalSystem.invariants`). It cannot be decoded.
"""

from dataclasses import dataclass
from typing import Self

from burstcast.arrays import FloatArray
from burstcast.encoders.base import Encoder, EncodingCase
from burstcast.systems.base import DynamicalSystem, has_own


@dataclass(frozen=True)
class InvariantsEncoder(Encoder):
    """Channels are the invariants of the system."""

    system: DynamicalSystem

    @classmethod
    def fit(cls, training: FloatArray, case: EncodingCase) -> Self:
        """Take the system's invariants; nothing is fitted."""
        return cls(_system(case))

    @classmethod
    def channel_names(cls, case: EncodingCase) -> tuple[str, ...]:
        """Names of the invariants."""
        names: tuple[str, ...] = _system(case).invariant_names  # type: ignore[attr-defined]
        return names

    def encode(self, observed: FloatArray) -> FloatArray:
        """Invariants of states ``(dimension, ...)``."""
        return self.system.invariants(observed)


def _system(case: EncodingCase) -> DynamicalSystem:
    """System of the states. Raises ValueError if it has no invariants."""
    system = case.space
    if not isinstance(system, DynamicalSystem) or not has_own(system, "invariants"):
        raise ValueError(f"{type(system).__name__} has no invariants to encode")
    return system

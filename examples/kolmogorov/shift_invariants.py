"""Quantities of the Kolmogorov flow that its continuous symmetry, shifts along x, does not change.

A flow that may be shifted has one event at every place. An encoding without the place has it once,
and is learnt from fewer data (`KolmogorovFlow.invariants`). It cannot be decoded.
"""

from dataclasses import dataclass
from typing import Self

from burstcast.base.arrays import FloatArray
from burstcast.data.encoders.base import Encoder, EncodingCase
from kolmogorov_flow import KolmogorovFlow


@dataclass(frozen=True)
class Invariants(Encoder):
    """Channels are the invariants of the flow."""

    flow: KolmogorovFlow

    @classmethod
    def fit(cls, training: FloatArray, case: EncodingCase) -> Self:
        """Take the flow's invariants; nothing is fitted."""
        return cls(_flow(case))

    @classmethod
    def channel_names(cls, case: EncodingCase) -> tuple[str, ...]:
        """Names of the invariants."""
        return _flow(case).invariant_names

    def encode(self, observed: FloatArray) -> FloatArray:
        """Invariants of states ``(dimension, ...)``."""
        return self.flow.invariants(observed)


def _flow(case: EncodingCase) -> KolmogorovFlow:
    """Flow of the states. Raises ValueError if it is another system."""
    if not isinstance(case.space, KolmogorovFlow):
        raise ValueError(f"{type(case.space).__name__} has no invariants to encode")
    return case.space

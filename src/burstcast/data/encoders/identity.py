"""No encoding: forecasters are given the observed components."""

from dataclasses import dataclass
from typing import ClassVar, Self

from burstcast.base.arrays import FloatArray
from burstcast.data.encoders.base import Encoder, EncodingCase


@dataclass(frozen=True)
class IdentityEncoder(Encoder):
    """Channels are the observed components."""

    decodes: ClassVar[bool] = True

    @classmethod
    def fit(cls, training: FloatArray, case: EncodingCase) -> Self:
        """Return an encoder; nothing is fitted."""
        return cls()

    @classmethod
    def channel_names(cls, case: EncodingCase) -> tuple[str, ...]:
        """Names of the observed components."""
        return case.components

    def encode(self, observed: FloatArray) -> FloatArray:
        """Return the observation unchanged."""
        return observed

    def decode(self, channels: FloatArray) -> FloatArray:
        """Return the channels, unchanged."""
        return channels

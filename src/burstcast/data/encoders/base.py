"""The interface of an encoder, which maps observations to the channels that forecasters receive.

A turbulent flow has hundreds of components, of which sensors see few. An encoder computes the
*channels* of a forecaster's state from the observed components: fewer quantities, or quantities
that are easier to learn. It is fitted to the training series. A new kind of encoder is one new
module of this package with one concrete subclass of `Encoder` in it; its name is the module's.
"""

import abc
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.observation.base import Observation
from burstcast.systems.state_space import StateSpace, component_names


@dataclass(frozen=True)
class EncodingCase:
    """Information for encoders of a case beside the data."""

    space: StateSpace  #: the states of the flow, and its symmetries where it has any
    options: Mapping[str, Any] = field(default_factory=dict)  #: settings of the kind itself
    #: how the observed components follow from states; None: they are the states themselves
    observation: Observation | None = None
    #: standard deviation of the errors of the observed components, ``(observed,)``; None: no errors
    noise: FloatArray | None = None

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the observed components."""
        if self.observation is not None:
            return self.observation.channels
        return component_names(self.space)

    def readings(self, states: FloatArray) -> FloatArray:
        """Noise-free observation of states ``(dimension, ...)``: ``(observed, ...)``."""
        return states if self.observation is None else self.observation(states)

    def readings_of_series(self, states: FloatArray) -> FloatArray:
        """Noise-free ``(series, time, observed)`` of series ``(series, time, dimension)``."""
        return np.moveaxis(self.readings(np.moveaxis(states, -1, 0)), 0, -1)


class Encoder(abc.ABC):
    """Maps observations to channels."""

    decodes: ClassVar[bool] = False
    """Whether `decode` recovers what was encoded."""

    option_names: ClassVar[tuple[str, ...]] = ()
    """Names of its options."""

    array_names: ClassVar[tuple[str, ...]] = ()
    """Names of the fitted arrays, which are all of its fields; empty if nothing is fitted."""

    @classmethod
    @abc.abstractmethod
    def fit(cls, training: FloatArray, case: EncodingCase) -> Self:
        """Fit the encoder to training series.

        ``training``: True states where the kind needs them, and observed ones otherwise, ``(series,
        time, component)``. An option out of bounds is a ValueError.
        """

    @classmethod
    def restore(cls, arrays: Mapping[str, FloatArray], case: EncodingCase) -> Self:
        """Encoder of a case from its fitted arrays."""
        return cls(**arrays) if cls.array_names else cls.fit(np.empty((0, 0, 0)), case)

    @classmethod
    @abc.abstractmethod
    def channel_names(cls, case: EncodingCase) -> tuple[str, ...]:
        """Names of the channels, which are known before the encoder is fitted."""

    @abc.abstractmethod
    def encode(self, observed: FloatArray) -> FloatArray:
        """Channels ``(channel, ...)`` of observations ``(component, ...)``."""

    def encode_series(self, observed: FloatArray) -> FloatArray:
        """Channels of series ``(series, time, component)``: ``(series, time, channel)``."""
        return np.moveaxis(self.encode(np.moveaxis(observed, -1, 0)), 0, -1)

    def decode(self, channels: FloatArray) -> FloatArray:
        """Components of channels ``(channel, ...)``, as near as the encoding allows."""
        raise NotImplementedError(f"{type(self).__name__} does not decode")

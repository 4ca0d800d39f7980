"""From the states of a flow to the channels of a case: sensors, noise, an estimate, an encoder."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.dataset import Scales, component_scales, observed_series
from burstcast.data.encoders._moments import state_moments
from burstcast.data.encoders.base import Encoder, EncodingCase
from burstcast.data.encoders.registry import encoder_class
from burstcast.data.encoders.state_estimate import StateEstimateEncoder
from burstcast.data.encoders.state_maps import StateMaps
from burstcast.data.observation.components import ObservedComponents
from burstcast.data.observation.velocity_sensors import PlaneFlow, VelocitySensors
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.state_space import StateSpace, component_names

IDENTITY, ESTIMATE = "identity", "state_estimate"
"""Kinds of encoders that receive the observations themselves, also where sensors observe."""


@dataclass(frozen=True)
class StateChannels:
    """Channels of a case that has the states of another case, seen by sensors and encoded."""

    case: EncodingCase  #: the states, the sensors if there are any, and options of the encoder
    #: estimate of the state from the readings of sensors, which the encoder is given; None where
    #: states are observed themselves, or readings are not encoded
    estimate: StateEstimateEncoder | None
    encoder: Encoder  #: map from observed or estimated states, or from readings, to channels

    @classmethod
    def fit(cls, kind: str, states: FloatArray, seen: FloatArray, case: EncodingCase) -> Self:
        """Fit the encoder, and before it the estimate of the state where it needs one.

        ``kind``: Kind of the encoder (`burstcast.data.encoders.registry`). All but ``identity`` are
        given an estimate of the state where sensors see it. ``states``: True training states,
        ``(series, time, dimension)``. ``seen``: What was observed of them, with noise, ``(series,
        time, observed)``.
        """
        if case.observation is None or kind == IDENTITY:
            return cls(case, None, encoder_class(kind).fit(seen, case))
        estimate = StateEstimateEncoder.fit(states, case)
        if kind == ESTIMATE:
            return cls(case, None, estimate)
        of_states = replace(case, observation=None)
        return cls(case, estimate, encoder_class(kind).fit(estimate.encode_series(seen), of_states))

    @classmethod
    def of_training(
        cls,
        kind: str,
        states: FloatArray,
        case: EncodingCase,
        level: float,
        random_seed: int,
        source: str,
    ) -> tuple[Self, Scales]:
        """Fit to training series that are observed with the noise of their case.

        ``level``: Standard deviation of the noise in standard deviations of each observed
        component. ``random_seed``, ``source``: Root of all random streams, and name of the case
        that has these states.
        """
        readings = case.readings_of_series(states)
        scales = component_scales(readings)
        case = replace(case, noise=level * scales.standard_deviation)
        seen = observed_series(readings, 0, level, scales, random_seed, source)
        return cls.fit(kind, states, seen, case), scales

    @classmethod
    def restore(cls, kind: str, case: EncodingCase, arrays: Mapping[str, FloatArray]) -> Self:
        """Channels of a kind and a case, from their `arrays`."""
        of_part: dict[str, dict[str, FloatArray]] = {"estimate": {}, "encoder": {}}
        for name, array in arrays.items():
            part, _, field = name.partition("_")
            of_part[part][field] = array
        encoder = encoder_class(kind)
        if case.observation is None or kind in (IDENTITY, ESTIMATE):
            return cls(case, None, encoder.restore(of_part["encoder"], case))
        estimate = StateEstimateEncoder.restore(of_part["estimate"], case)
        of_states = replace(case, observation=None)
        return cls(case, estimate, encoder.restore(of_part["encoder"], of_states))

    @property
    def arrays(self) -> dict[str, FloatArray]:
        """Fitted arrays, by part and name."""
        parts = {"estimate": self.estimate, "encoder": self.encoder}
        return {
            f"{part}_{name}": getattr(encoder, name)
            for part, encoder in parts.items()
            if encoder is not None
            for name in encoder.array_names
        }

    def encode(self, seen: FloatArray) -> FloatArray:
        """Channels ``(channel, ...)`` of what is observed, ``(observed, ...)``."""
        if self.estimate is not None:
            seen = self.estimate.encode(seen)
        return self.encoder.encode(seen)

    def encode_series(self, seen: FloatArray) -> FloatArray:
        """Channels ``(series, time, channel)`` of observed series ``(series, time, observed)``."""
        if self.estimate is not None:
            seen = self.estimate.encode_series(seen)
        return self.encoder.encode_series(seen)

    @property
    def decodes(self) -> bool:
        """Whether states follow from channels: the encoder decodes, and is linear."""
        return self.encoder.decodes

    def maps(self, states: FloatArray) -> StateMaps:
        """Affine maps between states and channels.

        ``states``: True training states, ``(series, time, dimension)``.
        """
        moments = state_moments(states.reshape(-1, states.shape[-1]), self.case.space)
        decode: Callable[[FloatArray], FloatArray] = self.encoder.decode
        if self.case.observation is not None and self.estimate is None:
            # channels are the estimate of the state itself, or readings, which it follows from
            is_estimate = isinstance(self.encoder, StateEstimateEncoder)
            decode = _same if is_estimate else StateEstimateEncoder.of(moments, self.case).encode
        matrix, offset = _affine(
            lambda state: self.encode(self.case.readings(state)), states.shape[-1]
        )
        gain, constant = _affine(decode, len(offset))
        return StateMaps(gain, constant, matrix, offset, moments.covariance)


@dataclass(frozen=True)
class EncodedFlow:
    """Observations of a running flow, and their channels for forecasters."""

    channels: StateChannels  #: the sensors and the encoder, fitted
    source: DynamicalSystem  #: equations of the flow
    space: StateSpace  #: the channels with the observable as the last one, as a state of its own

    def __call__(self, states: FloatArray) -> FloatArray:
        """Readings and, last, the observable of states ``(dimension, ...)``, without noise."""
        readings = self.channels.case.readings(states)
        return np.concatenate([readings, self.source.observable(states)[np.newaxis]])

    def encode(self, observed: FloatArray) -> FloatArray:
        """Channels and, last, the observable of what was observed, ``(observed, ...)``."""
        return np.concatenate([self.channels.encode(observed[:-1]), observed[-1:]])


def encoding_case(
    space: StateSpace, sensors: Mapping[str, Any] | None, options: Mapping[str, Any]
) -> EncodingCase:
    """Information for the encoder of a case.

    ``sensors``: ``points`` of the `VelocitySensors`, or ``components``; None: the states are
    observed themselves.
    """
    if sensors is None:
        return EncodingCase(space, options)
    if seen := sensors.get("components"):
        return EncodingCase(space, options, ObservedComponents(space, tuple(seen)))
    if not isinstance(space, PlaneFlow):
        raise ValueError(
            f"sensors measure the velocity in a plane, which {type(space).__name__} has not"
        )
    return EncodingCase(space, options, VelocitySensors(space, tuple(sensors["points"])))


def channel_names(kind: str, case: EncodingCase) -> tuple[str, ...]:
    """Names of the channels of a case, which are known before anything is fitted."""
    if kind not in (IDENTITY, ESTIMATE):
        case = replace(case, observation=None)
    return encoder_class(kind).channel_names(case)


def check_encoding(kind: str, case: EncodingCase, noise: float, snapshots: int) -> None:
    """Check the settings of an encoded case before there are data.

    ``noise``: Level of the observation noise, ``training.noise``.
    """
    options = encoder_class(kind).option_names
    for name, value in case.options.items():
        if value not in (None, []) and name not in options:
            raise ValueError(f"encoder.{name} is no option of the encoder {kind}: leave it out")
    channel_names(kind, case)
    sensors = case.observation
    if isinstance(sensors, VelocitySensors) and (unseen := sensors.unseen):
        names, (along_x, along_y) = component_names(case.space), sensors.points
        raise ValueError(
            f"no sensor sees {', '.join(names[number] for number in unseen)}: the velocity of "
            f"these components vanishes at all {along_x} x {along_y} sensors from "
            f"{sensors.offset} on; take other sensors.points"
        )
    if case.observation is not None and not noise:
        raise ValueError(
            "training.noise is 0, but an estimate of the state from sensors takes a noise above 0"
        )
    modes = case.options.get("modes") or 0
    if modes > snapshots:
        raise ValueError(
            f"encoder.modes is {modes}; the training series have {snapshots} snapshots, no more"
        )


def _affine(
    function: Callable[[FloatArray], FloatArray], size: int
) -> tuple[FloatArray, FloatArray]:
    """Matrix and constant of an affine function of ``(size, ...)``."""
    constant = function(np.zeros((size, 1)))
    return function(np.eye(size)) - constant, constant[:, 0]


def _same(values: FloatArray) -> FloatArray:
    return values

"""Reservoirs of forecasters: their training series, and their records, without large matrices."""

from collections.abc import Mapping
from typing import Any, Literal

from burstcast.base.arrays import FloatArray
from burstcast.data.dataset import network_input_offset, network_input_range
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.training import TrainingSeries

_AS_IN_THE_PAPER = {"leak_rate": 1.0, "readout": "linear"}


def normalised_series(
    observed: FloatArray,
    states: FloatArray,
    input_range: Literal["all", "first"],
    input_offset: Literal["mean", "none"],
) -> TrainingSeries:
    """Observed series, the longest first, normalised by the true ``states``, as networks learn."""
    scale = network_input_range(states, input_range)
    offset = network_input_offset(states, input_offset)
    return TrainingSeries(observed, scale, offset).longest_first()


def recorded_scales(
    input_range: FloatArray, input_offset: FloatArray | None
) -> dict[str, FloatArray]:
    """Arrays of the normalisation of inputs; the offset only if there is one."""
    offset = {} if input_offset is None else {"input_offset": input_offset}
    return {"input_range": input_range, **offset}


def recorded_dynamics(seed: ReservoirSeed, dynamics: Dynamics) -> dict[str, str | int | float]:
    """Attributes of a reservoir; the leak rate and the readout only if they are not the paper's."""
    differs = {name: getattr(dynamics, name) for name in _AS_IN_THE_PAPER}
    return {
        **vars(seed),
        "spectral_radius": dynamics.spectral_radius,
        "input_scaling": dynamics.input_scaling,
        **{name: value for name, value in differs.items() if value != _AS_IN_THE_PAPER[name]},
    }


def restored_dynamics(
    attributes: Mapping[str, Any], dimension: int, backend: Literal["compiled", "scipy"]
) -> tuple[ReservoirSeed, Dynamics]:
    """Make the reservoir of such attributes anew, for inputs of this dimension."""
    seed = ReservoirSeed(
        int(attributes["random_seed"]),
        int(attributes["neurons"]),
        int(attributes["seed"]),
        float(attributes["connectivity"]),
        float(attributes["input_bias"]),
    )
    attributes = {**_AS_IN_THE_PAPER, **attributes}
    dynamics = Dynamics(
        seed.reservoir(dimension),
        float(attributes["spectral_radius"]),
        float(attributes["input_scaling"]),
        backend,
        float(attributes["leak_rate"]),
        attributes["readout"],
    )
    return seed, dynamics

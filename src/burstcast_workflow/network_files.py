"""Networks as files: seeds and readout rather than big matrices, which are made anew."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from burstcast import random_streams
from burstcast.dataset import component_scales, observed_series
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.readout import Readout
from burstcast.esn.reservoir import Reservoir, make_reservoir
from burstcast.esn.training import TrainingSeries
from burstcast.forecasters.esn import NetworkForecaster
from burstcast_workflow.series_fit import check_kept_series
from burstcast_workflow.storage import (
    Variable,
    read_attributes,
    read_netcdf,
    read_rows,
    write_netcdf,
)


def training_series(settings: Mapping[str, Any], ensemble: str) -> TrainingSeries:
    """Training series of a case as the networks see them.

    Parameters
    ----------
    settings
        With ``training`` (series, noise), ``random_seed`` and ``case``.
    ensemble
        Path of the ensemble.

    Raises
    ------
    ValueError
        If the ensemble has too few series, or a component of them is constant.
    """
    training = settings["training"]
    kept = read_netcdf(ensemble, "series")["series"].size
    check_kept_series(kept, {"training.series": training["series"]})
    states = read_rows(ensemble, "state", 0, training["series"])
    scales = component_scales(states)
    observed = observed_series(
        states, 0, training["noise"], scales, settings["random_seed"], settings["case"]
    )
    return TrainingSeries(observed=observed, input_range=scales.range)


def reservoir(settings: Mapping[str, Any], dimension: int) -> Reservoir:
    """Reservoir of a size and seed: the same for all cases, strategies and hyperparameters.

    Parameters
    ----------
    settings
        With ``neurons``, ``seed``, ``connectivity``, ``input_bias`` and ``random_seed``.
    dimension
        Components of the system's state.
    """
    return make_reservoir(
        settings["neurons"],
        dimension,
        settings["connectivity"],
        settings["input_bias"],
        random_streams.stream(
            settings["random_seed"], "reservoir", settings["neurons"], settings["seed"]
        ),
    )


BACKENDS: dict[str, Literal["numba", "scipy"]] = {"compiled": "numba", "scipy": "scipy"}
"""Implementation of the dynamics by what the setting ``kernel`` calls it."""


def backend_of(kernel: str) -> Literal["numba", "scipy"]:
    """Backend of `Dynamics` by what the setting ``kernel`` calls it.

    Raises
    ------
    ValueError
        If there is none of that name.
    """
    if kernel not in BACKENDS:
        raise ValueError(f"the kernel is {' or '.join(BACKENDS)}, not {kernel!r}")
    return BACKENDS[kernel]


RESERVOIR_SETTINGS = ("neurons", "seed", "connectivity", "input_bias", "random_seed")


def write_network(
    path: str | Path,
    network: EchoStateNetwork,
    settings: Mapping[str, Any],
    provenance: Mapping[str, str],
) -> None:
    """Write a trained network: readout, normalisation, and what its reservoir is made from."""
    readout = network.readout
    write_netcdf(
        path,
        {
            "weights": Variable(
                ("neuron_and_bias", "component"),
                readout.weights,
                "1",
                "readout weights; the last row is the output bias",
            ),
            "input_range": Variable(
                ("component",), network.input_range, "1", "what the inputs are divided by"
            ),
        },
        {
            **provenance,
            **{name: settings[name] for name in RESERVOIR_SETTINGS},
            "spectral_radius": network.dynamics.spectral_radius,
            "input_scaling": network.dynamics.input_scaling,
            "tikhonov": readout.tikhonov,
            "solver": readout.solver,
            "reciprocal_condition": readout.reciprocal_condition,
        },
    )


def read_network(path: str | Path, kernel: str) -> EchoStateNetwork:
    """Read a network that `write_network` wrote.

    Parameters
    ----------
    kernel
        "compiled" or "scipy".
    """
    data = read_netcdf(path)
    record: dict[str, Any] = dict(read_attributes(path))
    dimension = data["input_range"].shape[0]
    dynamics = Dynamics(
        reservoir(record, dimension),
        float(record["spectral_radius"]),
        float(record["input_scaling"]),
        backend_of(kernel),
    )
    readout = Readout(
        weights=np.ascontiguousarray(data["weights"]),
        tikhonov=float(record["tikhonov"]),
        solver=str(record["solver"]),
        reciprocal_condition=float(record["reciprocal_condition"]),
    )
    return EchoStateNetwork(dynamics, readout, data["input_range"])


def read_forecaster(
    path: str | Path, kernel: str, divergence_bound: float = np.inf
) -> NetworkForecaster:
    """Read a network as a forecaster."""
    return NetworkForecaster(read_network(path, kernel), divergence_bound)

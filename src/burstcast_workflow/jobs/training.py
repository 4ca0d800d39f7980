"""What networks are made from: the training series, and what their reservoirs are made from."""

from collections.abc import Mapping
from typing import Any

from burstcast.dataset import component_scales
from burstcast.esn.reservoir import ReservoirSeed
from burstcast.esn.training import TrainingSeries
from burstcast_workflow.identifiers import parsed
from burstcast_workflow.jobs.data import observed_rows, training_states

Settings = Mapping[str, Any]


def training_series(settings: Settings, ensemble: str) -> TrainingSeries:
    """Training series of a case as forecasters see them.

    Raises
    ------
    ValueError
        If the ensemble has too few series, or a component of them is constant.
    """
    states = training_states(settings, ensemble)
    observed = observed_rows(settings, ensemble, 0, states)
    return TrainingSeries(observed=observed, input_range=component_scales(states).range)


def reservoir_seed(settings: Settings, identifier: str) -> ReservoirSeed:
    """What the reservoir of a network, or of its scan, is made from."""
    name = parsed(identifier)
    assert name.neurons is not None
    assert name.seed is not None
    return ReservoirSeed(
        settings["random_seed"],
        name.neurons,
        name.seed,
        settings["forecasters.esn.connectivity"],
        settings["forecasters.esn.input_bias"],
    )

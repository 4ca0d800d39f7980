"""What networks are trained on; apart from the data, which nothing of the networks changes."""

from collections.abc import Mapping
from typing import Any

from burstcast.dataset import component_scales
from burstcast.esn.training import TrainingSeries
from burstcast_workflow.jobs.data import observed_rows, training_states

Settings = Mapping[str, Any]


def training_series(settings: Settings, ensemble: str) -> TrainingSeries:
    """Training series of a case as networks see them.

    Raises
    ------
    ValueError
        If the ensemble has too few series, or a component of them is constant.
    """
    states = training_states(settings, ensemble)
    observed = observed_rows(settings, ensemble, 0, states)
    return TrainingSeries(observed=observed, input_range=component_scales(states).range)

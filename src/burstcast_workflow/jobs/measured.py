"""Measured series of a job's case: from the files that they come in to what forecasters see."""

from collections.abc import Sequence

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.delay_coordinates import delay_coordinates
from burstcast.data.measured_data import (
    Quantity,
    check_varying,
    runs_of_states,
    series_of_runs,
)
from burstcast.data.records import RecordedSeries, recorded_series
from burstcast.files.netcdf import read_netcdf
from burstcast.systems.measured import MeasuredSeries
from burstcast_workflow.harness.settings import Settings


def present_space(settings: Settings) -> MeasuredSeries:
    """State without past values."""
    names = [Quantity(text).name for text in settings["case.data"]["components"]]
    return MeasuredSeries(**{**settings["case.parameters"], "components": names})


def with_past(settings: Settings, states: FloatArray) -> FloatArray:
    """Series with the past values that forecasters see, if they see any.

    Where the case has observation noise, it is here already: past values have the noise of their
    own time, and the observable of such states is not the true one.

    ``settings``: With ``case.data`` and ``case.training.series``, and as ``noise`` what
    `burstcast_workflow.campaign.campaign.Campaign.noise_of_data` says. Shape ``(series, time -
    longest delay, component)``: components, their past values, and last the observable where it is
    none of the components.
    """
    delays, noise = settings["case.data"]["delays"], settings["noise"]
    if not delays:
        return states
    if noise is not None:
        scales = component_scales(states[: settings["case.training.series"]])
        states = observed_series(
            states, 0, noise["level"], scales, noise["random_seed"], settings["case"]
        )
    count = len(settings["case.data"]["components"])
    seen = delay_coordinates(states[..., :count], delays)
    return np.concatenate([seen, states[:, max(delays) :, count:]], axis=2)


def measured_series(settings: Settings, sources: Sequence[str]) -> RecordedSeries:
    """Series of states without past values, checked.

    ``settings``: With ``case.data``, ``case.parameters`` and ``case.training.series``.
    """
    data, space = settings["case.data"], present_space(settings)
    if data["case"] is None:
        found = recorded_series(sources, data, space)
    else:
        read = read_netcdf(sources[0], "state", "observable")
        runs = runs_of_states(sources[0], read["state"], read["observable"], data["columns"])
        quantities = [Quantity(text) for text in data["components"]]
        found = RecordedSeries(series_of_runs(runs, space, quantities, None))
    training = found.states[: settings["case.training.series"]]
    check_varying(training, space.component_names, "the training series (training.series)")
    return found

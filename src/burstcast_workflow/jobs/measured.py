"""Measured series of a job's case: from the files that they come in to what forecasters see."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_netcdf
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.delay_coordinates import with_delays
from burstcast.data.measured_data import (
    Quantity,
    check_varying,
    runs_of_states,
    series_of_runs,
)
from burstcast.data.records import RecordedSeries, recorded_series
from burstcast.systems.measured import MeasuredSeries
from burstcast_workflow.harness.settings import JobSettings, at
from burstcast_workflow.jobs.series import Tested, Training


class MeasuredData(JobSettings):
    """Series in files, or another case's, of which this one's are a part."""

    tested: Tested
    data: dict[str, Any] = at("case.data")
    parameters: dict[str, Any] = at("case.parameters")
    noise_of_data: dict[str, Any] | None = at("job.noise_of_data")

    @property
    def present_space(self) -> MeasuredSeries:
        """State without past values."""
        names = [Quantity(text).name for text in self.data["components"]]
        return MeasuredSeries(**{**self.parameters, "components": names})

    @property
    def past(self) -> int:
        """Steps of the longest delay: so much later series begin with past values."""
        return max(self.data["delays"], default=0)

    def with_past(self, states: FloatArray) -> FloatArray:
        """Series with the past values that forecasters see, if they see any.

        Where the case has observation noise, it is here already: past values have the noise of
        their own time, and the observable of such states is not the true one. Shape ``(series, time
        - longest delay, component)``: components, their past values, and last the observable where
        it is none of the components.
        """
        delays, noise = self.data["delays"], self.noise_of_data
        if not delays:
            return states
        if noise is not None:
            scales = component_scales(states[: self.tested.training.series])
            states = observed_series(
                states, 0, noise["level"], scales, noise["random_seed"], self.case
            )
        count = len(self.data["components"])
        seen = with_delays(states[..., :count], delays)
        return np.concatenate([seen, states[:, self.past :, count:]], axis=2)

    def measured_series(self, sources: Sequence[str]) -> RecordedSeries:
        """Series of states without past values, checked."""
        data, space = self.data, self.present_space
        if data["case"] is None:
            series = recorded_series(sources, data, space)
        else:
            read = read_netcdf(sources[0], "state", "observable")
            runs = runs_of_states(sources[0], read["state"], read["observable"], data["columns"])
            quantities = [Quantity(text) for text in data["components"]]
            series = RecordedSeries(series_of_runs(runs, space, quantities, None))
        count, training = len(series.states), self.tested.training.series
        test = self.tested.series(count)
        if training + test > count:
            raise ValueError(
                f"training.series is {training} and test_series {test}, but the data have {count} "
                f"series in all, of {series.states.shape[1]} samples each: ask for fewer, or cut "
                f"shorter blocks (data.blocks)"
            )
        name = f"the training series ({Training.series})"
        check_varying(series.states[:training], space.component_names, name)
        return series

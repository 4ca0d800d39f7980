"""A model with a filter in front: it starts from an estimate of the present state.

What separates a good model from a perfect forecast is mostly that it starts from one noisy
observation (`burstcast.forecasters.equations_noisy`). The washout holds more of them.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.data.observation_noise import observation_noise
from burstcast.forecasters._options import FilterOptions, ObservationOptions
from burstcast.forecasters._square_root_filter import assimilate, mean, symmetric_members
from burstcast.forecasters.base import (
    Forecaster,
    ForecasterRecord,
    ForecastingCase,
    fitted,
    for_members,
)


@dataclass(frozen=True)
class FilteredForecaster(ObservationOptions, FilterOptions, Forecaster):
    """A forecaster whose memory after the washout is estimated by an ensemble filter.

    The ensemble starts around the first observation of the washout, with the scatter of the noise.
    The model advances it from one observation to the next, and each of them is assimilated. A kind
    of filtered forecasters is a subclass that says which model it is about.
    """

    provides_ensemble: ClassVar[bool] = True
    has_filter: ClassVar[bool] = True
    model_class: ClassVar[type[Forecaster]]

    model: Forecaster = fitted()  #: forecaster that advances the ensemble, and then forecasts
    #: standard deviation of the errors of an observation, ``(dimension,)``
    errors: FloatArray = fitted()

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Fit the model; estimate the noise unless it is known (see `Forecaster.fit`)."""
        return self.fit_under(training, case, None)

    def fit_under(
        self, training: FloatArray, case: ForecastingCase, schedules: FloatArray | None
    ) -> Self:
        """Fit the model to series under schedules (see `Forecaster.fit_under`)."""
        errors = observation_noise(training, self.noise)
        model = self._unfitted_model.fit_under(training, case, schedules)
        return self.with_fitted(model=model, errors=errors)

    @property
    def _unfitted_model(self) -> Forecaster:
        names = [option.name for option in self.model_class.option_fields()]
        return self.model_class(**{name: getattr(self, name) for name in names})

    def record(self) -> ForecasterRecord:
        """Learnt model and noise."""
        record = self.model.record()
        return ForecasterRecord({**record.arrays, "noise": self.errors}, record.attributes)

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Restore the model, and put the filter before it."""
        model = self._unfitted_model.restore(record, case)
        return self.with_fitted(model=model, errors=record.arrays["noise"])

    def ensemble(self, washout: FloatArray) -> FloatArray:
        """Memories of the filter's members after a washout (see `Forecaster.ensemble`)."""
        return self.ensemble_under(washout, None)

    def ensemble_under(self, washout: FloatArray, schedule: FloatArray | None) -> FloatArray:
        """Memories of the filter's members under a schedule (see `Forecaster.ensemble_under`)."""
        batch, memory = washout.shape[2], self.first_members(washout[0])
        for step, observation in enumerate(washout[1:]):
            in_force = None if schedule is None else schedule[step : step + 1]
            of_members = for_members(in_force, self.members)
            outputs, memory = self.model.advance_under(memory, 1, of_members)
            # the forecast of what is observed, and below it all that goes on from there
            rows = np.concatenate([outputs[0], memory.reshape(-1, memory.shape[-1])])
            updated = self.corrected(rows.reshape(-1, self.members, batch), observation)
            memory = updated[outputs.shape[1] :].reshape(memory.shape)
        return memory.reshape(*memory.shape[:-1], self.members, batch)

    def first_members(self, observation: FloatArray) -> FloatArray:
        """Memories of the members around an observation, ``(..., members * batch)``.

        ``observation``: The first of the washout, ``(dimension, batch)``.
        """
        states = symmetric_members(observation, self.errors, self.members)
        return self.model.start(states.reshape(1, len(states), -1))

    def corrected(self, ensemble: FloatArray, observation: FloatArray) -> FloatArray:
        """Members after an observation (`burstcast.forecasters._square_root_filter.assimilate`)."""
        return assimilate(ensemble, observation, self.errors, self.inflation)

    def start(self, washout: FloatArray) -> FloatArray:
        """Mean of the members' memories (see `Forecaster.start`)."""
        return self.start_under(washout, None)

    def start_under(self, washout: FloatArray, schedule: FloatArray | None) -> FloatArray:
        """Mean of the members' memories under a schedule (see `Forecaster.start_under`)."""
        return self.combined(self.ensemble_under(washout, schedule))

    def combined(self, ensemble: FloatArray) -> FloatArray:
        """Mean of the members' memories (see `Forecaster.combined`)."""
        shape = (*ensemble.shape[:-2], ensemble.shape[-1])
        return mean(ensemble.reshape(-1, *ensemble.shape[-2:])).reshape(shape)

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Let the model forecast (see `Forecaster.advance`)."""
        return self.model.advance(memory, steps)

    def advance_under(
        self, memory: FloatArray, steps: int, schedule: FloatArray | None
    ) -> tuple[FloatArray, FloatArray]:
        """Let the model forecast under a schedule (see `Forecaster.advance_under`)."""
        return self.model.advance_under(memory, steps, schedule)

    def diverged(self, outputs: FloatArray) -> BoolArray:
        """Mark diverged forecasts, by the criterion of the model."""
        return self.model.diverged(outputs)

"""A model with a filter in front: it starts from an estimate of the present state.

What separates a good model from a perfect forecast is mostly that it starts from one noisy
observation (`burstcast.forecasters.equations_noisy`). The washout holds more of them.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.exogenous import carry, of_series, of_washout
from burstcast.data.observation_noise import observation_noise
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters._options import FilterOptions, ObservationOptions
from burstcast.forecasters._square_root_filter import assimilate, mean, symmetric_members
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase, fitted


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
        states, _ = of_series(training, case.system.dimension)
        errors = observation_noise(states, self.noise)
        model = self._unfitted_model.fit(training, case)
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
        states, past, ahead = of_washout(washout, len(self.errors))
        batch, memory = washout.shape[2], self.first_members(states[0])
        for step, observation in enumerate(states[1:]):
            in_force = np.tile(past[step : step + 1], (1, 1, self.members))
            outputs, memory = self.model.advance(carry(memory, in_force), 1)
            # the forecast of what is observed, and below it all that goes on from there
            rows = np.concatenate([outputs[0], memory.reshape(-1, memory.shape[-1])])
            updated = self.corrected(rows.reshape(-1, self.members, batch), observation)
            memory = updated[outputs.shape[1] :].reshape(memory.shape)
        of_members = np.repeat(ahead[..., np.newaxis, :], self.members, axis=-2)
        return carry(memory.reshape(*memory.shape[:-1], self.members, batch), of_members)

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
        return self.combined(self.ensemble(washout))

    def combined(self, ensemble: FloatArray) -> FloatArray:
        """Mean of the members' memories, whose inputs are equal (see `Forecaster.combined`)."""
        size = len(ensemble)
        if isinstance(self.model, IntegratedForecaster):
            size = self.model.memory_size
        memories, inputs = ensemble[:size], ensemble[size:, ..., 0, :]
        shape = (*memories.shape[:-2], memories.shape[-1])
        centre = mean(memories.reshape(-1, *memories.shape[-2:])).reshape(shape)
        return np.concatenate([centre, inputs])

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Let the model forecast (see `Forecaster.advance`)."""
        return self.model.advance(memory, steps)

"""A model with a filter in front: it starts from an estimate of the present state.

What separates a good model from a perfect forecast is mostly that it starts from one noisy
observation (`burstcast.forecasters.equations_noisy`). The washout holds more of them.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.arrays import BoolArray, FloatArray
from burstcast.data.observation_noise import observation_noise
from burstcast.filters.square_root import assimilate, mean, symmetric_members
from burstcast.forecasters.base import (
    Forecaster,
    ForecasterRecord,
    ForecastingCase,
    for_members,
)


@dataclass(frozen=True)
class FilteredForecaster(Forecaster):
    """A forecaster whose memory after the washout is estimated by an ensemble filter.

    The ensemble starts around the first observation of the washout, with the scatter of the noise.
    The model advances it from one observation to the next, and each of them is assimilated. A kind
    of filtered forecasters is a subclass that says which model it is about.
    """

    provides_ensemble: ClassVar[bool] = True
    has_filter: ClassVar[bool] = True
    model_class: ClassVar[type[Forecaster]]

    model: Forecaster  #: forecaster that advances the ensemble, and then forecasts
    noise: FloatArray  #: standard deviation of the errors of an observation, ``(dimension,)``
    members: int  #: size of the ensemble: even, and at least twice the dimension
    inflation: float  #: see `burstcast.filters.square_root.assimilate`

    @classmethod
    def fit(
        cls, training: FloatArray, case: ForecastingCase, parameters: FloatArray | None = None
    ) -> Self:
        """Fit the model; estimate the noise unless it is known (see `Forecaster.fit`)."""
        noise = observation_noise(training, case.options["noise"])
        return cls._of(cls.model_class.fit(training, case, parameters), noise, case)

    def record(self) -> ForecasterRecord:
        """Learnt model and noise."""
        record = self.model.record()
        return ForecasterRecord({**record.arrays, "noise": self.noise}, record.attributes)

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Restore the model, and put the filter before it."""
        return cls._of(cls.model_class.restore(record, case), record.arrays["noise"], case)

    @classmethod
    def _of(cls, model: Forecaster, noise: FloatArray, case: ForecastingCase) -> Self:
        return cls(model, noise, case.options["members"], case.options["inflation"])

    def ensemble(self, washout: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        """Memories of the filter's members after a washout (see `Forecaster.ensemble`)."""
        batch, memory = washout.shape[2], self.first_members(washout[0])
        for step, observation in enumerate(washout[1:]):
            in_force = None if parameters is None else parameters[step : step + 1]
            outputs, memory = self.model.advance(memory, 1, for_members(in_force, self.members))
            # the forecast of what is observed, and below it all that goes on from there
            rows = np.concatenate([outputs[0], memory.reshape(-1, memory.shape[-1])])
            updated = self.corrected(rows.reshape(-1, self.members, batch), observation)
            memory = updated[outputs.shape[1] :].reshape(memory.shape)
        return memory.reshape(*memory.shape[:-1], self.members, batch)

    def first_members(self, observation: FloatArray) -> FloatArray:
        """Memories of the members around an observation, ``(..., members * batch)``.

        ``observation``: The first of the washout, ``(dimension, batch)``.
        """
        states = symmetric_members(observation, self.noise, self.members)
        return self.model.start(states.reshape(1, len(states), -1))

    def corrected(self, ensemble: FloatArray, observation: FloatArray) -> FloatArray:
        """Members after an observation (`burstcast.filters.square_root.assimilate`)."""
        return assimilate(ensemble, observation, self.noise, self.inflation)

    def start(self, washout: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        """Mean of the members' memories (see `Forecaster.start`)."""
        return self.combined(self.ensemble(washout, parameters))

    def combined(self, ensemble: FloatArray) -> FloatArray:
        """Mean of the members' memories (see `Forecaster.combined`)."""
        shape = (*ensemble.shape[:-2], ensemble.shape[-1])
        return mean(ensemble.reshape(-1, *ensemble.shape[-2:])).reshape(shape)

    def advance(
        self, memory: FloatArray, steps: int, parameters: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Let the model forecast (see `Forecaster.advance`)."""
        return self.model.advance(memory, steps, parameters)

    def diverged(self, outputs: FloatArray) -> BoolArray:
        """Mark diverged forecasts, by the criterion of the model."""
        return self.model.diverged(outputs)

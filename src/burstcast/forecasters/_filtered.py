"""A model with a filter in front: it starts from an estimate of the present state.

What separates a good model from a perfect forecast is mostly that it starts from one noisy
observation (`burstcast.forecasters.equations_noisy`). The washout holds more of them.

A filter whose model is wrong trusts it too much: the innovations, observations less forecasts, are
then larger than ensemble and noise expect. The inflation is the one under which the innovations in
the training series are most likely (Mitchell & Houtekamer, "An adaptive ensemble Kalman filter",
Monthly Weather Review 128, 2000).
"""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.exogenous import carry, of_series, of_washout
from burstcast.base.series_lengths import series_lengths
from burstcast.data.observation_noise import observation_noise
from burstcast.data.starting_points import SeriesPoints, segments
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters._options import FilterOptions, ObservationOptions
from burstcast.forecasters._square_root_filter import assimilate, mean, symmetric_members
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase, fitted

INFLATIONS = (1.0, 1.01, 1.02, 1.05, 1.1, 1.2, 1.4, 1.7, 2.0)
"""Inflations to choose from."""
_SEGMENTS = 64
"""Segments of the training series, a Lyapunov time long, that judge inflations, at most."""
_LARGE_INFLATION = 1.05
"""Inflation that tells of errors of the model; a smaller one makes up for the finite ensemble."""
_LOST = -1e9
"""Log-likelihood of a segment in which the filter is not finite."""


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
    #: inflation that the innovations in the training series ask for, where it is not given
    chosen_inflation: float | None = fitted()

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Fit the model; estimate the noise unless it is known (see `Forecaster.fit`)."""
        states, _ = of_series(training, case.system.dimension)
        errors = observation_noise(states, self.noise)
        model = self._unfitted_model.fit(training, case)
        filtered = self.with_fitted(model=model, errors=errors, chosen_inflation=None)
        if self.inflation is not None:
            return filtered
        return filtered._with_chosen_inflation(training, case.steps_per_lyapunov_time)

    @property
    def _unfitted_model(self) -> Forecaster:
        names = [option.name for option in self.model_class.option_fields()]
        return self.model_class(**{name: getattr(self, name) for name in names})

    def record(self) -> ForecasterRecord:
        """Learnt model and noise."""
        record, attributes = self.model.record(), {}
        if self.chosen_inflation is not None:
            attributes["inflation"] = self.chosen_inflation
        arrays = {**record.arrays, "noise": self.errors}
        return ForecasterRecord(arrays, {**record.attributes, **attributes})

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Restore the model, and put the filter before it."""
        model = self._unfitted_model.restore(record, case)
        chosen = record.attributes.get("inflation")
        return self.with_fitted(
            model=model,
            errors=record.arrays["noise"],
            chosen_inflation=None if chosen is None else float(chosen),
        )

    def tuned(self) -> Self:
        """Return a forecaster with the inflation that was chosen (see `ForecasterKind.tuned`)."""
        return self if self.chosen_inflation is None else replace(self, inflation=self._factor)

    def weaknesses(self) -> list[str]:
        """Sentences of the model, and one about innovations that it does not explain."""
        found = self.model.weaknesses()
        if self.chosen_inflation is not None and self.chosen_inflation >= _LARGE_INFLATION:
            found.append(
                f"the filter's observations lie further from its forecasts than noise and ensemble "
                f"explain: it inflates the ensemble by {self.chosen_inflation:g} before each of "
                "them (option inflation); the model errs, or the noise is not white"
            )
        return found

    @property
    def _factor(self) -> float:
        """Inflation, given or chosen."""
        given = self.chosen_inflation if self.inflation is None else self.inflation
        return 1.0 if given is None else given

    def _with_chosen_inflation(self, training: FloatArray, steps: int) -> Self:
        """Return this forecaster with the inflation under which innovations are most likely.

        The smallest one that is as good as the best but for its standard error; larger ones are not
        tried once the likelihood has fallen twice. ``steps``: Samples of a segment, a Lyapunov
        time.
        """
        points = _ends_of_segments(training, steps)
        if not len(points) or not (self.errors > 0).any():
            return replace(self, chosen_inflation=INFLATIONS[0])
        washouts = segments(training, points, steps - 1, 0)
        batch = np.ascontiguousarray(washouts.transpose(1, 2, 0))
        candidates: list[Self] = []
        logs: list[FloatArray] = []
        for factor in INFLATIONS:
            candidates.append(replace(self, chosen_inflation=factor))
            logs.append(candidates[-1]._log_likelihood(batch))
            if len(logs) > 2 and logs[-1].mean() < logs[-2].mean() < logs[-3].mean():
                break
        likely = np.array(logs)
        worse = likely[np.argmax(likely.mean(axis=1))] - likely
        bound = worse.std(axis=1, ddof=1) / np.sqrt(len(points)) if len(points) > 1 else 0.0
        return candidates[int(np.argmax(worse.mean(axis=1) <= bound))]

    def _log_likelihood(self, washout: FloatArray) -> FloatArray:
        """Log-likelihood of the observations of washouts, less a constant, ``(batch,)``.

        Of normal innovations after the first quarter of a washout; least where the filter loses
        the flow.
        """
        innovations: list[tuple[FloatArray, FloatArray]] = []
        with np.errstate(over="ignore", invalid="ignore"):
            self._assimilated(washout, innovations)
            noisy = self.errors > 0
            total = np.zeros(washout.shape[2])
            for off, variance in innovations[len(innovations) // 4 :]:
                each = np.log(variance[noisy]) + np.square(off[noisy]) / variance[noisy]
                total -= 0.5 * each.sum(axis=0)
        return np.where(np.isfinite(total), total, _LOST)

    def ensemble(self, washout: FloatArray) -> FloatArray:
        """Memories of the filter's members after a washout (see `Forecaster.ensemble`)."""
        return self._assimilated(washout)

    def _assimilated(
        self, washout: FloatArray, innovations: list[tuple[FloatArray, FloatArray]] | None = None
    ) -> FloatArray:
        """Memories of `ensemble`; innovations and their expected variances are appended."""
        states, past, ahead = of_washout(washout, len(self.errors))
        batch, memory = washout.shape[2], self.first_members(states[0])
        for step, observation in enumerate(states[1:]):
            in_force = np.tile(past[step : step + 1], (1, 1, self.members))
            outputs, memory = self.model.advance(carry(memory, in_force), 1)
            # the forecast of what is observed, and below it all that goes on from there
            rows = np.concatenate([outputs[0], memory.reshape(-1, memory.shape[-1])])
            rows = rows.reshape(-1, self.members, batch)
            if innovations is not None:
                seen = rows[: len(observation)]
                spread = np.square(self._factor) * seen.var(axis=1, ddof=1)
                variance = spread + np.square(self.errors)[:, np.newaxis]
                innovations.append((observation - mean(seen), variance))
            updated = self.corrected(rows, observation)
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
        return assimilate(ensemble, observation, self.errors, self._factor)

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


def _ends_of_segments(training: FloatArray, steps: int) -> SeriesPoints:
    """Last samples of disjoint segments, evenly among all of the training series."""
    lengths = series_lengths(training)
    ends = np.full(len(training), training.shape[1]) if lengths is None else lengths
    last = np.arange(steps - 1, training.shape[1], steps)
    series, step = (grid.ravel() for grid in np.meshgrid(np.arange(len(ends)), last, indexing="ij"))
    there = np.flatnonzero(step < ends[series])
    some = there[:: max(1, -(-len(there) // _SEGMENTS))]
    return SeriesPoints(series[some], step[some])

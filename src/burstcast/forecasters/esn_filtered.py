"""The echo state network that learns from smoothed series and starts from a filter's estimate.

The error of a network that is trained on noisy series is mostly the noise of its inputs (errors in
variables), and that of its forecasts mostly the noise of the washout. An ensemble filter
(`burstcast.forecasters._ensemble_smoother`) removes most of both: the trained network smooths its
own training series, it is trained again on the result with a little noise in the inputs, which
closed loops need to stay stable, and so on for some rounds; forecasts start from the same filter.
The hyperparameters come from the search of the kind `esn`.

Related: Brajard, Carrassi, Bocquet and Bertino, Journal of Computational Science 44 (2020) 101171,
and Tomizawa and Sawada, Geoscientific Model Development 14 (2021) 5623, train on analyses; Wikner
et al., Neural Networks 170 (2024) 94, study noise in inputs.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from burstcast.base import durations, random_streams
from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.left_out import LeftOut
from burstcast.base.series_lengths import held_after_the_end, samples_of, series_lengths
from burstcast.data.observation_noise import observation_noise
from burstcast.forecasters._ensemble_smoother import (
    Followed,
    follow,
    joined,
    opposite_pairs,
)
from burstcast.forecasters._options import FilteredNetworkOptions, ObservationOptions
from burstcast.forecasters._square_root_filter import mean
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.training import TrainingSeries, train, train_leaving_one_out

_SYNCHRONISATION = 12
"""Steps that the first observation drives a reservoir before the filter begins, in the place of
observations before it."""
_CORRECTED_STEPS = 3
"""Least number of observations of a washout that correct the ensemble after its start-up."""
_SERIES_PER_BATCH, _POINTS_PER_BATCH = 32, 16
"""Series that are smoothed side by side, and washouts: they bound the memory."""
_CONSISTENT = (0.8, 1.25)
"""Ratio of innovations to their expected size within which a filter is consistent."""
_MOST_REMOVED = 1.1
"""Noise removed from smoothed series, in units of the noise, beyond which dynamics go with it."""
_LARGE_ERROR = 2.0
"""Error of the network in a step, in units of the noise, from which observations outweigh it."""
_FORECAST_LT, _MOST_STARTS = 2, 1000
"""Length, and most starting points, of the forecasts that judge a round of denoising."""
_LOST = 100.0
"""Square error, in variances of a component, that counts for a forecast beyond it."""


@dataclass(frozen=True)
class FilteredNetwork(FilteredNetworkOptions, ObservationOptions, NetworkForecaster):
    """A network trained on smoothed series, whose forecasts start from an ensemble filter."""

    searched_as: ClassVar[str] = "esn"
    provides_ensemble: ClassVar[bool] = True
    has_filter: ClassVar[bool] = True

    errors: FloatArray = fitted()  #: standard deviation of the observation noise, ``(dimension,)``
    #: standard deviation of the network's error in a step, ``(dimension,)``
    model_error: FloatArray = fitted()
    #: mean square innovation over the expected one along the training series, ``(dimension,)``
    consistency: FloatArray = fitted()
    start_up: int = fitted()  #: steps of a washout that the members follow
    lag: int = fitted()  #: steps by which later observations correct a smoothed sample
    #: output weights of the network that smoothed the training series; None: they were not smoothed
    smoothing_weights: FloatArray | None = fitted()
    #: noise_left, noise_removed: of the training series after each round, as the smoother estimates
    #: it, and the distance from the observed ones, in units of the noise, ``(rounds, dimension)``
    noise_left: FloatArray = fitted()
    noise_removed: FloatArray = fitted()
    #: mean log10 square error of forecasts of series left out, before and after each round,
    #: ``(1 + rounds,)``; empty where no series is long enough or there is only one
    round_errors: FloatArray = fitted()

    def __post_init__(self) -> None:
        if self.denoising_rounds < 0:
            raise ValueError(f"denoising_rounds must be 0 at least, not {self.denoising_rounds}")
        if self.members < 4 or self.members % 2:
            raise ValueError(f"members must be even, and 4 at least, not {self.members}")
        if self.voters < 2 or self.voters > self.members or self.voters % 2:
            raise ValueError(
                f"voters must be even, and from 2 to members, {self.members}, not {self.voters}"
            )
        if not self.jitter >= 0:
            raise ValueError(f"jitter must not be negative, not {self.jitter}")

    def __repr__(self) -> str:
        if self.network is None:
            return f"FilteredNetwork(denoising_rounds={self.denoising_rounds})"
        return f"FilteredNetwork(seed {self.seed.seed}: {self.network!r}, {self.members} members)"

    def trained(
        self,
        dynamics: Dynamics,
        seed: ReservoirSeed,
        training: TrainingSeries,
        *,
        washout: int,
        tikhonov: float,
        steps_per_lyapunov_time: int,
    ) -> Self:
        """Train, smooth, and train again, as often as ``denoising_rounds`` says.

        Arguments are those of `NetworkForecaster.trained`. The round whose network forecasts best
        is kept, with readouts that have not learnt from the series that they forecast.
        """
        unit = steps_per_lyapunov_time
        start_up = durations.positive_steps(self.start_up_lt, unit, "esn_filtered.start_up_lt")
        lag = durations.positive_steps(self.lag_lt, unit, "esn_filtered.lag_lt")
        current = self.with_fitted(
            errors=observation_noise(training.observed, self.noise),
            start_up=start_up,
            lag=lag,
            seed=seed,
            **training.knowledge,
        )
        current._check_washout(washout)
        points = _validation_points(training.observed, washout, _FORECAST_LT * unit, unit)
        learnt, candidates, judged, smoothings = training, [], [], []
        for number in range(self.denoising_rounds + 1):
            readout = train(dynamics, learnt, washout=washout, tikhonov=tikhonov)
            network = EchoStateNetwork(
                dynamics, readout, training.input_range, training.input_offset
            )
            current = current.with_fitted(network=network)
            more = number < self.denoising_rounds
            followed = current._follow(training.observed, lag if more else 0, points.steps)
            current = current.with_fitted(
                model_error=followed.model_error, consistency=followed.consistency
            )
            candidates.append(current)
            if points.series.size:
                judged.append(
                    _round_error(network, learnt, followed, points, washout, training.observed)
                )
            if more:
                smoothings.append(followed)
                learnt = current._denoised(training, followed)
                current = current.with_fitted(smoothing_weights=readout.weights)
        best = int(np.argmin(judged)) if judged else self.denoising_rounds
        return candidates[best].with_fitted(
            noise_left=_in_units([smoothing.spread for smoothing in smoothings], current.errors),
            noise_removed=_in_units(
                [_distance(training.observed, each.smoothed) for each in smoothings],
                current.errors,
            ),
            round_errors=np.array(judged, dtype=np.float64),
        )

    @property
    def kept_round(self) -> int:
        """Round of denoising whose network is kept; 0: the one that was trained on noisy series."""
        return int(np.argmin(self.round_errors)) if self.round_errors.size else len(self.noise_left)

    def weaknesses(self) -> list[str]:
        """Sentences about a filter that misjudges errors, and rounds that did not help."""
        found = []
        low, high = _CONSISTENT
        if not ((self.consistency >= low) & (self.consistency <= high)).all():
            found.append(
                f"the filter misjudges its errors: its mean square innovations are "
                f"{_span(self.consistency)} times the expected ones (observation.noise)"
            )
        if self.noise_removed.size and self.noise_removed.max() > _MOST_REMOVED:
            found.append(
                f"smoothing removes {_span(self.noise_removed)} times the noise from the training "
                "series, and dynamics with it: sample them more often, or lower observation.noise"
            )
        there = self.errors > 0
        relative = float((self.model_error[there] / self.errors[there]).max(initial=0.0))
        if relative > _LARGE_ERROR:
            found.append(
                f"the network's error in a step is {relative:.2g} times the noise: the filter "
                "gains little over the last observation; take more neurons"
            )
        if self.denoising_rounds and self.kept_round == 0:
            found.append(
                "no round of denoising improved forecasts of series left out: the network that was "
                "trained on the observed series is kept (denoising_rounds)"
            )
        return found

    def leave_one_out(
        self,
        training: FloatArray,
        case: ForecastingCase,
        washout: int,
        left_out: Sequence[LeftOut] | None = None,
    ) -> Iterator[Self]:
        """Train the readout again without each series (see `Forecaster.leave_one_out`).

        The smoother of the other series, and the estimated errors, stay those of the fit.
        """
        series = self._training_series(training)
        order = np.arange(len(training))
        if (lengths := series_lengths(training)) is not None:
            order = np.argsort(-lengths, kind="stable")  # in the order of the fit
        learnt = series.part(order)
        if self.smoothing_weights is not None:
            network = self.network
            readout = replace(network.readout, weights=self.smoothing_weights)
            smoother = replace(self, network=replace(network, readout=readout))
            followed = smoother._follow(learnt.observed, self.lag)
            learnt = self._denoised(learnt, followed)
        readouts = train_leaving_one_out(
            self.network.dynamics,
            learnt.part(np.argsort(order)),
            washout=washout,
            tikhonov=self.network.readout.tikhonov,
            left_out=left_out,
        )
        for readout in readouts:
            yield replace(self, network=replace(self.network, readout=readout))

    def _denoised(self, training: TrainingSeries, followed: Followed) -> TrainingSeries:
        """Smoothed series, with inputs that have a little noise."""
        generator = random_streams.stream(self.seed.random_seed, "jitter of smoothed inputs")
        drawn = generator.standard_normal(training.observed.shape)
        inputs = followed.smoothed + self.jitter * self.errors * drawn
        return replace(training, observed=followed.smoothed, inputs=inputs)

    def _follow(self, observed: FloatArray, lag: int, keep: Sequence[int] = ()) -> Followed:
        """Smooth series, or filter them without a lag, and estimate the error of the model."""
        lengths = series_lengths(observed)
        held = held_after_the_end(observed)
        parts, sizes = [], []
        for first in range(0, len(held), _SERIES_PER_BATCH):
            rows = slice(first, first + _SERIES_PER_BATCH)
            parts.append(
                follow(
                    _DrivenNetwork(self.network),
                    held[rows],
                    self.errors,
                    self._numbers(),
                    None,
                    start_up=self.start_up,
                    lag=lag,
                    lengths=None if lengths is None else lengths[rows],
                    keep=keep,
                )
            )
            sizes.append(len(held[rows]))
        return joined(parts, sizes)

    def _numbers(self) -> Iterator[FloatArray]:
        return opposite_pairs(self.seed.random_seed, len(self.errors), self.members)

    def _check_washout(self, washout: int) -> None:
        least = self.start_up + _CORRECTED_STEPS
        if washout < least:
            raise ValueError(
                f"a washout of {washout} samples is too short for the filter of esn_filtered, "
                f"which takes {least} at least: {self.start_up} to start up (start_up_lt), and "
                f"{_CORRECTED_STEPS} that correct it; lengthen the washout (washout_lt)"
            )

    def ensemble(self, washout: FloatArray) -> FloatArray:
        """Reservoir states of the members that vote (see `Forecaster.ensemble`).

        They come in pairs, and their mean is that of all members.
        """
        self._check_washout(len(washout))
        half = self.voters // 2
        voting = [*range(half), *range(self.members // 2, self.members // 2 + half)]
        neurons, batch = self.network.dynamics.reservoir.neurons, washout.shape[2]
        ensemble = np.empty((neurons, self.voters, batch))
        for first in range(0, batch, _POINTS_PER_BATCH):
            points = slice(first, first + _POINTS_PER_BATCH)
            states = follow(
                _DrivenNetwork(self.network),
                washout[..., points].transpose(2, 0, 1),
                self.errors,
                self._numbers(),
                self.model_error,
                start_up=self.start_up,
            ).states
            voters = states[..., voting]
            shift = states.mean(axis=2) - voters.mean(axis=2)
            ensemble[..., points] = (voters + shift[..., np.newaxis]).transpose(0, 2, 1)
        return ensemble

    def combined(self, ensemble: FloatArray) -> FloatArray:
        """Mean of the members' states (see `Forecaster.combined`)."""
        return mean(ensemble)

    def start(self, washout: FloatArray) -> FloatArray:
        """Mean of the members' states after the washout, ``(neurons, batch)``."""
        return self.combined(self.ensemble(washout))

    def record(self) -> ForecasterRecord:
        """Record of a plain network, and what the filter and the rounds have estimated."""
        record = super().record()
        arrays = {name: getattr(self, field) for name, field in _RECORDED.items()}
        if self.smoothing_weights is not None:
            arrays["smoothing_weights"] = self.smoothing_weights
        attributes = {"start_up": self.start_up, "lag": self.lag}
        return ForecasterRecord({**record.arrays, **arrays}, {**record.attributes, **attributes})

    def _knowledge(self, record: ForecasterRecord, case: ForecastingCase) -> dict[str, Any]:
        arrays, attributes = record.arrays, record.attributes
        return {
            **{field: arrays[name] for name, field in _RECORDED.items()},
            "smoothing_weights": arrays.get("smoothing_weights"),
            "start_up": int(attributes["start_up"]),
            "lag": int(attributes["lag"]),
        }


_RECORDED = {
    "noise": "errors",
    "model_error": "model_error",
    "consistency": "consistency",
    "noise_left": "noise_left",
    "noise_removed": "noise_removed",
    "round_errors": "round_errors",
}
"""Arrays of a record, and the fields that hold them."""


@dataclass(frozen=True)
class _DrivenNetwork:
    """An echo state network as a `DrivenModel`."""

    network: EchoStateNetwork

    @property
    def hidden(self) -> slice:
        """Reservoir states are not smoothed."""
        return slice(0)

    def begin(self, samples: FloatArray, number: FloatArray) -> FloatArray:
        """Reservoir states that the mean of the samples has driven for some steps."""
        centre = samples.mean(axis=2)
        states = self.network.washout(np.tile(centre, (_SYNCHRONISATION, 1, 1)))
        return np.repeat(states[..., np.newaxis], samples.shape[2], axis=2)

    def predict(self, states: FloatArray) -> FloatArray:
        """Readout of reservoir states."""
        weights, dynamics = self.network.readout.weights, self.network.dynamics
        features = dynamics.features(states).transpose(1, 0, 2)
        # one product for each point: the sums of a larger one would depend on the batch
        predicted = np.matmul(weights[:-1].T, features) + weights[-1][:, np.newaxis]
        if self.network.input_offset is not None:
            predicted += self.network.input_offset[:, np.newaxis]
        return np.ascontiguousarray(predicted.transpose(1, 0, 2))

    def drive(self, states: FloatArray, samples: FloatArray, number: FloatArray) -> FloatArray:
        """Reservoir states after one more input."""
        side_by_side = samples.reshape(1, len(samples), -1)
        driven = self.network.washout(side_by_side, states.reshape(len(states), -1))
        return driven.reshape(states.shape)


@dataclass(frozen=True)
class _ValidationPoints:
    """Starting points of the forecasts that judge a round."""

    series: IntArray  #: row of the series of each, ``(points,)``
    step: IntArray  #: step at which each starts, ``(points,)``
    ahead: int  #: steps of the forecasts

    @property
    def steps(self) -> list[int]:
        """Steps at which there is a point."""
        return [int(step) for step in np.unique(self.step)]


def _validation_points(
    observed: FloatArray, washout: int, ahead: int, spacing: int
) -> _ValidationPoints:
    """Points in series that are followed for some time, evenly among all of them."""
    count, time, _ = observed.shape
    lengths = series_lengths(observed)
    ends = np.full(count, time) if lengths is None else lengths
    steps = np.arange(washout, time, spacing)
    series, step = (grid.ravel() for grid in np.meshgrid(np.arange(count), steps, indexing="ij"))
    there = step + ahead < ends[series] if count > 1 else np.zeros(series.size, dtype=bool)
    every = max(1, -(-int(there.sum()) // _MOST_STARTS))
    return _ValidationPoints(series[there][::every], step[there][::every], ahead)


def _round_error(
    network: EchoStateNetwork,
    learnt: TrainingSeries,
    followed: Followed,
    points: _ValidationPoints,
    washout: int,
    observed: FloatArray,
) -> float:
    """Mean log10 square error of forecasts by readouts of the other half of the series."""
    scale = samples_of(observed).std(axis=0)
    scale = np.where(scale > 0, scale, 1.0)[:, np.newaxis]
    errors = []
    for fold in range(2):
        others = np.flatnonzero(np.arange(learnt.series) % 2 != fold)
        readout = train(
            network.dynamics,
            learnt.part(others),
            washout=washout,
            tikhonov=network.readout.tikhonov,
        )
        here = points.series % 2 == fold
        places = list(zip(points.series[here], points.step[here], strict=True))
        states = np.stack([followed.kept[step][:, row] for row, step in places], axis=1)
        outputs, _ = replace(network, readout=readout).forecast(states, points.ahead)
        ahead = np.arange(1, points.ahead + 1)
        truth = np.stack([observed[row, step + ahead] for row, step in places], axis=2)
        with np.errstate(over="ignore", invalid="ignore"):
            square = np.square((outputs - truth) / scale).mean(axis=(0, 1))
        errors.append(np.nan_to_num(square, nan=_LOST, posinf=_LOST))
    return float(np.log10(np.clip(np.concatenate(errors), 1e-30, _LOST)).mean())


def _in_units(values: Sequence[FloatArray], noise: FloatArray) -> FloatArray:
    """Values ``(rounds, dimension)`` in units of the noise; 0 without noise."""
    filled = np.array(values, dtype=np.float64).reshape(-1, len(noise))
    return np.where(noise > 0, filled / np.where(noise > 0, noise, 1.0), 0.0)


def _distance(observed: FloatArray, smoothed: FloatArray) -> FloatArray:
    """Root mean square distance of two sets of series, ``(dimension,)``."""
    return np.asarray(np.sqrt(np.nanmean(np.square(observed - smoothed), axis=(0, 1))))


def _span(values: FloatArray) -> str:
    return f"{values.min():.2g} to {values.max():.2g}"

"""Learnt quadratic equations of the observed components and of variables that are never observed.

The hidden variables are first moving averages of monomials of what is observed
(`burstcast.systems.polynomials.hidden`). An ensemble smoother of the equations that are learnt with
them then estimates the training series, observed and hidden, and the equations are learnt again
from these, for some rounds. That equations are quadratic, and how many variables are hidden, is
prior knowledge. Hidden variables are determined up to a linear transformation, and to what the
observed components say of them.

An observable that is measured and depends on hidden variables is no variable of its own: it is
learnt as a quadratic function of them all (``observable_follows``).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, Self

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.left_out import LeftOut, rows_left_out
from burstcast.base.series_lengths import (
    held_after_the_end,
    padded,
    samples_of,
    series_lengths,
    without_padding,
)
from burstcast.data.observation_noise import observation_noise
from burstcast.forecasters._ensemble_smoother import (
    LEAST_ERROR,
    Followed,
    follow,
    opposite_pairs,
)
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters._options import HiddenQuadraticOptions, ObservationOptions
from burstcast.forecasters._square_root_filter import mean
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted
from burstcast.systems.integration import integrate
from burstcast.systems.polynomials.basis import denoised, monomials
from burstcast.systems.polynomials.hidden import HiddenSeries, hidden_series
from burstcast.systems.polynomials.regression import factored_coefficients
from burstcast.systems.polynomials.system import PolynomialSystem

_DEGREE = 2
_SIGNIFICANCE = 3.0
_FIRST_WINDOW_LT, _WINDOW_LT = 0.1, 0.065
"""Windows of the regression on observed series, and on smoothed ones."""
_HIDDEN_ERROR = 0.01
"""Error of the hidden variables in a step, in their standard deviations."""
_SETTLING_LT, _ENDING_LT = 1.6, 1.0
"""Beginning and end of smoothed series that nothing is learnt from."""
_REACH = 10.0
"""Largest size of a member of the filter, in units of the largest in training."""
_POINTS_PER_BATCH = 500
_FORECAST_LT, _MOST_STARTS = 2, 1000
"""Length, and most starting points, of the forecasts that judge a round."""
_LOST = 100.0
"""Square error, in variances of a component, that counts for a forecast beyond it."""
_CONSISTENT = (0.8, 1.25)
_STILL_IMPROVING = 0.05
"""Gain of the last round, in the mean log10 square error of forecasts, that suggests another."""
_TRUSTED = 1.1
"""Error of the equations, in units of the least, up to which it counts as the least."""
_LITTLE_EXPLAINED = 0.8
"""Share of the residual of equations without hidden variables from which none are seen."""


class _Learnt(NamedTuple):
    """What a round has learnt: equations, and how hidden variables follow from observed ones."""

    coefficients: FloatArray
    prior: FloatArray
    prior_root: FloatArray
    hidden_scale: FloatArray
    reach: FloatArray
    follows: FloatArray | None


@dataclass(frozen=True)
class HiddenQuadraticModel(HiddenQuadraticOptions, ObservationOptions, IntegratedForecaster):
    """Integrates learnt equations of observed and hidden variables from a filter's estimate."""

    may_diverge: ClassVar[bool] = True
    provides_ensemble: ClassVar[bool] = True
    has_filter: ClassVar[bool] = True

    #: coefficients of the equations of the observed components and then of the hidden variables,
    #: ``(monomials, components + hidden)``, in inverse time units
    coefficients: FloatArray = fitted()
    #: prior, prior_root: regression of hidden variables on 1 and the observed components,
    #: ``(1 + components, hidden)``, and a square root of the covariance of its residuals
    prior: FloatArray = fitted()
    prior_root: FloatArray = fitted()
    errors: FloatArray = fitted()  #: standard deviation of the observation noise, ``(components,)``
    #: standard deviation of the error of the equations in a step, ``(components,)``
    model_error: FloatArray = fitted()
    hidden_scale: FloatArray = fitted()  #: standard deviation of the hidden variables
    #: largest size that members of the filter keep, ``(components + hidden,)``
    reach: FloatArray = fitted()
    #: coefficients of an observable that follows, ``(monomials,)``; None: there is none
    follows: FloatArray | None = fitted()
    place: int = fitted()  #: component that follows; -1: none
    random_seed: int = fitted()  #: root of the random numbers of the ensemble
    rates: FloatArray = fitted()  #: chosen rates of the moving averages, per Lyapunov time
    #: residual of the first equations, as a share of the one without hidden variables
    explained: float = fitted()
    #: mean log10 square error of forecasts after each round, ``(1 + rounds,)``
    round_errors: FloatArray = fitted()
    consistency: FloatArray = fitted()  #: mean square innovation over the expected one

    def __post_init__(self) -> None:
        if self.hidden < 0:
            raise ValueError(f"hidden must be 0 at least, not {self.hidden}")
        if self.rounds < 0:
            raise ValueError(f"rounds must be 0 at least, not {self.rounds}")
        if self.members < 4 or self.members % 2:
            raise ValueError(f"members must be even, and 4 at least, not {self.members}")
        if self.conserved and not self.observable_follows:
            raise ValueError("conserved takes an observable that follows (observable_follows)")
        if not self.rates_per_lt or min(self.rates_per_lt) <= 0:
            raise ValueError(f"rates_per_lt must be above 0, not {self.rates_per_lt}")

    def __repr__(self) -> str:
        if self.coefficients is None:
            return f"HiddenQuadraticModel(hidden={self.hidden}, rounds={self.rounds})"
        terms = int((self.coefficients != 0).sum())
        return f"HiddenQuadraticModel({terms} terms, {self.hidden} hidden variables)"

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Find hidden variables, and learn the equations in rounds (see `Forecaster.fit`)."""
        unit, interval = case.steps_per_lyapunov_time, case.time_step * case.sampling_stride
        place = self._place(training, case)
        observed, followed_by = _parted(training, place)
        errors = observation_noise(observed, self.noise)
        window = max(2, durations.steps(_FIRST_WINDOW_LT, unit))
        found = self._found(observed, errors, max(2, 2 * window // 3), unit)
        states, follows, first = observed, followed_by, 0
        if found is not None:
            first, rows = found.first, found.rows
            parts = [part[first:] for part in without_padding(observed[rows])]
            states = padded(
                [np.concatenate(pair, axis=1) for pair in zip(parts, found.series, strict=True)]
            )
            follows = None if followed_by is None else followed_by[rows]
        common = {
            "errors": errors,
            "place": place,
            "random_seed": case.random_seed,
            "rates": np.array(() if found is None else found.rates) * unit,
            "explained": float("nan") if found is None else found.explained,
            "time_step": case.time_step,
            "sampling_stride": case.sampling_stride,
        }
        noise = np.concatenate([errors, np.zeros(self.hidden)])
        points = _starts(observed, _FORECAST_LT * unit, unit)
        candidates: list[Self] = []
        judged: list[float] = []
        for number in range(self.rounds + 1):
            learnt = _learnt(
                states, noise, interval, window, follows, first, len(errors), self.conserved
            )
            current = self._with(learnt, case, **common)
            followed = current._follow(observed, unit, points[0])
            current = current.with_fitted(
                model_error=followed.model_error, consistency=followed.consistency
            )
            candidates.append(current)
            if points[0]:
                judged.append(_error(current, observed, followed, points, _FORECAST_LT * unit))
            if number < self.rounds:
                states, first = _settled(followed.smoothed, observed, unit)
                noise, window = np.zeros_like(noise), max(2, durations.steps(_WINDOW_LT, unit))
                follows = followed_by
        best = int(np.argmin(judged)) if judged else self.rounds
        return candidates[best].with_fitted(round_errors=np.array(judged, dtype=np.float64))

    def _found(
        self, observed: FloatArray, errors: FloatArray, window: int, unit: int
    ) -> HiddenSeries | None:
        """First estimate of hidden variables; None: there are none."""
        if not self.hidden:
            return None
        rates = [rate / unit for rate in self.rates_per_lt]
        return hidden_series(without_padding(observed), errors, self.hidden, rates, window)

    def _place(self, training: FloatArray, case: ForecastingCase) -> int:
        """Component that is the observable and follows from the others; -1 for none."""
        if not self.observable_follows:
            return -1
        samples = samples_of(training)
        equal = [
            component
            for component in range(samples.shape[1])
            if np.array_equal(case.system.observable(samples.T), samples[:, component])
        ]
        if not equal:
            raise ValueError(
                "observable_follows takes series one of whose components is the observable"
            )
        return equal[0]

    def _with(self, learnt: _Learnt, case: ForecastingCase, **common: object) -> Self:
        system = PolynomialSystem(learnt.coefficients, _DEGREE, case.system)
        return self.with_fitted(system=system, **learnt._asdict(), **common)

    def _follow(self, observed: FloatArray, unit: int, keep: list[int]) -> Followed:
        """Smooth observed components and hidden variables; estimate the equations' error."""
        return follow(
            _DrivenEquations(self),
            held_after_the_end(observed),
            self.errors,
            self._numbers(),
            None,
            start_up=1,
            lag=durations.positive_steps(
                self.smoothing_lag_lt, unit, "quadratic_hidden.smoothing_lag_lt"
            ),
            lengths=series_lengths(observed),
            keep=keep,
        )

    def _numbers(self) -> Iterator[FloatArray]:
        size = len(self.errors) + self.hidden
        return opposite_pairs(self.random_seed, size, self.members)

    def leave_one_out(
        self,
        training: FloatArray,
        case: ForecastingCase,
        washout: int,
        left_out: Sequence[LeftOut] | None = None,
    ) -> Iterator[Self]:
        """Learn the equations again without each series (see `Forecaster.leave_one_out`).

        Hidden variables and noise stay as the smoother of the whole fit finds them.
        """
        rows_of_each = rows_left_out(len(training), left_out)
        unit, interval = case.steps_per_lyapunov_time, case.time_step * case.sampling_stride
        observed, followed_by = _parted(training, self.place)
        followed = self._follow(observed, unit, [])
        states, first = _settled(followed.smoothed, observed, unit)
        window = max(2, durations.steps(_WINDOW_LT, unit))
        noise = np.zeros(states.shape[2])
        for rows in rows_of_each:
            others = np.delete(np.arange(len(training)), rows)
            follows = None if followed_by is None else followed_by[others]
            learnt = _learnt(
                states[others],
                noise,
                interval,
                window,
                follows,
                first,
                len(self.errors),
                self.conserved,
            )
            # in the units of the variables that the prior is about
            yield self._with(learnt, case)

    def weaknesses(self) -> list[str]:
        """Sentences about hidden variables that are not seen, and a filter that misjudges."""
        found, (low, high) = [], _CONSISTENT
        if self.hidden and self.explained > _LITTLE_EXPLAINED:
            found.append(
                f"hidden variables explain little: equations with them leave {self.explained:.2g} "
                "times what equations without them leave (hidden, rates_per_lt)"
            )
        edges = min(self.rates_per_lt), max(self.rates_per_lt)
        on_edge = np.isclose(self.rates[:, np.newaxis], edges).any(axis=1)
        # two averages are taken at once; one hidden variable needs one
        if (
            self.hidden
            and len(self.rates_per_lt) > 2
            and (~on_edge).sum() < min(self.hidden, len(self.rates))
        ):
            found.append(
                f"a rate of the moving averages is on the edge of its search, "
                f"{self.rates[on_edge][0]:.3g} per Lyapunov time: search beyond it (rates_per_lt)"
            )
        if not ((self.consistency >= low) & (self.consistency <= high)).all():
            found.append(
                "the filter misjudges its errors: its mean square innovations are "
                f"{self.consistency.min():.2g} to {self.consistency.max():.2g} times the expected "
                "ones (observation.noise)"
            )
        if self.rounds and self.round_errors.size and int(np.argmin(self.round_errors)) == 0:
            found.append("no round of smoothing improved forecasts (quadratic_hidden.rounds)")
        if self.rounds and self.round_errors.size:
            gain = float(self.round_errors[-2] - self.round_errors[-1])
            if gain > _STILL_IMPROVING:
                found.append(
                    f"the last round of smoothing lowered the log10 square error of forecasts by "
                    f"{gain:.2g}: more may help (quadratic_hidden.rounds)"
                )
        there = self.errors > 0
        if (self.model_error[there] <= _TRUSTED * LEAST_ERROR * self.errors[there]).any():
            found.append(
                "the smoother follows its own equations: their estimated error in a step is as "
                "small as it may be in some component (quadratic_hidden.rounds, observation.noise)"
            )
        return found

    def record(self) -> ForecasterRecord:
        """Equations, and what the filter starts from."""
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        if self.follows is not None:
            arrays["follows"] = self.follows
        return ForecasterRecord(arrays, {name: getattr(self, name) for name in _NUMBERS})

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Make the equations from their coefficients."""
        numbers = record.attributes
        system = PolynomialSystem(record.arrays["coefficients"], _DEGREE, case.system)
        return self.with_fitted(
            system=system,
            time_step=case.time_step,
            sampling_stride=case.sampling_stride,
            follows=record.arrays.get("follows"),
            **{name: record.arrays[name] for name in _ARRAYS},
            **{name: kind(numbers[name]) for name, kind in _NUMBERS.items()},
        )

    def ensemble(self, washout: FloatArray) -> FloatArray:
        """Observed and hidden variables of the members (see `Forecaster.ensemble`)."""
        batch = washout.shape[2]
        states = np.empty((self.memory_size, self.members, batch))
        if len(washout) < 2:
            raise ValueError("quadratic_hidden takes a washout of 2 samples at least (washout_lt)")
        observed = washout if self.place < 0 else np.delete(washout, self.place, axis=1)
        for first in range(0, batch, _POINTS_PER_BATCH):
            points = slice(first, first + _POINTS_PER_BATCH)
            model = _DrivenEquations(self, ends=len(washout) - 1)
            followed = follow(
                model,
                observed[..., points].transpose(2, 0, 1),
                self.errors,
                self._numbers(),
                self.model_error,
                start_up=1,
            )
            states[..., points] = followed.states.transpose(0, 2, 1)
        return states

    def combined(self, ensemble: FloatArray) -> FloatArray:
        """Mean of the members (see `Forecaster.combined`)."""
        return mean(ensemble)

    def start(self, washout: FloatArray) -> FloatArray:
        """Mean of the members after the washout, ``(components + hidden, batch)``."""
        return self.combined(self.ensemble(washout))

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Integrate the equations; forecasts have the observed components alone."""
        states, memory = super().advance(memory, steps)
        return self._outputs(states), memory

    def _outputs(self, states: FloatArray) -> FloatArray:
        """Components of a sample, from states ``(steps, components + hidden, batch)``."""
        outputs: FloatArray = states[:, : len(self.errors)]
        if self.follows is None:
            return np.ascontiguousarray(outputs)
        with np.errstate(over="ignore", invalid="ignore"):
            values = _values(states.transpose(0, 2, 1))
            follows = np.zeros(states.shape[::2])
            # one after the other: the sum of a product of matrices would depend on the batch
            for weight, value in zip(self.follows, values, strict=True):
                follows += weight * value
        return np.asarray(np.insert(outputs, self.place, follows, axis=1))


_ARRAYS = (
    *("coefficients", "prior", "prior_root", "errors", "model_error", "hidden_scale", "reach"),
    *("rates", "round_errors", "consistency"),
)
_NUMBERS = {"place": int, "random_seed": int, "explained": float}
"""Fields of a record: arrays, and numbers with their types."""


class _DrivenEquations:
    """Equations as a model that the filter drives by corrected samples.

    ``ends``: Step after whose sample the states are not advanced; None: there is none.
    """

    def __init__(self, model: HiddenQuadraticModel, ends: int | None = None) -> None:
        self._model, self._ends, self._step = model, ends, 0
        self._observed = len(model.errors)

    @property
    def hidden(self) -> slice:
        return slice(self._observed, None)

    def begin(self, samples: FloatArray, number: FloatArray) -> FloatArray:
        model = self._model
        size, batch, members = samples.shape
        hidden = np.tile(model.prior[0][:, np.newaxis, np.newaxis], (1, batch, members))
        for component in range(size):
            hidden += np.multiply.outer(model.prior[1 + component], samples[component])
        hidden += (model.prior_root @ number[size:])[:, np.newaxis]
        return np.concatenate([samples, hidden])

    def predict(self, states: FloatArray) -> FloatArray:
        return states[: self._observed]

    def drive(self, states: FloatArray, samples: FloatArray, number: FloatArray) -> FloatArray:
        model = self._model
        now = np.concatenate([samples, states[self._observed :]])
        self._step += 1
        if self._ends is not None and self._step > self._ends:
            return now
        flat = np.ascontiguousarray(now.reshape(len(now), -1))
        with np.errstate(over="ignore", invalid="ignore"):
            stride = model.sampling_stride
            ahead = integrate(
                model.system, flat, model.time_step, stride, stride=stride, may_diverge=True
            )[-1].reshape(now.shape)
        reach = model.reach[:, np.newaxis, np.newaxis]
        ahead = np.clip(np.nan_to_num(ahead, nan=np.inf, posinf=np.inf), -reach, reach)
        error = _HIDDEN_ERROR * model.hidden_scale[:, np.newaxis] * number[self._observed :]
        ahead[self._observed :] += error[:, np.newaxis]
        return np.asarray(ahead)


def _parted(training: FloatArray, place: int) -> tuple[FloatArray, FloatArray | None]:
    """Components of the equations, and the one that follows from them, ``(series, time)``."""
    if place < 0:
        return training, None
    return np.ascontiguousarray(np.delete(training, place, axis=2)), training[..., place]


def _values(states: FloatArray) -> FloatArray:
    """Monomials of states ``(..., dimension)``, ``(monomials, ...)``."""
    dimension = states.shape[-1]
    values: FloatArray = denoised(states, np.zeros(dimension), monomials(dimension, _DEGREE))
    return values


def _learnt(
    states: FloatArray,
    noise: FloatArray,
    interval: float,
    window: int,
    follows: FloatArray | None,
    first: int,
    observed: int,
    conserved: bool,
) -> _Learnt:
    """Learn equations from series of observed and hidden variables, from sample ``first`` on.

    ``conserved``: Whether quadratic terms leave the observable that follows as it is.
    """
    samples = samples_of(states)
    known = np.column_stack([np.ones(len(samples)), samples[:, :observed]])
    hidden = samples[:, observed:]
    prior = np.linalg.lstsq(known, hidden, rcond=None)[0]
    left = hidden - known @ prior
    covariance = left.T @ left / max(1, len(left) - 1)
    scale = hidden.std(axis=0)
    root = np.linalg.cholesky(covariance + 1e-12 * np.diag(np.square(scale) + 1e-300))
    weights: FloatArray | None = None
    if follows is not None:
        there = ~np.isnan(states[..., 0])
        targets = follows[:, first : first + states.shape[1]][there]
        weights = np.asarray(np.linalg.lstsq(_values(samples).T, targets, rcond=None)[0])
    coefficients = factored_coefficients(
        np.ascontiguousarray(states),
        noise,
        interval,
        _DEGREE,
        window,
        _SIGNIFICANCE,
        conserved=_form(weights, states.shape[2]) if conserved else None,
    )[0]
    reach = _REACH * np.abs(samples).max(axis=0)
    return _Learnt(coefficients, np.asarray(prior), np.asarray(root), scale, reach, weights)


def _form(weights: FloatArray | None, dimension: int) -> FloatArray:
    """Matrix of the quadratic terms of a function with these weights of the monomials."""
    form = np.zeros((dimension, dimension))
    if weights is not None:
        rows, columns = np.triu_indices(dimension)
        form[rows, columns] = weights[1 + dimension :]
    return np.asarray(form + form.T) / 2


def _settled(smoothed: FloatArray, observed: FloatArray, unit: int) -> tuple[FloatArray, int]:
    """Smoothed series without their beginnings and ends, and the first sample that is left."""
    first, last = durations.steps(_SETTLING_LT, unit), durations.steps(_ENDING_LT, unit)
    lengths = series_lengths(observed)
    ends = [observed.shape[1]] * len(observed) if lengths is None else lengths.tolist()
    parts = [
        series[first : max(first, end - last)] for series, end in zip(smoothed, ends, strict=True)
    ]
    return padded(parts), first


def _starts(observed: FloatArray, ahead: int, spacing: int) -> tuple[list[int], IntArray]:
    """Steps from which forecasts judge a round, and the series that are long enough for them."""
    lengths = series_lengths(observed)
    ends = np.full(len(observed), observed.shape[1]) if lengths is None else lengths
    rows = np.flatnonzero(ends > ahead + spacing + 2)
    shortest = int(ends[rows].min()) if rows.size else 0
    steps = list(range(spacing, shortest - ahead - 1, spacing))
    return steps[:: max(1, -(-len(steps) * len(rows) // _MOST_STARTS))], rows


def _error(
    model: HiddenQuadraticModel,
    observed: FloatArray,
    followed: Followed,
    points: tuple[list[int], IntArray],
    ahead: int,
) -> float:
    """Mean log10 square error of forecasts of the observed components."""
    steps, rows = points
    scale = samples_of(observed).std(axis=0)[:, np.newaxis]
    # a state that was kept is the forecast for the next sample
    memory = np.concatenate([followed.kept[step][:, rows] for step in steps], axis=1)
    states = IntegratedForecaster.advance(model, memory, ahead)[0][:, : observed.shape[2]]
    truth = np.concatenate(
        [observed[rows, step + 2 : step + 2 + ahead].transpose(1, 2, 0) for step in steps], axis=2
    )
    with np.errstate(over="ignore", invalid="ignore"):
        square = np.square((states[: len(truth)] - truth) / scale).mean(axis=(0, 1))
    square = np.nan_to_num(square, nan=_LOST, posinf=_LOST)
    return float(np.log10(np.clip(square, 1e-30, _LOST)).mean())

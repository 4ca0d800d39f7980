"""From series to probabilities of extreme events, in the habits of scikit-learn.

`EventForecaster` does for one set of series what the workflow does for a case: it searches the
hyperparameters of a committee of networks, trains them, and calibrates the share of them that
forecast an event by honest forecasts of the training series. It has no numerics of its own.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self, cast

import numpy as np

from burstcast import durations
from burstcast.arrays import BoolArray, FloatArray
from burstcast.backends import usable_backend
from burstcast.dataset import Scales, component_scales, observed_series
from burstcast.discovery import suggestion
from burstcast.estimator import Estimator
from burstcast.event_threshold import threshold_at
from burstcast.forecast.starting_points import SeriesPoints, segments, starting_points
from burstcast.forecast.windows import WindowSummaries, crosses, forecast_summaries, summarise
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase
from burstcast.forecasters.registry import forecaster_class
from burstcast.probability.alarms import best_threshold
from burstcast.probability.calibration import UNCALIBRATED, Calibration, isotonic
from burstcast.probability.members import (
    EnsembleForecaster,
    has_members,
    leave_one_out_member_summaries,
    member_forecasts,
    member_summaries,
)
from burstcast.probability.out_of_sample import leave_one_out_summaries
from burstcast.probability.outcomes import Outcomes, outcomes_by_series
from burstcast.probability.scores import probability_scores
from burstcast.probability.votes import share_of_votes
from burstcast.series_layout import as_series
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_system, parameters_of
from burstcast.systems.state_space import StateSpace

NETWORKS = "esn"
"""The kind whose hyperparameters are searched, and of which there is a committee."""

DEFAULT_OPTIONS: Mapping[str, Mapping[str, Any]] = {
    "esn": {"connectivity": 20, "input_bias": 0.1, "divergence_bound": 10, "backend": "compiled"},
    "equations_filtered": {"noise": None, "members": 40, "inflation": 1},
    "quadratic": {"noise": None, "degree": 2, "window_lt": 0.2, "significance": 4},
    "quadratic_filtered": {
        "noise": None,
        "degree": 2,
        "window_lt": 0.2,
        "significance": 4,
        "members": 40,
        "inflation": 1,
    },
    "analogues": {"neighbours": 10},
}
"""Options of the kinds of forecasters that have any, as the workflow's config has them."""

# What is validated on one open loop in the workflow, too: the sums then have the same bits.
_VALIDATED_TOGETHER = ("RV", "SSV")
_TOP_TWENTIETH: Mapping[str, float] = {"quantile": 0.95}
# Validation intervals in more series take longer, and the paper has no more.
_MOST_VALIDATION_SERIES = 4
_BINS = 11
_FORMAT = 1


@dataclass(frozen=True)
class Alarm:
    """How a probability at one prediction time comes about, and when it is an alarm.

    Attributes
    ----------
    calibration
        From the share of votes to the probability.
    threshold
        Probability from which on `EventForecaster.predict` says that an event follows.
    """

    calibration: Calibration
    threshold: float


class EventForecaster(Estimator):
    """Forecasts extreme events of chaotic series, with probabilities.

    Series are arrays ``(series, time, component)`` of NumPy or xarray (`burstcast.series_layout`).
    An event of the observable in a prediction window is a crossing of the event threshold: it is
    below it at the window's first step, and at or above it later on. Durations are in Lyapunov
    times where ``lyapunov_time`` is given, and in samples otherwise; they are rounded down to whole
    samples.

    Parameters
    ----------
    observable
        Whose events are forecast: the index of a component, a function from states
        ``(..., component)`` to ``(...)``, or a system, whose observable it is then.
    event_threshold
        A number in units of the observable, or ``{"quantile": q}`` of the observable of the
        training series.
    prediction_times
        From the present to the beginning of the window; the first is the default everywhere.
    window
        Length of the prediction window.
    lyapunov_time
        In the unit of time of ``sampling_interval``; None: all durations are in samples.
    sampling_interval
        Time between two samples.
    washout
        What a forecaster is given before it starts.
    kind
        Of forecasters, a module of `burstcast.forecasters`: "esn", "quadratic", "analogues", ...
    members
        Networks of the committee. Of other kinds, the members of a forecaster's ensemble vote
        (filters, analogues), or it votes alone, with 0 and 1.
    neurons
        Size of each network.
    validation
        Strategy of validation: "RV", "SSV", "WFV" (`burstcast.tuning.strategies`).
    validation_interval
        Length of a validation interval.
    validation_series, intervals_per_series
        Training series with validation intervals, and how many each has; None: four series, or all
        if there are fewer, and as many intervals as fit.
    spectral_radius, input_scaling
        Bounds of the search, which is logarithmic.
    tikhonov
        Tikhonov parameters, the best of which is taken.
    grid, bayesian_points
        Points of the search: a grid of so many in each direction, then Bayesian optimisation.
    calibrate
        Whether probabilities are calibrated by forecasts of each training series by readouts that
        have not seen it; it takes two series. Otherwise they are shares of votes.
    prior_forecasts
        As how many forecasts each share of votes counts that came true as it says.
    calibration_spacing, start_spacing
        Distance of the starting points that probabilities are calibrated on, and scored on.
    noise
        Observation noise that is added to the training series, in standard deviations of each
        component: 0 for what was measured.
    sampling_stride
        Integration steps in a sample, for kinds that integrate equations.
    options
        Of the kind, laid over `DEFAULT_OPTIONS`.
    random_seed, case
        Root of all random numbers, and the name of the case in their streams: a case of the
        workflow with the same settings has the same networks, bit for bit.

    Attributes
    ----------
    members_
        The forecasters: one where the members of its ensemble vote.
    hyperparameters_
        What the search has found for each network.
    event_threshold_
        In units of the observable.
    alarms_
        Calibrations and thresholds (`Alarm`) by prediction time.
    classes_
        False and True, the columns of `predict_proba`.
    """

    def __init__(
        self,
        observable: int | Callable[[FloatArray], FloatArray] | DynamicalSystem = 0,
        event_threshold: float | Mapping[str, float] = _TOP_TWENTIETH,
        *,
        prediction_times: Sequence[float] = (1.0,),
        window: float = 1.0,
        lyapunov_time: float | None = None,
        sampling_interval: float = 1.0,
        washout: float = 0.5,
        kind: str = NETWORKS,
        members: int = 10,
        neurons: int = 500,
        validation: str = "RV",
        validation_interval: float = 2.0,
        validation_series: int | None = None,
        intervals_per_series: int | None = None,
        spectral_radius: tuple[float, float] = (0.1, 1.0),
        input_scaling: tuple[float, float] = (0.1, 10.0),
        tikhonov: Sequence[float] = (1e-6, 1e-9, 1e-12),
        grid: int = 4,
        bayesian_points: int = 9,
        calibrate: bool = True,
        prior_forecasts: float = 30.0,
        calibration_spacing: float = 0.25,
        start_spacing: float = 1.0,
        noise: float = 0.0,
        sampling_stride: int = 1,
        options: Mapping[str, Any] | None = None,
        random_seed: int = 0,
        case: str = "series",
    ) -> None:
        self.observable = observable
        self.event_threshold = event_threshold
        self.prediction_times = prediction_times
        self.window = window
        self.lyapunov_time = lyapunov_time
        self.sampling_interval = sampling_interval
        self.washout = washout
        self.kind = kind
        self.members = members
        self.neurons = neurons
        self.validation = validation
        self.validation_interval = validation_interval
        self.validation_series = validation_series
        self.intervals_per_series = intervals_per_series
        self.spectral_radius = spectral_radius
        self.input_scaling = input_scaling
        self.tikhonov = tikhonov
        self.grid = grid
        self.bayesian_points = bayesian_points
        self.calibrate = calibrate
        self.prior_forecasts = prior_forecasts
        self.calibration_spacing = calibration_spacing
        self.start_spacing = start_spacing
        self.noise = noise
        self.sampling_stride = sampling_stride
        self.options = options
        self.random_seed = random_seed
        self.case = case

    # -- what a user calls -------------------------------------------------------------------------

    def fit(self, series: Any, y: None = None) -> Self:
        """Search, train, and calibrate.

        Parameters
        ----------
        series
            Training series, ``(series, time, component)``.
        y
            Nothing: events are found in the series themselves.

        Raises
        ------
        ValueError
            If a parameter is out of bounds, or the series are too few or too short for it.
        """
        states = as_series(series, "the training series")
        kind, boundaries = forecaster_class(self.kind), self._boundaries()
        case = self._case(states.shape[2])
        value = self._observable(case.system, states)
        threshold = self._threshold(value)
        washout = self._steps("washout")
        scales = component_scales(states)
        observed = self._observed(states, scales, kind)
        points = self._points(states, self._steps("calibration_spacing"), boundaries)
        if self.calibrate and len(states) < 2:
            raise ValueError(
                "calibrating leaves one series out and takes two at least: give more series, or "
                "calibrate=False"
            )
        if self.kind == NETWORKS:
            members, found = self._networks(observed, scales, case.system, washout)
        else:
            members, found = [kind.fit(observed, case)], []
        # nothing of a former fit is left before all can be replaced
        self.members_ = members
        self.hyperparameters_ = found
        self.components_ = states.shape[2]
        self.event_threshold_ = threshold
        self.classes_ = np.array([False, True])
        self.alarms_ = dict.fromkeys(self._times(), Alarm(UNCALIBRATED, 0.5))
        if self.calibrate:
            washouts = segments(observed, points, washout - 1, 0)
            votes = self._out_of_sample(observed, case, washouts, points, boundaries)
            for time in self._times():
                outcomes = self._outcomes(states, observed, points, votes, time).total()
                if not outcomes.levels.size:
                    raise ValueError(
                        f"no starting point is left to calibrate with: the observable reaches the "
                        f"event threshold {threshold:.4g} in every washout"
                    )
                calibration = isotonic(outcomes, self.prior_forecasts)
                levels = outcomes.at(calibration(outcomes.levels))
                self.alarms_[time] = Alarm(
                    calibration, best_threshold(levels.levels, levels.points)
                )
        return self

    def forecast(self, series: Any, duration: float | None = None) -> FloatArray:
        """Forecasts of all members, from the last sample of each series on.

        Parameters
        ----------
        series
            What has been observed up to the present, ``(series, time, component)``: the washout at
            least. Only its last samples count, as many as the washout has.
        duration
            How far; None: to the end of the last prediction window.

        Returns
        -------
        ``(member, series, time, component)``; the first sample is the one after the present.
        """
        steps = self._boundaries()[-1] if duration is None else self._whole("duration", duration, 1)
        washouts = np.ascontiguousarray(self._washouts(series).transpose(1, 2, 0))
        with _divergence_is_a_result():
            if (ensemble := self._ensemble()) is not None:
                return member_forecasts(ensemble, washouts, steps).transpose(2, 3, 0, 1)
            outputs = [
                member.advance(member.start(washouts), steps)[0].transpose(2, 0, 1)
                for member in self.members_
            ]
        return np.stack(outputs)

    def predict_proba(self, series: Any, prediction_time: float | None = None) -> FloatArray:
        """Probability of no event, and of one, in the window at a prediction time.

        Parameters
        ----------
        series
            As for `forecast`.
        prediction_time
            One of ``prediction_times``; None: the first.

        Returns
        -------
        ``(series, 2)``: the columns are ``classes_``, so that ``[:, 1]`` is that of an event.
        """
        time = self._time(prediction_time)
        shares = self._shares(self._summaries(self._washouts(series)), time)
        probability = self.alarms_[time].calibration(shares)
        return np.stack([1 - probability, probability], axis=1)

    def predict(self, series: Any, prediction_time: float | None = None) -> BoolArray:
        """Alarms: whether the probability of an event is high enough (see `Alarm`).

        Parameters
        ----------
        series, prediction_time
            As for `predict_proba`.

        Returns
        -------
        ``(series,)``.
        """
        probability = self.predict_proba(series, prediction_time)[:, 1]
        return np.asarray(probability >= self.alarms_[self._time(prediction_time)].threshold)

    def scores(self, series: Any, prediction_time: float | None = None) -> dict[str, float]:
        """All scores of the probabilities, and of the alarms that they raise, in series.

        Forecasts start all over the series, ``start_spacing`` apart, but where an event is under
        way already: where the observable reaches the threshold in the washout.

        Parameters
        ----------
        series
            Nothing of which was used in training.
        prediction_time
            One of ``prediction_times``; None: the first.

        Returns
        -------
        By name: "f_score", "precision", "recall", "brier_skill", "roc_area", ...
        (`burstcast.probability.scores`), and "forecasts" and "events", how many there were. NaN
        where a score is not defined, as that of alarms where nothing happened.
        """
        time = self._time(prediction_time)
        states = self._like_training(as_series(series))
        points = self._points(states, self._steps("start_spacing"), self._boundaries())
        washouts = segments(states, points, self._steps("washout") - 1, 0)
        raw = self._outcomes(states, states, points, self._summaries(washouts), time).total()
        alarm = self.alarms_[time]
        outcomes = raw.at(alarm.calibration(raw.levels))
        found = probability_scores(outcomes, alarm.threshold, _BINS)
        return {
            "forecasts": int(outcomes.points.sum()),
            "events": int(outcomes.events.sum()),
            **{name: float(value) for name, value in found.items()},
        }

    def score(self, series: Any, y: None = None) -> float:
        """F-score of the alarms at the first prediction time (see `scores`)."""
        return self.scores(series)["f_score"]

    def save(self, path: str | Path) -> None:
        """Write all that was fitted to a NetCDF file, nothing of it pickled.

        A function or a system of one's own as the observable is not written: `load` takes it again.

        Raises
        ------
        ImportError
            If what writes the workflow's files is not installed: burstcast[workflow].
        """
        self._check_fitted()
        storage = _storage()
        variables, members = {}, []
        for number, member in enumerate(self.members_):
            record = member.record()
            members.append(dict(record.attributes))
            for name, array in record.arrays.items():
                label = f"member{number}_{name}"
                axes = tuple(f"{label}_{axis}" for axis in range(array.ndim))
                meaning = f"{name.replace('_', ' ')} of member {number}"
                variables[label] = storage.Variable(axes, array, "1", meaning)
        fitted = {
            "components": self.components_,
            "event_threshold": self.event_threshold_,
            "hyperparameters": self.hyperparameters_,
            "members": members,
            "alarms": [
                {
                    "prediction_time": time,
                    "values": alarm.calibration.values.tolist(),
                    "probabilities": alarm.calibration.probabilities.tolist(),
                    "threshold": alarm.threshold,
                }
                for time, alarm in self.alarms_.items()
            ],
        }
        parameters = {**self.get_params(), "observable": _observable_record(self.observable)}
        attributes = {
            "event_forecaster": _FORMAT,
            "parameters": json.dumps(parameters, sort_keys=True, default=_plain),
            "fitted": json.dumps(fitted, sort_keys=True, default=_plain),
        }
        storage.write_netcdf(path, variables, attributes)

    @classmethod
    def load(
        cls,
        path: str | Path,
        observable: Callable[[FloatArray], FloatArray] | DynamicalSystem | None = None,
    ) -> Self:
        """Read what `save` has written: the same forecasts, bit for bit.

        Parameters
        ----------
        path
            The file.
        observable
            Where it is a function or a system of one's own, which the file has not.

        Raises
        ------
        ValueError
            If the file holds no such forecaster, or its observable is needed and not given.
        """
        storage = _storage()
        attributes, arrays = storage.read_attributes(path), storage.read_netcdf(path)
        if attributes.get("event_forecaster") != _FORMAT:
            raise ValueError(f"{path} holds no event forecaster that this version can read")
        parameters = json.loads(attributes["parameters"])
        parameters["observable"] = _observable_of(parameters["observable"], observable, path)
        for name in ("prediction_times", "spectral_radius", "input_scaling", "tikhonov"):
            parameters[name] = tuple(parameters[name])
        self = cls(**parameters)
        fitted = json.loads(attributes["fitted"])
        kind, case = forecaster_class(self.kind), self._case(fitted["components"])
        self.members_ = []
        for number, found in enumerate(fitted["members"]):
            prefix = f"member{number}_"
            own = {
                name.removeprefix(prefix): array
                for name, array in arrays.items()
                if name.startswith(prefix)
            }
            self.members_.append(kind.restore(ForecasterRecord(own, found), case))
        self.hyperparameters_ = fitted["hyperparameters"]
        self.components_ = fitted["components"]
        self.event_threshold_ = fitted["event_threshold"]
        self.classes_ = np.array([False, True])
        self.alarms_ = {
            one["prediction_time"]: Alarm(
                Calibration(np.array(one["values"]), np.array(one["probabilities"])),
                one["threshold"],
            )
            for one in fitted["alarms"]
        }
        return self

    # -- times -------------------------------------------------------------------------------------

    def _whole(self, name: str, duration: float, least: int) -> int:
        """Samples of a duration that is called so in messages."""
        unit = 1
        if self.lyapunov_time is not None:
            if not self.lyapunov_time > 0:
                raise ValueError(f"lyapunov_time must be positive, not {self.lyapunov_time}")
            unit = durations.steps_per_lyapunov_time(1 / self.lyapunov_time, self.sampling_interval)
        found = durations.steps(duration, unit)
        if found < least:
            counted = (
                "durations are in samples unless lyapunov_time is given"
                if self.lyapunov_time is None
                else f"a Lyapunov time has {unit} samples"
            )
            raise ValueError(
                f"{name} is {duration:g}, which is {found} samples; it must be {least} at least "
                f"({counted})"
            )
        return found

    def _steps(self, name: str, least: int = 1) -> int:
        return self._whole(name, getattr(self, name), least)

    def _times(self) -> list[float]:
        times = [float(time) for time in self.prediction_times]
        if not times:
            raise ValueError("prediction_times must have one entry at least")
        return times

    def _time(self, prediction_time: float | None) -> float:
        self._check_fitted()
        fitted = list(self.alarms_)
        time = fitted[0] if prediction_time is None else float(prediction_time)
        if time not in fitted:
            known = ", ".join(f"{one:g}" for one in fitted)
            raise ValueError(
                f"prediction_time is {time:g}; fitted were the prediction_times {known}"
            )
        return time

    def _window(self, time: float) -> tuple[int, int]:
        """First and last step of the prediction window, from the present."""
        start = self._whole("a prediction time", time, 1)
        end = self._whole("the end of the window", time + self.window, 1)
        if end <= start:
            raise ValueError(f"window is {self.window:g}, which is not a single sample")
        return start, end

    def _boundaries(self) -> tuple[int, ...]:
        """Steps at which prediction windows begin and end."""
        return tuple(sorted({step for time in self._times() for step in self._window(time)}))

    # -- the parts of a fit ------------------------------------------------------------------------

    def _case(self, components: int) -> ForecastingCase:
        """What forecasters may know beside the series."""
        given = self.observable
        system = given if isinstance(given, DynamicalSystem) else _Observed(given, components)
        if system.dimension != components:
            raise ValueError(
                f"the series have {components} components, states of the observable's system have "
                f"{system.dimension}"
            )
        known = DEFAULT_OPTIONS.get(self.kind, {})
        for name in self.options or {}:
            if name not in known:
                raise ValueError(
                    f"forecasters of the kind {self.kind} have no option "
                    f"{name!r}{suggestion(name, known)}; their options are "
                    f"{', '.join(known) or 'none'}"
                )
        options = {**known, **(self.options or {})}
        if "backend" in options:
            options["backend"] = usable_backend(options["backend"])
        return ForecastingCase(
            system=system,
            time_step=self.sampling_interval / self.sampling_stride,
            sampling_stride=self.sampling_stride,
            steps_per_lyapunov_time=self._whole("a Lyapunov time", 1.0, 1),
            options=options,
        )

    def _observable(self, system: StateSpace, states: FloatArray) -> FloatArray:
        """Observable of series, ``(series, time)``."""
        return system.observable(states.transpose(2, 0, 1))

    def _threshold(self, observable: FloatArray) -> float:
        given = self.event_threshold
        if isinstance(given, Mapping):
            if list(given) != ["quantile"]:
                raise ValueError(
                    f"event_threshold must be a number or {{'quantile': q}}, not {dict(given)}"
                )
            return threshold_at(given["quantile"], observable)
        threshold = float(given)
        low, high = float(observable.min()), float(observable.max())
        if not low < threshold <= high:
            raise ValueError(
                f"event_threshold is {threshold:g}, but the observable of the training series lies "
                f"between {low:.4g} and {high:.4g}: there is no event to learn from"
            )
        return threshold

    def _observed(self, states: FloatArray, scales: Scales, kind: type[Forecaster]) -> FloatArray:
        """What forecasters are given of the training series."""
        if not self.noise or kind.sees_truth:
            return states
        return observed_series(states, 0, self.noise, scales, self.random_seed, self.case)

    def _points(
        self, states: FloatArray, spacing: int, boundaries: tuple[int, ...]
    ) -> SeriesPoints:
        return starting_points(
            len(states), states.shape[1], spacing, self._steps("washout"), boundaries[-1]
        )

    def _networks(
        self, observed: FloatArray, scales: Scales, system: StateSpace, washout: int
    ) -> tuple[list[Forecaster], list[dict[str, float]]]:
        """The committee, and the hyperparameters of each member."""
        # networks take a moment to load, which other kinds need not wait for
        from burstcast.esn.reservoir import ReservoirSeed
        from burstcast.esn.training import TrainingSeries
        from burstcast.forecasters.esn import NetworkForecaster
        from burstcast.tuning.hyperparameters import SearchSpace
        from burstcast.tuning.network_search import NetworkSearch, optimiser_seed, trained
        from burstcast.tuning.strategies.base import ValidationPlan
        from burstcast.tuning.strategies.registry import make_strategy
        from burstcast.tuning.validation import PointValidator

        if self.members < 1:
            raise ValueError(f"members must be 1 at least, not {self.members}")
        strategy = make_strategy(self.validation)
        together = (
            [make_strategy(name) for name in _VALIDATED_TOGETHER]
            if strategy.name in _VALIDATED_TOGETHER
            else [strategy]
        )
        interval = self._steps("validation_interval")
        fit = max(1, (observed.shape[1] - washout) // interval)
        plan = ValidationPlan(
            washout=washout,
            interval=interval,
            series=self.validation_series or min(_MOST_VALIDATION_SERIES, len(observed)),
            intervals=self.intervals_per_series or fit,
        )
        low_high = (float(self.spectral_radius[0]), float(self.spectral_radius[1]))
        space = SearchSpace(low_high, (float(self.input_scaling[0]), float(self.input_scaling[1])))
        search = NetworkSearch(space, self.grid, self.bayesian_points)
        options = self._case(observed.shape[2]).options
        networks: list[Forecaster] = []
        found = []
        for number in range(self.members):
            seed = ReservoirSeed(
                self.random_seed,
                self.neurons,
                number,
                float(options["connectivity"]),
                float(options["input_bias"]),
            )
            validator = PointValidator(
                seed.reservoir(observed.shape[2]),
                TrainingSeries(observed, scales.range),
                system.observable,
                plan,
                list(self.tikhonov),
                options["backend"],
            )
            optimiser = optimiser_seed(
                self.random_seed, self.case, self.neurons, strategy.name, number
            )
            chosen = search.best(validator, strategy, together, optimiser)
            network = trained(validator, chosen, washout)
            networks.append(NetworkForecaster(network, seed, options["divergence_bound"]))
            found.append(vars(chosen))
        return networks, found

    # -- forecasts and what came true --------------------------------------------------------------

    def _check_fitted(self) -> None:
        if not hasattr(self, "members_"):
            raise RuntimeError("this EventForecaster is not fitted yet: call fit first")

    def _ensemble(self) -> EnsembleForecaster | None:
        """The one forecaster, where the members of its ensemble vote."""
        first = self.members_[0]
        return cast(EnsembleForecaster, first) if has_members(type(first)) else None

    def _like_training(self, states: FloatArray) -> FloatArray:
        self._check_fitted()
        if states.shape[2] != self.components_:
            raise ValueError(
                f"the series have {states.shape[2]} components, those of the training had "
                f"{self.components_}"
            )
        return states

    def _washouts(self, series: Any) -> FloatArray:
        states, washout = self._like_training(as_series(series)), self._steps("washout")
        if states.shape[1] < washout:
            raise ValueError(
                f"the washout takes {washout} samples, the series have {states.shape[1]}"
            )
        return states[:, -washout:]

    def _out_of_sample(
        self,
        observed: FloatArray,
        case: ForecastingCase,
        washouts: FloatArray,
        points: SeriesPoints,
        boundaries: tuple[int, ...],
    ) -> list[WindowSummaries]:
        """Window summaries of forecasts of the training series without what each has taught."""
        known = observed, case, washouts.shape[1], case.system.observable
        asked = washouts, points.series, boundaries
        with _divergence_is_a_result():
            if (ensemble := self._ensemble()) is not None:
                return leave_one_out_member_summaries(ensemble, *known, *asked)
            return [leave_one_out_summaries(one, *known, *asked)[0] for one in self.members_]

    def _summaries(self, washouts: FloatArray) -> list[WindowSummaries]:
        """Window summaries of all members' forecasts from the ends of washouts."""
        observable, boundaries = self._case(self.components_).system.observable, self._boundaries()
        with _divergence_is_a_result():
            if (ensemble := self._ensemble()) is not None:
                return member_summaries(ensemble, observable, washouts, boundaries)
            return [
                forecast_summaries(member, observable, washouts, boundaries)[0]
                for member in self.members_
            ]

    def _windows(self, time: float) -> tuple[int, int]:
        """First of the windows between boundaries that make up a prediction window; how many."""
        start, end = self._window(time)
        boundaries = self._boundaries()
        first = boundaries.index(start)
        return first, boundaries.index(end) - first

    def _shares(self, votes: Sequence[WindowSummaries], time: float) -> FloatArray:
        return share_of_votes(votes, *self._windows(time), self.event_threshold_)

    def _outcomes(
        self,
        states: FloatArray,
        observed: FloatArray,
        points: SeriesPoints,
        votes: Sequence[WindowSummaries],
        time: float,
    ) -> Outcomes:
        """What followed which share of votes, by series."""
        boundaries, washout = self._boundaries(), self._steps("washout")
        system = self._case(states.shape[2]).system
        future = segments(states, points, 0, boundaries[-1])[:, 1:]
        truth = summarise(system.observable(future.transpose(2, 1, 0)), boundaries)
        seen = self._observable(system, segments(observed, points, washout - 1, 0))
        return outcomes_by_series(
            self._shares(votes, time),
            crosses(truth, *self._windows(time), self.event_threshold_),
            seen.max(axis=1) < self.event_threshold_,
            points.series,
            len(states),
        )


class _Observed:
    """Series of which an observable is known, and no equations (a `StateSpace`)."""

    observable_name = "observable"
    observable_symbol = "q"

    def __init__(self, observable: int | Callable[[FloatArray], FloatArray], components: int):
        if not callable(observable) and not -components <= observable < components:
            raise ValueError(
                f"observable is component {observable}, but the series have {components}: 0 to "
                f"{components - 1}"
            )
        self._given, self._components = observable, components

    @property
    def dimension(self) -> int:
        """Number of components."""
        return self._components

    def observable(self, state: FloatArray) -> FloatArray:
        """Observable of states ``(component, ...)``."""
        if not callable(self._given):
            component: FloatArray = state[self._given]
            return component
        value = np.asarray(self._given(np.moveaxis(state, 0, -1)), dtype=np.float64)
        if value.shape != state.shape[1:]:
            raise ValueError(
                f"the function of the observable must make (...) of states (..., component): of "
                f"{(*state.shape[1:], state.shape[0])} it made {value.shape}"
            )
        return value


def _divergence_is_a_result() -> Any:
    """Let forecasts leave the finite numbers without a warning: they then foresee nothing."""
    return np.errstate(over="ignore", invalid="ignore")


# -- files -----------------------------------------------------------------------------------------


def _storage() -> Any:
    """What reads and writes the workflow's files, which the library alone does without."""
    try:
        from burstcast_workflow.harness import storage
    except ImportError as error:
        raise ImportError(
            f"saving and loading takes the workflow's libraries: pip install 'burstcast[workflow]' "
            f"({error})"
        ) from error
    return storage


def _plain(value: Any) -> Any:
    """A number or an array of NumPy as JSON has it."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{value!r} cannot be saved")


def _observable_record(observable: Any) -> Any:
    if isinstance(observable, DynamicalSystem):
        package, _, name = type(observable).__module__.rpartition(".")
        if package == "burstcast.systems":
            return {"system": name, "parameters": parameters_of(observable)}
        return "given"
    return "given" if callable(observable) else int(observable)


def _observable_of(record: Any, given: Any, path: str | Path) -> Any:
    if given is not None:
        return given
    if record == "given":
        raise ValueError(
            f"the observable of {path} is a function or a system of one's own, which the file has "
            f"not: give it as load(path, observable=...)"
        )
    if isinstance(record, Mapping):
        return make_system(record["system"], record["parameters"])
    return record

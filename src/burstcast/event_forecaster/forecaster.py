"""From series to probabilities of extreme events, with the interface of scikit-learn.

`EventForecaster` does for one set of series what the workflow does for a case: it searches the
hyperparameters of a committee of networks, trains the networks, and calibrates the share that
forecasts an event by leave-one-out forecasts of the training series. It has no numerics of its own.
"""

from __future__ import annotations  # help() then shows Observable and FloatArray, not their parts

import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np

from burstcast.arrays import BoolArray, FloatArray
from burstcast.compiled.backends import usable_backend
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.event_threshold import threshold_at
from burstcast.discovery import suggestion
from burstcast.event_forecaster import files
from burstcast.event_forecaster.committee import Committee
from burstcast.event_forecaster.estimator import Estimator
from burstcast.event_forecaster.observed_states import Observable, state_space
from burstcast.event_forecaster.parameters import checked_parameters
from burstcast.event_forecaster.schedules import as_schedules
from burstcast.event_forecaster.search_edges import search_edges
from burstcast.event_forecaster.series_layout import as_series
from burstcast.event_forecaster.stream import ObservationStream
from burstcast.event_forecaster.timing import EventTiming
from burstcast.forecast.observed_points import ObservedPoints, observed_points
from burstcast.forecast.windows import WindowSummaries, crosses
from burstcast.forecasters._options import options_of_kind
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.registry import forecaster_class, learns_parameters
from burstcast.probability.alarm_rule import AlarmRule
from burstcast.probability.alarms import useless_votes
from burstcast.probability.calibration import UNCALIBRATED, isotonic
from burstcast.probability.outcomes import Outcomes, outcomes_by_series
from burstcast.probability.scores import probability_scores
from burstcast.probability.votes import share_of_votes
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import Parameters

_TOP_TWENTIETH: Mapping[str, float] = {"quantile": 0.95}
_REFERENCE_STATES = 8

BINS = 11
"""Of the probability, for those scores that need them."""


class EventForecaster(Estimator):
    """Forecasts extreme events of chaotic series, with probabilities.

    Series are arrays ``(series, time, component)`` of NumPy or xarray
    (`burstcast.event_forecaster.series_layout`). An event of the observable in a prediction window
    is a crossing of the event threshold: it is below it at the window's first step, and at or above
    it later on. Durations are in Lyapunov times where ``lyapunov_time`` is given, and in samples
    otherwise; they are rounded down to whole samples.

    Parameters
    ----------
    observable
        Observable that has events: the index of a component, a function from states
        ``(..., component)`` to ``(...)``, or a system, which has an observable.
    event_threshold
        A number in units of the observable, or ``{"quantile": q}`` of the observable of the
        training series.
    prediction_times
        One or several prediction times: from the present to the beginning of the window. The first
        is the default of all methods.
    window
        Length of the prediction window.
    lyapunov_time
        Lyapunov time in the unit of ``sampling_interval``; None: all durations are in samples.
    sampling_interval
        Time between two samples.
    washout
        Length of the observations that a forecast starts from.
    kind
        Kind of forecaster, a module of `burstcast.forecasters`: "esn", "quadratic", ...
    members
        Number of networks in the committee. Other kinds ignore it: the members of their ensemble
        vote (filters, analogues), or the single forecaster votes 0 or 1.
    neurons
        Size of each network.
    validation
        Validation strategy: "RV", "SSV" (`burstcast.tuning.strategies`).
    validation_interval
        Length of a validation interval.
    validation_series, intervals_per_series
        Number of training series with validation intervals, and of intervals in each; None: four
        series, or all if there are fewer, and as many intervals as fit.
    spectral_radius, input_scaling
        Bounds of the search, which is logarithmic.
    tikhonov
        Tikhonov parameters to choose from.
    grid, bayesian_points
        Points of the search: grid points in each direction, then points of Bayesian optimisation.
    calibrate
        Whether probabilities are calibrated by forecasts of each training series by readouts that
        have not seen it, which takes two series. Otherwise they are shares of votes.
    prior_forecasts
        Weight of the prior of the calibration: number of forecasts that verified as stated, for
        each share of votes.
    calibration_spacing, start_spacing
        Distance of the starting points for calibration, and for scores.
    noise
        Observation noise that is added to the training series, in standard deviations of each
        component; 0 for measured series.
    sampling_stride
        Integration steps in a sample, for kinds that integrate equations.
    options
        Options of the kind that differ from its defaults (`burstcast.forecasters._options`).
    random_seed, case
        Root of all random numbers, and the name of the case in their streams: a case of the
        workflow with the same settings has the same networks, bit for bit.

    Attributes
    ----------
    members_
        Fitted forecasters; a single one if the members of its ensemble vote.
    hyperparameters_
        Hyperparameters found by the search, for each network.
    event_threshold_
        Event threshold in units of the observable.
    reference_states_, reference_observable_
        Some states of the training series, ``(state, component)``, and the observable of each:
        `load` compares its observable with them.
    alarms_
        Calibrations and thresholds (`burstcast.probability.alarm_rule`) by prediction time.
    classes_
        False and True, the columns of `predict_proba`.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.event_forecaster.forecaster import EventForecaster
    >>> from burstcast.systems.integration import integrate
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> start = np.array([[1.0], [1.0], [20.0]]) + np.random.default_rng(0).normal(size=(3, 20))
    >>> series = integrate(Lorenz63(), start, 0.01, 3000, stride=2)[500:].transpose(2, 0, 1)
    >>> forecaster = EventForecaster(
    ...     observable=2,
    ...     event_threshold=40.0,
    ...     kind="analogues",
    ...     lyapunov_time=1.1,
    ...     sampling_interval=0.02,
    ... )
    >>> forecaster.fit(series[:10]).predict_proba(series[10:12, :200]).shape
    (2, 2)
    >>> forecaster.score(series[10:]) > 0.5
    True
    """

    _stream: ObservationStream | None = None

    def __init__(
        self,
        observable: Observable = 0,
        event_threshold: float | Mapping[str, float] = _TOP_TWENTIETH,
        *,
        prediction_times: float | Sequence[float] = (1.0,),
        window: float = 1.0,
        lyapunov_time: float | None = None,
        sampling_interval: float = 1.0,
        washout: float = 0.5,
        kind: str = "esn",
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

    def fit(self, series: Any, y: None = None, *, parameters: Any = None) -> Self:
        """Search, train, and calibrate.

        Parameters
        ----------
        series
            Training series, ``(series, time, component)``.
        y
            Ignored: events are found in the series.
        parameters
            For kinds that know the parameters (``quadratic_aware``, ``esn_aware``): values in the
            training series of the parameters named by the option ``parameters``, in a form of
            `burstcast.event_forecaster.schedules.as_schedules`.

        Raises
        ------
        ValueError
            If a parameter is out of bounds, or the series are too few or too short for it.
        TypeError
            If a parameter is of another type than it must be.

        Warns
        -----
        UserWarning
            If most networks have a hyperparameter on the edge of its search, or if the votes tell
            events from no events no better than chance, in the forecasts that calibrate them.
        """
        checked = checked_parameters(self.get_params())
        states = as_series(series, "the training series")
        timing, kind = self._timing, forecaster_class(self.kind)
        learnt = self._told(parameters, len(states), states.shape[1] - 1, "fit")
        own = None if learnt is None else learnt.mean(axis=(0, 1)).tolist()
        case = self._case(states.shape[2], own)
        value = case.system.observable(states.transpose(2, 0, 1))
        threshold = self._threshold(value)
        observed = states
        if self.noise and not kind.sees_truth:
            scales = component_scales(states)
            observed = observed_series(states, 0, self.noise, scales, self.random_seed, self.case)
        points = self._points(case, observed, value, "calibration_spacing")
        if self.calibrate and len(states) < 2:
            raise ValueError(
                "calibrating leaves one series out and takes two at least: give more series, or "
                "calibrate=False"
            )
        if kind.has_search:
            # networks take a moment to load, which other kinds need not wait for
            from burstcast.event_forecaster.networks import networks

            members, found = networks(
                kind,
                states,
                observed,
                learnt,
                case,
                checked,
                self._samples("washout"),
                self._samples("validation_interval"),
            )
        else:
            members, found = [kind.fit(observed, case, learnt)], []
        for text in search_edges(found, checked, states.shape):
            warnings.warn(text, stacklevel=2)
        # nothing of a former fit is left before all can be replaced
        self.members_ = members
        self._stream = None
        self.hyperparameters_ = found
        self.components_, self.own_parameters_ = states.shape[2], own
        every = states.reshape(-1, self.components_)
        self.reference_states_ = every[
            np.linspace(0, len(every) - 1, _REFERENCE_STATES).astype(int)
        ]
        self.reference_observable_ = case.system.observable(self.reference_states_.T)
        self.event_threshold_ = threshold
        self.classes_ = np.array([False, True])
        self.alarms_ = dict.fromkeys(timing.times, AlarmRule(UNCALIBRATED, 0.5))
        if self.calibrate:
            votes = Committee(members).out_of_sample(
                case, observed, points, timing.boundaries, learnt
            )
            for time in timing.times:
                outcomes = self._outcomes(points, votes, time)
                if not outcomes.levels.size:
                    raise ValueError(
                        f"no starting point is left to calibrate with: the observable reaches the "
                        f"event threshold {threshold:.4g} in every washout"
                    )
                if text := useless_votes(outcomes):
                    warnings.warn(f"prediction time {time:g}: {text}", stacklevel=2)
                calibration = isotonic(outcomes, checked["prior_forecasts"])
                self.alarms_[time] = AlarmRule.chosen(outcomes, calibration)
        return self

    def forecast(self, series: Any, duration: float | None = None) -> FloatArray:
        """Forecasts of all members, from the last sample of each series on.

        Parameters
        ----------
        series
            Observations up to the present, ``(series, time, component)``, at least as long as the
            washout. Only the last washout counts.
        duration
            Length of the forecast; None: to the end of the last prediction window.

        Returns
        -------
        ``(member, series, time, component)``; the first sample is the one after the present.
        """
        timing = self._timing
        steps = timing.boundaries[-1]
        if duration is not None:
            steps = timing.samples("duration", duration)
        washouts = self._washouts(series)
        return Committee(self.members_).forecasts(washouts, steps)

    def predict_proba(
        self,
        series: Any,
        prediction_time: float | None = None,
        *,
        parameters: Any = None,
        planned: Any = None,
    ) -> FloatArray:
        """Probability of no event, and of one, in the window at a prediction time.

        Parameters
        ----------
        series
            As for `forecast`.
        prediction_time
            One of ``prediction_times``; None: the first.
        parameters
            For kinds that know the parameters: values in force from each sample of the washout to
            the next, as in `fit`; None: their means in training.
        planned
            Values that will be in force in each step of the forecast; None: the last of
            ``parameters``.

        Returns
        -------
        ``(series, 2)``, with columns in the order of ``classes_``: ``[:, 1]`` is the probability of
        an event.
        """
        time = self._time(prediction_time)
        washouts = self._washouts(series)
        schedules = self._schedules(washouts, parameters, planned)
        shares = self._shares(self._votes(washouts, schedules), time)
        probability = self.alarms_[time].calibration(shares)
        return np.stack([1 - probability, probability], axis=1)

    def what_if(
        self,
        series: Any,
        actions: Mapping[str, Any],
        prediction_time: float | None = None,
        *,
        parameters: Any = None,
    ) -> dict[str, FloatArray]:
        """Probability of an event under each of several actions, and without any.

        Parameters
        ----------
        series, prediction_time, parameters
            As for `predict_proba`.
        actions
            Values that would be in force in each step of the forecast (``planned``), by name.

        Returns
        -------
        By the names of the actions, and "none", ``(series,)`` each.
        """
        return {
            name: self.predict_proba(
                series, prediction_time, parameters=parameters, planned=planned
            )[:, 1]
            for name, planned in {"none": None, **actions}.items()
        }

    def predict(self, series: Any, prediction_time: float | None = None) -> BoolArray:
        """Alarms: whether the probability of an event is high enough (see ``alarms_``).

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

    def update(self, observation: Any, time: float | None = None) -> Self:
        """Take the next observation of a running series.

        Only the latest washout counts. A gap begins the washout
        again, and a warning says so: an observation that is not finite, or a time that is more than
        a sampling interval after the last one. `save` keeps the observations; `fit` forgets them.

        Parameters
        ----------
        observation
            ``(component,)``.
        time
            When it was made, in the unit of ``sampling_interval``; None: one sampling interval
            after the one before.

        Raises
        ------
        ValueError
            If it has other components than the training series, or the time goes back.
        """
        self._check_fitted()
        if self._stream is None:
            self._stream = self._new_stream()
        self._stream.append(observation, time)
        return self

    def probability(self, prediction_time: float | None = None) -> float:
        """Probability of an event after the latest observation (`update`).

        Equal to `predict_proba` of these observations; NaN until the washout is complete.

        Parameters
        ----------
        prediction_time
            One of ``prediction_times``; None: the first.
        """
        time = self._time(prediction_time)
        if self._stream is None or self._stream.waiting:
            return float("nan")
        return float(self.predict_proba(self._stream.washout, time)[0, 1])

    def scores(self, series: Any, prediction_time: float | None = None) -> dict[str, float]:
        """All scores of the probabilities, and of the alarms that they raise, in series.

        Starting points lie ``start_spacing`` apart in all series. Points whose washout reaches the
        event threshold are left out: an event is under way there.

        Parameters
        ----------
        series
            Test series, not used in training.
        prediction_time
            One of ``prediction_times``; None: the first.

        Returns
        -------
        By name: "f_score", "precision", "recall", "brier_skill", "roc_area", ...
        (`burstcast.probability.scores`), and the numbers of "forecasts" and "events". NaN where a
        score is not defined, such as a recall without events.
        """
        time = self._time(prediction_time)
        states = self._like_training(as_series(series))
        case = self._case(self.components_)
        value = case.system.observable(states.transpose(2, 0, 1))
        points = self._points(case, states, value, "start_spacing")
        raw = self._outcomes(points, self._votes(points.washouts), time)
        alarm = self.alarms_[time]
        outcomes = raw.at(alarm.calibration(raw.levels))
        found = probability_scores(outcomes, alarm.threshold, BINS)
        return {
            "forecasts": int(outcomes.points.sum()),
            "events": int(outcomes.events.sum()),
            **{name: float(value) for name, value in found.items()},
        }

    def score(self, series: Any, y: None = None) -> float:
        """F-score of the alarms at the first prediction time (see `scores`)."""
        return self.scores(series)["f_score"]

    def save(self, path: str | Path) -> None:
        """Write the fitted state to a NetCDF file, without pickling.

        An observable that is a function or a system of your own is not written: pass it to `load`.
        """
        self._check_fitted()
        alarms = [{"prediction_time": time, **one.record()} for time, one in self.alarms_.items()]
        fitted = {
            "components": self.components_,
            "own_parameters": self.own_parameters_,
            "reference_states": self.reference_states_,
            "reference_observable": self.reference_observable_,
            "event_threshold": self.event_threshold_,
            "hyperparameters": self.hyperparameters_,
            "alarms": alarms,
            "stream": None if self._stream is None else self._stream.record(),
        }
        members = [member.record() for member in self.members_]
        files.write_saved(path, files.SavedForecaster(self.get_params(), fitted, members))

    @classmethod
    def load(
        cls,
        path: str | Path,
        observable: Callable[[FloatArray], FloatArray] | DynamicalSystem | None = None,
    ) -> Self:
        """Read a file of `save`: forecasts are identical, bit for bit.

        Parameters
        ----------
        path
            The file.
        observable
            The observable, if it is a function or a system of your own, which is not in the file.

        Raises
        ------
        ValueError
            If the file holds no such forecaster or is damaged; if its observable is needed and not
            given, or the given one has other values than the observable of the fit.
        """
        saved = files.read_saved(path, observable)
        self, fitted = cls(**saved.parameters), saved.fitted
        self.own_parameters_ = fitted.get("own_parameters")
        kind = forecaster_class(self.kind)
        case = self._case(fitted["components"], self.own_parameters_)
        self.members_ = [kind.restore(record, case) for record in saved.members]
        self.hyperparameters_ = fitted["hyperparameters"]
        self.components_ = fitted["components"]
        self.reference_states_ = np.array(fitted["reference_states"])
        self.reference_observable_ = np.array(fitted["reference_observable"])
        given = case.system.observable(self.reference_states_.T)
        if not np.allclose(given, self.reference_observable_, rtol=1e-9, atol=0, equal_nan=True):
            raise ValueError(
                f"the observable that load was given differs from {path}: for states of the "
                f"training series it is {given}, and was {self.reference_observable_}"
            )
        self.event_threshold_ = fitted["event_threshold"]
        self.classes_ = np.array([False, True])
        self.alarms_ = {one["prediction_time"]: AlarmRule.restore(one) for one in fitted["alarms"]}
        if fitted.get("stream"):
            self._stream = self._new_stream().restored(fitted["stream"])
        return self

    # -- what parameters mean ----------------------------------------------------------------------

    @property
    def _timing(self) -> EventTiming:
        checked = checked_parameters(self.get_params())
        names = ("lyapunov_time", "sampling_interval", "prediction_times", "window")
        return EventTiming(*(checked[name] for name in names))

    def _samples(self, name: str) -> int:
        """Number of samples in the duration that a parameter gives."""
        return self._timing.samples(name, getattr(self, name))

    def _case(self, components: int, own: Sequence[float] | None = None) -> ForecastingCase:
        """Knowledge of forecasters beside the series, with their ``own`` parameter values."""
        system = state_space(self.observable, components)
        options = options_of_kind(self.kind)
        for name in self.options or {}:
            if name not in options:
                raise ValueError(
                    f"forecasters of the kind {self.kind} have no option "
                    f"{name!r}{suggestion(name, options)}; their options are "
                    f"{', '.join(options) or 'none'}"
                )
        options |= self.options or {}
        if "backend" in options:
            options["backend"] = usable_backend(options["backend"])
        return ForecastingCase(
            system=system,
            time_step=self.sampling_interval / self.sampling_stride,
            sampling_stride=self.sampling_stride,
            steps_per_lyapunov_time=self._timing.unit,
            options=options,
            parameters=None if own is None else Parameters(self._parameter_names, tuple(own)),
        )

    @property
    def _parameter_names(self) -> tuple[str, ...]:
        return tuple({**options_of_kind(self.kind), **(self.options or {})}["parameters"])

    def _told(self, given: Any, series: int, steps: int, where: str) -> FloatArray | None:
        """Schedules of a kind that knows the parameters; None of others."""
        if not learns_parameters(self.kind):
            if given is not None:
                raise ValueError(
                    f"forecasters of the kind {self.kind} do not know the parameters: leave them "
                    f"out of {where}, or take a kind that does, such as quadratic_aware"
                )
            return None
        if given is None:
            raise ValueError(
                f"forecasters of the kind {self.kind} need the values of "
                f"{', '.join(self._parameter_names)}: {where}(..., parameters=...)"
            )
        return as_schedules(given, series, steps, self._parameter_names)

    def _schedules(self, washouts: FloatArray, parameters: Any, planned: Any) -> FloatArray | None:
        """Schedules over washouts and forecasts; None without parameters."""
        series, steps = washouts.shape[:2]
        if parameters is None and planned is None and not learns_parameters(self.kind):
            return None
        known = self.own_parameters_ if parameters is None else parameters
        past = self._told(known, series, steps - 1, "predict_proba")
        assert past is not None
        reach = self._timing.boundaries[-1]
        ahead = np.repeat(past[:, -1:], reach, axis=1)
        if planned is not None:
            ahead = as_schedules(planned, series, reach, self._parameter_names)
        return np.concatenate([past, ahead], axis=1)

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

    # -- series, votes, and what came true ---------------------------------------------------------

    def _check_fitted(self) -> None:
        if not hasattr(self, "members_"):
            raise RuntimeError("this EventForecaster is not fitted yet: call fit first")

    def _like_training(self, states: FloatArray) -> FloatArray:
        self._check_fitted()
        if states.shape[2] != self.components_:
            raise ValueError(
                f"the series have {states.shape[2]} components, the training series had "
                f"{self.components_}"
            )
        return states

    def _new_stream(self) -> ObservationStream:
        washout = self._samples("washout")
        return ObservationStream(self.components_, washout, self.sampling_interval)

    def _washouts(self, series: Any) -> FloatArray:
        states, washout = self._like_training(as_series(series)), self._samples("washout")
        if states.shape[1] < washout:
            raise ValueError(
                f"the washout takes {washout} samples, the series have {states.shape[1]}"
            )
        return states[:, -washout:]

    def _points(
        self, case: ForecastingCase, observed: FloatArray, value: FloatArray, spacing: str
    ) -> ObservedPoints:
        return observed_points(
            observed,
            value,
            case.system.observable,
            boundaries=self._timing.boundaries,
            washout=self._samples("washout"),
            spacing=self._samples(spacing),
        )

    def _votes(
        self, washouts: FloatArray, schedules: FloatArray | None = None
    ) -> list[WindowSummaries]:
        case, boundaries = self._case(self.components_), self._timing.boundaries
        return Committee(self.members_).summaries(case, washouts, boundaries, schedules)

    def _shares(self, votes: Sequence[WindowSummaries], time: float) -> FloatArray:
        return share_of_votes(votes, *self._timing.windows(time), self.event_threshold_)

    def _outcomes(
        self, points: ObservedPoints, votes: Sequence[WindowSummaries], time: float
    ) -> Outcomes:
        """Outcomes for each share of votes."""
        threshold, series = self.event_threshold_, points.points.series
        return outcomes_by_series(
            self._shares(votes, time),
            crosses(points.truth, *self._timing.windows(time), threshold),
            points.seen.max(axis=1) < threshold,
            series,
            int(series.max()) + 1,
        ).total()

"""From series to probabilities of extreme events, with the interface of scikit-learn.

`EventForecaster` does for one set of series what the workflow does for a case: it searches the
hyperparameters of a committee of networks, trains the networks, and calibrates the share that
forecasts an event by leave-one-out forecasts of the training series. It has no numerics of its own.
"""

from __future__ import annotations  # help() then shows Observable and FloatArray, not their parts

import copy
import dataclasses
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path
from typing import Any, Literal, Self, cast, overload

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, float_array
from burstcast.base.compiled.backends import usable_backend
from burstcast.base.exogenous import up_to_sample, with_inputs
from burstcast.base.left_out import LeftOut
from burstcast.base.series_lengths import padded, samples_of, series_lengths, without_padding
from burstcast.base.threads import single_threaded
from burstcast.data.clocks import readable, unit_of_dates
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.event_threshold import threshold_at
from burstcast.data.no_state import no_state
from burstcast.data.series_layout import LabelledSeries, labelled_series, observation_of
from burstcast.data.starting_points import SeriesPoints, segments
from burstcast.event_forecaster import choice, files
from burstcast.event_forecaster.causes import better_window, causes, diagnosed, step_error
from burstcast.event_forecaster.choice import (
    AUTO,
    KINDS,
    LeftOutForecasts,
    choose,
    cost,
)
from burstcast.event_forecaster.components import Components
from burstcast.event_forecaster.consistency import (
    ALPHA,
    LEAST_WASHOUT,
    ConsistencyTest,
    rank_histogram,
    spread_and_error,
)
from burstcast.event_forecaster.estimator import Estimator
from burstcast.event_forecaster.events import (
    ByTime,
    Events,
    EventTiming,
    invalid_share,
    permanent_f_score,
)
from burstcast.event_forecaster.observed_states import Observable, check_order, state_space
from burstcast.event_forecaster.parameters import (
    Duration,
    checked_parameters,
    copied,
    described,
    has_unit,
    is_same,
)
from burstcast.event_forecaster.progress import SignOfLife
from burstcast.event_forecaster.schedules import as_schedules
from burstcast.event_forecaster.score_intervals import (
    EventOutcomes,
    ScoreInterval,
    blocks_of,
    score_intervals,
)
from burstcast.event_forecaster.shared_rows import shared_rows
from burstcast.event_forecaster.stream import ObservationStream
from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasters._limits import TrainingLimits
from burstcast.forecasters._options import QuadraticOptions, in_samples, resolved_by_samples
from burstcast.forecasters.base import Forecaster, ForecasterKind, ForecastingCase
from burstcast.forecasters.registry import as_forecaster, class_of, kind_name, make_kind_of
from burstcast.forecasts.alarms import UNCALIBRATED, AlarmRule
from burstcast.forecasts.points import ObservedPoints, observed_points
from burstcast.forecasts.probabilities import (
    announcement,
    out_of_sample_forecasts,
    out_of_sample_probabilities,
)
from burstcast.forecasts.scores import outcomes_by_series, probability_scores
from burstcast.forecasts.windows import WindowSummaries, member_forecasts, window_forecasts
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import Parameters

_REFERENCE_STATES = 8
_ROUNDING = 1e-9
"""Relative difference of two prediction times that counts as none."""
_FITTED = (
    *("components", "own_parameters", "reference_states", "reference_observable"),
    *("event_threshold", "hyperparameters", "labels", "clock", "units", "unskilled_times"),
    *("training_range", "consistency"),
)
"""Names of what a fit has found, beside members and alarms, without their underscores."""

DURATIONS: Mapping[str, tuple[float, float]] = {
    "window": (1.0, 5.0),
    "washout": (0.5, 5.0),
    "validation_interval": (2.0, 5.0),
    "calibration_spacing": (0.25, 1.0),
    "start_spacing": (1.0, 1.0),
}
"""Durations that are not given: in Lyapunov times, and in samples without a Lyapunov time."""

_OF_SCORES = ("start_spacing",)
"""Parameters that a fit does not depend on."""

PARTS = 5
"""Parts of a single training series that are left out in turn, to calibrate."""

_POINTS_OF_KEPT = 128
"""Starting points in the training series from which the kept models are tried, at most."""

BINS = 11
"""Of the probability, for those scores that need them."""


Verified = tuple[Events, ObservedPoints, ByTime, ByTime]
"""Starting points in test series, what their probabilities are made from, and valid shares."""


@dataclass(eq=False, repr=False)
class EventForecaster(Estimator):
    """Forecasts extreme events of chaotic series, with probabilities.

    Series are arrays ``(series, time, component)`` of NumPy or xarray
    (`burstcast.data.series_layout`). An event of the observable in a prediction window
    is a crossing of the event threshold: it is below it at the window's first step, and at or above
    it later on. Durations are in Lyapunov times where ``lyapunov_time`` is given, and in samples
    otherwise; they are rounded down to whole samples. `DURATIONS` has their defaults.

    After `fit`, ``members_`` are the fitted forecasters (a single one if the members of its
    ensemble vote, or if it is a classifier), ``hyperparameters_`` what the search found for each
    network, ``event_threshold_`` the threshold in units of the observable, ``alarms_`` the
    calibrations and thresholds (`burstcast.forecasts.alarms`) by prediction time,
    ``kind_``, ``options_`` and ``choices_`` what ``kind="auto"`` chose and tried,
    ``warnings_`` signs of weakness, in sentences, and ``classes_`` the columns of `predict_proba`.

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

    #: what has events: a component by its number or its label, a function from states
    #: ``(..., component)`` to ``(...)``, or a system, which has an observable
    observable: Observable = 0
    #: in units of the observable, or ``{"quantile": q}`` of the observable of the training series
    event_threshold: float | Mapping[str, float] = field(default_factory=lambda: {"quantile": 0.95})
    _: KW_ONLY
    #: one or several: from the present to the beginning of the window. The first is the default of
    #: all methods.
    prediction_times: float | Sequence[float] = (1.0,)
    window: float | None = None  #: length of the prediction window
    #: in the unit of ``sampling_interval``, or with a unit of its own, as that; None: all durations
    #: are in samples
    lyapunov_time: Duration | None = None
    #: time between two samples: a number, or a Timedelta or text ("10 minutes") for dates
    sampling_interval: Duration = 1.0
    washout: float | None = None  #: length of the observations that a forecast starts from
    #: a kind of `burstcast.forecasters` by its name: "esn", "nvar", "quadratic", ..., or a
    #: classifier of events without trajectories, "precursor" or "esn_direct"; or a class of
    #: forecasters, or an unfitted forecaster with its options, of burstcast or of one's own:
    #: ``NVAR(lags=3)``. "auto" tries several and keeps the best
    #: (`burstcast.event_forecaster.choice`)
    kind: str | ForecasterKind | type[ForecasterKind] = "esn"
    #: number of networks in the committee. Other kinds ignore it: the members of their ensemble
    #: vote (filters, analogues), or the single forecaster votes 0 or 1.
    members: int = 10
    #: networks with a search of their own, whose hyperparameters the others take in turn
    searches: int = 3
    neurons: int = 500  #: size of each network
    validation: str = "RV"  #: strategy: "RV", "SSV" (`burstcast.networks.validation_strategies`)
    validation_interval: float | None = None  #: length of a validation interval
    #: training series with validation intervals, the first ones, or the longest where lengths
    #: differ; None: four, or all if there are fewer
    validation_series: int | None = None
    intervals_per_series: int | None = None  #: validation intervals; None: as many as fit
    #: spectral_radius, input_scaling: bounds of the search, which is logarithmic
    spectral_radius: tuple[float, float] = (0.05, 1.0)
    input_scaling: tuple[float, float] = (0.05, 10.0)
    tikhonov: float | Sequence[float] = (1e-6, 1e-9, 1e-12)  #: Tikhonov parameters to choose from
    grid: int = 4  #: grid points of the search in each direction
    bayesian_points: int = 9  #: points of Bayesian optimisation after the grid
    #: whether probabilities are calibrated by forecasts of each training series by what has not
    #: seen it; a single series is cut into `PARTS`. Otherwise they are shares of votes.
    calibrate: bool = True
    #: weight of the prior of the calibration: number of forecasts that verified as stated, for each
    #: share of votes
    prior_forecasts: float = 30.0
    calibration_spacing: float | None = None  #: distance of the starting points for calibration
    start_spacing: float | None = None  #: distance of the starting points for scores
    #: observation noise that is added to the training series, in standard deviations of each
    #: component; 0 for measured series
    noise: float = 0.0
    sampling_stride: int = 1  #: integration steps in a sample, for kinds that integrate equations
    #: options that differ from the defaults of a kind that is given by its name; of "auto", the
    #: kinds to try: ``{"kinds": ["analogues", "esn"]}``
    options: Mapping[str, Any] | None = None
    #: random_seed, case: root of all random numbers, and the name of the case in their streams: a
    #: case of the workflow with the same settings has the same networks, bit for bit
    random_seed: int = 0
    case: str = "series"
    _stream: ObservationStream | None = field(default=None, init=False)

    # -- what a user calls -------------------------------------------------------------------------

    def fit(
        self, series: Any, y: Any = None, *, parameters: Any = None, verbose: bool = True
    ) -> Self:
        """Search, train, and calibrate.

        ``series``: Training series, ``(series, time, component)``, or a list of series of unequal
        lengths (`burstcast.data.series_layout`). ``y``: Ignored, since events are found in the
        series. ``parameters``: For kinds that know the parameters
        (``quadratic_aware``, ``esn_aware``), values in the training series of the parameters named
        by the option ``parameters``, in a form of
        `burstcast.event_forecaster.schedules.as_schedules`. ``verbose``: Whether a fit of more than
        five seconds says on one line, on a terminal or in a notebook, what it is at.

        Raises ValueError if a parameter is out of bounds, or the series are too few or too short
        for it, and TypeError if a parameter is of another type than it must be. Warns, once for
        equal parameters, if most networks have a hyperparameter on the edge of its search; if
        alarms in training series that were left out are no better than chance or than a permanent
        alarm; if there are fewer than ten events; if series are too short for a forecast; or if
        durations in samples are short beside the correlation time.
        """
        own = getattr(self.kind, "__name__", type(self.kind).__name__)
        name = self.kind if isinstance(self.kind, str) else own
        with SignOfLife(f"fit of {name}", wanted=verbose) as sign:
            if self.kind == AUTO:
                return self._choose(series, parameters, sign)
            kind = self._kind  # loads what it computes with, whose threads are limited
            # threads of small matrices wait for each other more than they work
            with single_threaded():
                self._fit(kind, series, parameters, sign)
        self._warn_once(self.warnings_)
        return self

    def _choose(self, series: Any, parameters: Any, sign: SignOfLife) -> Self:
        """Fit the kind that forecasts training series best which it has not learnt from."""
        options = dict(self.options or {})
        kinds = tuple(options.pop("kinds", KINDS))
        if options or not kinds or isinstance(self.options and self.options.get("kinds"), str):
            raise ValueError(
                f"options of the kind 'auto' are kinds=[...], names of kinds, not {self.options}"
            )
        if not self.calibrate:
            raise ValueError("kind='auto' compares what calibrates: it needs calibrate=True")
        given = labelled_series(series, "the training series").states
        warnings.warn(cost(kinds, given, self), stacklevel=3)
        best, trials = choose(self, series, parameters, kinds, sign.stage)
        chosen = best.kind
        vars(self).update({**vars(best), "kind": self.kind, "options": self.options})
        self.kind_, self.choices_, self.options_ = str(chosen), trials, dict(best.options or {})
        self._parameters_of_fit |= {"kind": self.kind, "options": copied(self.options)}
        events = int(sum(each.happened.sum() for each in self.left_out_.values()))
        told: list[str] = [*choice.findings(trials, self.kind_, events)]
        told += cast(Any, best).warnings_
        self.warnings_ = told
        self._warn_once(self.warnings_)
        return self

    def _fit(self, kind: ForecasterKind, series: Any, parameters: Any, sign: SignOfLife) -> None:
        checked, timing = checked_parameters(self), self._timing
        given = labelled_series(series, "the training series")
        findings: list[str] = list(no_state(given))
        components = Components(
            given.states.shape[2], given.labels, isinstance(self.observable, DynamicalSystem)
        )
        check_order(self.observable, given.labels)
        self._check_clock(given, None)
        states = components.arranged(given.states, given.labels)
        shared = shared_rows(without_padding(states))
        reduced = self.calibrate and not class_of(self._model).learns_parameters
        findings += shared.finding(reduced) if self.calibrate else ()
        if reduced:
            if len(shared.needed) < len(states):
                states = states[shared.needed]
                shared = shared_rows(())
            if len(states) == 1:
                states = self._in_parts(states)
                shared = shared_rows(())
        learnt = self._checked_schedules(parameters, len(states), states.shape[1] - 1, "fit")
        own_values = None if learnt is None else learnt.mean(axis=(0, 1)).tolist()
        labelled = None
        case = self._case(components, own_values)
        value = _observable_of(case, states)
        events = Events(timing, self._threshold(value))
        observed = states
        if self.noise and not kind.sees_truth:
            scales = component_scales(states)
            observed = observed_series(states, 0, self.noise, scales, self.random_seed, self.case)
        points = self._points(case, observed, value, self._samples("calibration_spacing"))
        findings += [*events.weaknesses(value), *self._short_series(states)]
        findings += events.few_starts(points)
        if self.calibrate and len(states) < 2:
            raise ValueError(
                "calibrating leaves one series out and takes two at least: give more series, or "
                "calibrate=False"
            )
        training = observed if learnt is None else with_inputs(observed, learnt)
        members: Any
        hyperparameters: list[dict[str, Any]] = []
        if isinstance(kind, EventClassifier):
            spacing = timing.samples("start_spacing_lt", kind.start_spacing_lt)
            labelled = events.labelled(self._points(case, observed, value, spacing))
            members = [kind.fit(labelled, case)]
        elif kind.has_search:
            # networks take a moment to load, which other kinds need not wait for
            from burstcast.event_forecaster import committee

            series = committee.training_of(states, training, case, cast(Any, kind))
            steps = self._samples("washout"), self._samples("validation_interval")
            members, hyperparameters = committee.trained_committee(
                cast(Any, kind), series, case, checked, *steps, sign.stage
            )
            findings += committee.search_edges(hyperparameters, checked, len(samples_of(states)))
        else:
            members = [as_forecaster(kind).fit(training, case)]
        findings += dict.fromkeys(text for member in members for text in member.weaknesses())
        limits = TrainingLimits.of(observed, components.count)
        unskilled: dict[float, str] = {}
        invalid: list[str] = []
        consistency: ConsistencyTest | None = None
        if labelled is None:
            members = [member.within(limits) for member in members]
            kept = _votes_of_kept(members, case, training, points, timing)
            invalid += events.invalid(kept, "of the kept models in training series", members[0])
        sign.stage("forecasts of series that are left out")
        alarms = dict.fromkeys(timing.times, AlarmRule(UNCALIBRATED, 0.5))
        left_out_forecasts: dict[float, LeftOutForecasts] = {}
        left_out = shared.left_out() if self.calibrate else None
        if labelled is None and learnt is None and not kind.sees_truth:
            asked = points.washouts, points.points.series
            consistency = ConsistencyTest.left_out(members[0], training, case, *asked, left_out)
        if self.calibrate:
            if left_out is not None:
                points = points.of_series(np.concatenate([each.forecast for each in left_out]))
            if labelled is None:
                washouts = _washouts_of(training, points, timing)
                system, windows = case.system, timing.boundaries
                for text in announcement(members[0], system.observable, washouts, windows):
                    warnings.warn(text, stacklevel=3)
                votes = _left_out(members, case, training, points, timing, left_out)
                values = events.shares(votes)
                invalid += events.invalid(votes, "of series that were left out", members[0])
            else:
                asked = points.washouts, points.points.series
                linked = shared.linked if shared.count else None
                values = events.by_time(
                    out_of_sample_probabilities(
                        members[0].tuned(), labelled, case, *asked, linked=linked
                    )
                )
            prior = None if labelled else checked["prior_forecasts"]
            left_out_forecasts = events.left_out(points, values, prior)
            alarms, unskilled = events.calibrated(points, values, prior)
            if isinstance(kind, QuadraticOptions) and learnt is None:
                findings += better_window(kind, case, training, points.points)
        if symptoms := [*invalid, *unskilled.values()]:
            found = causes(
                kind,
                timing,
                observed,
                components.names,
                washout=self._samples("washout"),
                events=events.number(value),
            )
            errs = []
            if labelled is None:
                errs = _step_error(members[0], case, training, points, components.names)
            findings += diagnosed(symptoms, [*found, *errs])
        # nothing of a former fit is left before all can be replaced
        self.members_, self.hyperparameters_, self.alarms_ = members, hyperparameters, alarms
        self._stream, self.left_out_ = None, left_out_forecasts
        self.components_, self.own_parameters_ = components.count, own_values
        self.labels_ = components.labels
        self.clock_ = given.step if given.dated else None
        self.units_ = given.units
        self._parameters_of_fit = {name: copied(value) for name, value in self.get_params().items()}
        # `load` compares its observable with these
        samples = samples_of(states)
        rows = np.linspace(0, len(samples) - 1, _REFERENCE_STATES).astype(int)
        self.reference_states_ = samples[rows]
        self.reference_observable_ = case.system.observable(self.reference_states_.T)
        self.event_threshold_, self.warnings_ = events.threshold, findings
        self.unskilled_times_ = list(unskilled)
        self.consistency_ = consistency
        self.training_range_ = [limits.low.tolist(), limits.high.tolist()]

    @property
    def classes_(self) -> BoolArray:
        """Columns of `predict_proba`: no event, and an event."""
        return np.array([False, True])

    def forecast(self, series: Any, duration: float | None = None) -> FloatArray:
        """Forecasts of all members, ``(member, series, time, component)``.

        The first sample is the one after the last sample of each series. Forecasts are NaN from
        where they are invalid: not finite, or more than ten training ranges away. A warning says
        how many are.

        ``series``: Observations up to the present, ``(series, time, component)`` or a list of
        series, at least as long as the washout. Only the last washout of each counts.
        ``duration``: Length of the forecast; None: to the end of the last prediction window.
        """
        self._check_fitted()
        as_forecaster(self._kind)  # refuses classifiers, which have no trajectories
        timing = self._timing
        steps = timing.boundaries[-1]
        if duration is not None:
            steps = timing.samples("duration", duration)
        batch = np.ascontiguousarray(self._washouts(series).transpose(1, 2, 0))
        forecasts = [member_forecasts(member, batch, steps) for member in self.members_]
        states = np.concatenate(forecasts, axis=2).transpose(2, 3, 0, 1)
        share = float(np.isnan(states[:, :, -1]).any(axis=-1).mean())
        for text in invalid_share(share, f"over {steps} samples", self.members_[0]):
            warnings.warn(text, stacklevel=2)
        return self._components.as_given(states)

    def predict_proba(
        self,
        series: Any,
        prediction_time: float | None = None,
        *,
        parameters: Any = None,
        planned: Any = None,
    ) -> FloatArray:
        """Probability of no event, and of one, in the window at a prediction time.

        Returns ``(series, 2)``, with columns in the order of ``classes_``: ``[:, 1]`` is the
        probability of an event.

        ``series``: As for `forecast`. ``prediction_time``: One of ``prediction_times``; None: the
        first. ``parameters``: For kinds that know the parameters, values in force from each sample
        of the washout to the next, as in `fit`; None: their means in training. ``planned``: Values
        that will be in force in each step of the forecast; None: the last of ``parameters``.
        """
        time = self._time(prediction_time)
        washouts = self._with_inputs(self._washouts(series), parameters, planned)
        values, valid = self._values(washouts)
        probability = self.alarms_[time].calibration(values[time])
        self._warn_of_invalid(valid[time])
        self._warn_of_odd(washouts)
        return np.stack([1 - probability, probability], axis=1)

    def valid_share(
        self,
        series: Any,
        prediction_time: float | None = None,
        *,
        parameters: Any = None,
        planned: Any = None,
    ) -> FloatArray:
        """Share of the forecasts behind each probability of `predict_proba` that are valid.

        Returns ``(series,)``. A forecast is valid if it is finite and within ten training ranges up
        to the end of the window; one that is not predicts no event. Of a classifier, which makes no
        forecasts, the share is 1. Parameters are those of `predict_proba`.
        """
        time = self._time(prediction_time)
        washouts = self._with_inputs(self._washouts(series), parameters, planned)
        return self._values(washouts)[1][time]

    def consistent(self, series: Any) -> BoolArray:
        """Whether the last washout of each series is like those of the training, ``(series,)``.

        The first member continues the first half of the washout, and its error in the second half
        is compared with its errors in training series that it has not learnt from
        (`burstcast.event_forecaster.consistency`). Of washouts of the flow of the training series,
        5 % are called inconsistent, whatever the kind. A forecast from an inconsistent washout is
        not to be trusted: the noise, the gain of a sensor, or the flow differ from what the model
        has learnt.

        Raises ValueError if there is no test: for classifiers, kinds that know parameters, washouts
        of fewer than six samples, a single training series, and fewer than 40 hindcasts.
        """
        return np.asarray(self._p_values(self._washouts(series)) > ALPHA)

    def scores_by_consistency(
        self, series: Any, prediction_time: float | None = None
    ) -> dict[str, dict[str, float]]:
        """Scores of the probabilities after washouts that are `consistent`, and after the others.

        By "consistent" and "inconsistent": the "share" of the starting points, and scores as of
        `scores`; NaN where there is no such point.

        ``prediction_time``: One of ``prediction_times``; None: the first.
        """
        time = self._time(prediction_time)
        events, points, values, _ = self._verified(series)
        rule, quiet = self.alarms_[time], events.quiet(points)
        agrees = self._p_values(points.washouts) > ALPHA
        happened, table = events.happened(points, time), {}
        for name, chosen in (("consistent", agrees), ("inconsistent", ~agrees)):
            here = chosen & quiet
            whole = np.zeros(len(here), dtype=np.int64)
            raw = outcomes_by_series(values[time], happened, here, whole, 1).total()
            outcomes = raw.at(rule.calibration(raw.levels))
            scores = probability_scores(outcomes, rule.threshold, BINS)
            table[name] = {
                "share": float(here.sum() / max(1, quiet.sum())),
                "forecasts": int(outcomes.points.sum()),
                "events": int(outcomes.events.sum()),
                **{score: float(value) for score, value in scores.items()},
            }
        return table

    def ensemble_scores(
        self, series: Any, prediction_time: float | None = None
    ) -> dict[str, float | FloatArray]:
        """Reliability of the ensemble of forecasts when the window begins, in test series.

        "spread" and "error": root mean square spread of the observable over the forecasts (members
        of a committee, a filter, or analogues), and error of their mean; equal if the ensemble is
        reliable. "rank_histogram": how often the truth has each rank among them, ``(forecasts +
        1,)``, level if it is.

        ``prediction_time``: One of ``prediction_times``; None: the first. Raises ValueError for
        classifiers, and for a single forecast.
        """
        time = self._time(prediction_time)
        as_forecaster(self._kind)  # refuses classifiers
        states, case = self._like_training(series), self._case(self._components)
        points = self._points(
            case, states, _observable_of(case, states), self._samples("start_spacing")
        )
        start = self._timing.span(time)[0]
        batch = np.ascontiguousarray(points.washouts.transpose(1, 2, 0))
        forecasts = [member_forecasts(member, batch, start)[-1] for member in self.members_]
        values = case.system.observable(np.concatenate(forecasts, axis=1))
        if len(values) < 2:
            raise ValueError("a single forecast has no spread: take a committee, or a filter")
        truth = points.truth.first[:, self._timing.windows(time)[0]]
        spread, error = spread_and_error(values, truth)
        return {
            "spread": spread,
            "error": error,
            "rank_histogram": rank_histogram(values, truth),
        }

    def what_if(
        self,
        series: Any,
        actions: Mapping[str, Any],
        prediction_time: float | None = None,
        *,
        parameters: Any = None,
    ) -> dict[str, FloatArray]:
        """Probability of an event under each of several actions, and without any ("none").

        Returns ``(series,)`` by the names of the actions. ``actions``: Values that would be in
        force in each step of the forecast (``planned`` of `predict_proba`), by name.
        """
        return {
            name: self.predict_proba(
                series, prediction_time, parameters=parameters, planned=planned
            )[:, 1]
            for name, planned in {"none": None, **actions}.items()
        }

    def predict(self, series: Any, prediction_time: float | None = None) -> BoolArray:
        """Alarms, ``(series,)``: whether the probability of an event reaches its threshold."""
        probability = self.predict_proba(series, prediction_time)[:, 1]
        return np.asarray(probability >= self.rule(prediction_time).threshold)

    def rule(self, prediction_time: float | None = None) -> AlarmRule:
        """Calibration and alarm threshold at a prediction time."""
        self._check_fitted()
        return self.alarms_[self._time(prediction_time)]

    def update(self, observation: Any, time: Any = None) -> Self:
        """Take the next observation of a running series, ``(component,)``, by labels if it has any.

        Only the latest washout counts. A gap begins the washout again, and a warning says so: an
        observation that is not finite, or a time that is more than a sampling interval after the
        last one. `save` keeps the observations; `fit` forgets them.

        ``time``: When it was made, in the unit of ``sampling_interval``, or a date; None: what the
        observation carries (the name of a row of pandas, the coordinate ``time`` of xarray), or
        else one sampling interval after the one before. Raises ValueError if the observation has
        other components than the training series, or the time is not finite, goes back, or is
        between two samples.
        """
        self._check_fitted()
        if self._stream is None:
            self._stream = self._new_stream()
        values, labels, carried, row = observation_of(observation)
        if values.shape == (self.components_,):
            values = self._components.arranged(values, labels, "an observation")
        if time is None:
            self._stream.append(values, carried, row)
        else:
            self._stream.append(values, time)
        return self

    def probability(self, prediction_time: float | None = None) -> float:
        """Probability of an event after the latest observation (`update`).

        Equal to `predict_proba` of these observations; NaN until the washout is complete.
        """
        time = self._time(prediction_time)
        if self._stream is None or not self._stream.complete:
            return float("nan")
        washout = self._with_inputs(self._stream.washout, None, None)
        values, valid = self._values(washout)
        self._warn_of_invalid(valid[time])
        return float(self.alarms_[time].calibration(values[time])[0])

    @overload
    def scores(
        self, series: Any, prediction_time: float, *, interval: Literal[False] = False
    ) -> dict[str, float]: ...

    @overload
    def scores(
        self, series: Any, prediction_time: float, *, interval: Literal[True]
    ) -> dict[str, ScoreInterval]: ...

    @overload
    def scores(
        self, series: Any, prediction_time: None = None, *, interval: bool = False
    ) -> dict[Any, Any]: ...

    def scores(
        self, series: Any, prediction_time: float | None = None, *, interval: bool = False
    ) -> dict[Any, Any]:
        """All scores of the probabilities, and of the alarms that they raise, in series, by name.

        They are "alarm_f_score", "alarm_precision", "alarm_recall", "brier_skill", "roc_area", ...
        (`burstcast.forecasts.scores`), the "permanent_f_score" of an alarm at every
        starting point, the numbers of "forecasts" and "events", and the "invalid_fraction" of the
        forecasts behind the probabilities (`valid_share`). NaN where a score is not defined, such
        as a recall without events. Starting points: see `outcomes`.

        ``prediction_time``: One of ``prediction_times``; None: the only one, or, of several, all
        of them: scores by name, by prediction time. ``interval``: Whether scores have confidence
        intervals of 95 %, as tuples ``(value, low, high)``, over series, or over blocks of time
        where there are fewer than ten series; NaN for "calibration_error" and "reliability", and
        where one series or block alone defines a score.
        """
        self._check_fitted()
        verified = self._verified(series)
        self._warn_of_odd(verified[1].washouts)
        several = prediction_time is None and len(self.alarms_) > 1
        times = [*self.alarms_] if several else [self._time(prediction_time)]
        scores = {time: self._scores(verified, time, interval) for time in times}
        for time, found in scores.items():
            forecasts, events = (
                found[name].value if interval else found[name] for name in ("forecasts", "events")
            )
            if not events:
                warnings.warn(
                    f"no event follows any of the {forecasts:.0f} starting points in these series, "
                    f"{time:g} ahead: recall, F-score and skill are NaN; longer series, or another "
                    f"event_threshold ({self.event_threshold_:g})",
                    stacklevel=2,
                )
        return scores if several else scores[times[0]]

    def _scores(self, verified: Verified, time: float, interval: bool) -> dict[str, Any]:
        """Scores at one prediction time."""
        events, points, values, valid = verified
        rule, quiet = self.alarms_[time], events.quiet(points)
        invalid = 1 - valid[time]
        if interval:
            blocks = blocks_of(points.points, events.timing.boundaries[-1])
            by_block = events.outcomes(points, values[time], time, blocks)
            calibrated = by_block.at(rule.calibration(by_block.levels))
            count = int(blocks.max()) + 1
            weights = np.asarray(invalid[quiet], dtype=np.float64)
            lost = np.asarray(np.bincount(blocks[quiet], weights, count), dtype=np.float64)
            return dict(score_intervals(calibrated, rule.threshold, BINS, self.random_seed, lost))
        raw = events.outcomes(points, values[time], time)
        outcomes = raw.at(rule.calibration(raw.levels))
        scores = probability_scores(outcomes, rule.threshold, BINS)
        return {
            "forecasts": int(outcomes.points.sum()),
            "events": int(outcomes.events.sum()),
            **{name: float(value) for name, value in scores.items()},
            "permanent_f_score": permanent_f_score(outcomes),
            "invalid_fraction": float(invalid[quiet].mean()) if quiet.any() else float("nan"),
        }

    def outcomes(self, series: Any, prediction_time: float | None = None) -> EventOutcomes:
        """Whether an event followed starting points in series, and its probability: ``(points,)``.

        Starting points lie ``start_spacing`` apart in all series, which were not used in training.
        Points whose washout reaches the event threshold are left out: an event is under way there.
        """
        time = self._time(prediction_time)
        events, points, values, _ = self._verified(series)
        quiet = events.quiet(points)
        return EventOutcomes(
            events.happened(points, time)[quiet],
            self.rule(time).calibration(values[time])[quiet],
            points.points.series[quiet],
            float_array(points.points.step[quiet] * events.timing.sampling_interval, "times"),
        )

    def score(self, series: Any, y: Any = None) -> float:
        """F-score of the alarms at the first prediction time (see `scores`)."""
        return self.scores(series, self._time(None))["alarm_f_score"]

    def save(self, path: str | Path) -> None:
        """Write the fitted state to a NetCDF file, without pickling.

        An observable that is a function or a system of your own is not written, nor the code of a
        forecaster of your own: pass them to `load`.
        """
        if texts := list(self._changed_parameters()):
            warnings.warn(f"saved is what was fitted: {'; '.join(texts)}", stacklevel=2)
            original = copy.copy(self)
            vars(original).update(self._parameters_of_fit)
            original.save(path)
            return
        fitted = {name: getattr(self, f"{name}_") for name in _FITTED}
        fitted["alarms"] = [
            {"prediction_time": time, **rule.record()} for time, rule in self.alarms_.items()
        ]
        fitted["consistency"] = self.consistency_ and self.consistency_.record()
        fitted["stream"] = None if self._stream is None else self._stream.record()
        members = [member.record() for member in self.members_]
        parameters = self.get_params()
        for name in ("lyapunov_time", "sampling_interval"):
            if has_unit(parameters[name]):
                parameters[name] = f"{checked_parameters(self)[name]:.9f} seconds"
        if self.kind == AUTO:  # what was chosen
            parameters["kind"], parameters["options"] = self.kind_, self.options_
        elif not isinstance(self.kind, str):  # by its name, and its options
            kind = self._kind
            parameters |= {"kind": kind_name(type(kind)), "options": kind.options}
        files.write_saved(path, parameters, fitted, members)

    @classmethod
    def load(
        cls,
        path: str | Path,
        observable: Callable[[FloatArray], FloatArray] | DynamicalSystem | None = None,
        kind: str | ForecasterKind | type[ForecasterKind] | None = None,
    ) -> Self:
        """Read a file of `save`: forecasts are identical, bit for bit.

        Nothing in a file is run or imported. ``observable``: The observable, if it is a function or
        a system of your own, which is not in the file. ``kind``: The class of the forecaster, its
        name, or an object of it, if it is one of your own; its options are in the file. Raises
        ValueError if the file holds no such forecaster or is damaged; if its observable is needed
        and not given, or the given one has other values than the observable of the fit.
        """
        own_class = kind if kind is None or isinstance(kind, type) else class_of(kind)
        with files.as_one_error(path):
            parameters, fitted, members = files.read_saved(path, observable, own_class)
            self = cls(**parameters)
            self.warnings_ = []
            # which older files have not
            older: dict[str, Any] = {
                "labels": None,
                "clock": None,
                "units": None,
                "unskilled_times": [],
                "training_range": None,
                "consistency": None,
            }
            fitted = {**older, **fitted}
            for name in _FITTED:
                setattr(self, f"{name}_", fitted[name])
            if fitted["consistency"] is not None:
                self.consistency_ = ConsistencyTest.restore(fitted["consistency"])
            self.labels_ = None if self.labels_ is None else tuple(map(str, self.labels_))
            self.units_ = None if self.units_ is None else tuple(map(str, self.units_))
            self._parameters_of_fit = self.get_params()
            for name in ("reference_states_", "reference_observable_"):
                setattr(self, name, np.array(getattr(self, name), dtype=np.float64))
            case, timing = self._case(self._components, self.own_parameters_), self._timing
            unfitted = self._kind
            files.check_effort(
                unfitted, self._samples("washout") + timing.boundaries[-1], self.sampling_stride
            )
            for record in members:
                files.check_sizes(record, case, unfitted)
            self.members_ = [unfitted.restore(record, case) for record in members]
            for record, member in zip(members, self.members_, strict=True):
                files.check_complete(record, member.record())
            if self.training_range_ is not None and isinstance(unfitted, Forecaster):
                limits = TrainingLimits(*np.array(self.training_range_, dtype=np.float64))
                self.members_ = [member.within(limits) for member in self.members_]
            given, stored = (
                case.system.observable(self.reference_states_.T),
                self.reference_observable_,
            )
            if not np.allclose(given, stored, rtol=1e-9, atol=0, equal_nan=True):
                raise ValueError(
                    f"the observable that load was given differs from {path}: for states of the "
                    f"training series it is {given}, and was {stored}"
                )
            self.alarms_ = {
                record["prediction_time"]: files.restored_rule(record)
                for record in fitted["alarms"]
            }
            sound = np.isfinite(self.event_threshold_) and self.members_
            if not sound or list(self.alarms_) != timing.times:
                raise ValueError("it has no event threshold, no member, or other prediction times")
            if fitted["stream"]:
                self._stream = self._new_stream().restored(fitted["stream"])
        return self

    # -- what parameters mean ----------------------------------------------------------------------

    @property
    def _kind(self) -> ForecasterKind:
        """The unfitted forecaster with its options."""
        kind = self._model
        if self.kind == AUTO:
            kind = make_kind_of(class_of(kind), self.options_)
        elif not isinstance(kind, ForecasterKind):
            kind = make_kind_of(class_of(kind), self.options or {})
        elif self.options:
            raise ValueError("options are those of the forecaster that kind is: leave them out")
        if "backend" in kind.options:
            backend = usable_backend(kind.options["backend"])
            kind = dataclasses.replace(cast(Any, kind), backend=backend)
        return in_samples(kind) if self.lyapunov_time is None else kind

    @property
    def _timing(self) -> EventTiming:
        checked = checked_parameters(self)
        units = has_unit(self.lyapunov_time), has_unit(self.sampling_interval)
        if self.lyapunov_time is not None and units[0] != units[1]:
            raise ValueError(
                f"lyapunov_time is {self.lyapunov_time} and sampling_interval is "
                f"{self.sampling_interval}: give both with a unit, or both as numbers of one unit"
            )
        return EventTiming(
            checked["lyapunov_time"],
            checked["sampling_interval"],
            checked["prediction_times"],
            self._duration("window"),
        )

    def _duration(self, name: str) -> float:
        """Duration that a parameter gives, or its default."""
        given = getattr(self, name)
        return DURATIONS[name][self.lyapunov_time is None] if given is None else given

    def _samples(self, name: str) -> int:
        """Number of samples in the duration that a parameter gives; a default has one at least."""
        timing, duration = self._timing, self._duration(name)
        if getattr(self, name) is None:
            duration = max(duration, 1 / timing.unit)
        return timing.samples(name, duration)

    def resolved_options(self) -> dict[str, Any]:
        """Options of the kind that the samples are too coarse for, with the nearest that fit."""
        return resolved_by_samples(self._kind, self._timing.unit, self._samples("washout"))

    @property
    def _components(self) -> Components:
        """Components of the training series."""
        is_system = isinstance(self.observable, DynamicalSystem)
        return Components(self.components_, self.labels_, is_system)

    def _case(
        self, components: Components, own_values: Sequence[float] | None = None
    ) -> ForecastingCase:
        """Knowledge of forecasters beside the series, with their ``own`` parameter values."""
        if self.sampling_stride < 1:
            raise ValueError(f"sampling_stride must be 1 at least, not {self.sampling_stride}")
        parameters = None
        if own_values is not None:
            parameters = Parameters(self._parameter_names, tuple(own_values))
        return ForecastingCase(
            system=state_space(self.observable, components),
            time_step=self._timing.sampling_interval / self.sampling_stride,
            sampling_stride=self.sampling_stride,
            steps_per_lyapunov_time=self._timing.unit,
            random_seed=self.random_seed,
            parameters=parameters,
        )

    @property
    def _model(self) -> str | ForecasterKind | type[ForecasterKind]:
        """The kind, or the one that was chosen."""
        if self.kind != AUTO:
            return self.kind
        self._check_fitted()
        return self.kind_

    @property
    def _words(self) -> str:
        model = self._model
        return model if isinstance(model, str) else kind_name(class_of(model))

    @property
    def _parameter_names(self) -> tuple[str, ...]:
        return tuple(self._kind.options["parameters"])

    def _checked_schedules(
        self, given: Any, series: int, steps: int, where: str
    ) -> FloatArray | None:
        """Schedules of a kind that knows the parameters; None of others."""
        if not class_of(self._model).learns_parameters:
            if given is not None:
                raise ValueError(
                    f"forecasters of the kind {self._words} do not know the parameters: leave them "
                    f"out of {where}, or take a kind that does, such as quadratic_aware"
                )
            return None
        if given is None:
            raise ValueError(
                f"forecasters of the kind {self._words} need the values of "
                f"{', '.join(self._parameter_names)}: {where}(..., parameters=...)"
            )
        return as_schedules(given, series, steps, self._parameter_names)

    def _with_inputs(self, washouts: FloatArray, parameters: Any, planned: Any) -> FloatArray:
        """Washouts with the parameters over them and over forecasts, for kinds that know them."""
        series, steps = washouts.shape[:2]
        learns = class_of(self._model).learns_parameters
        if parameters is None and planned is None and not learns:
            return washouts
        given = parameters
        if given is None:
            given = self.own_parameters_ if learns else planned  # refused
        past = self._checked_schedules(given, series, steps - 1, "predict_proba")
        assert past is not None
        reach = self._timing.boundaries[-1]
        ahead = np.repeat(past[:, -1:], reach, axis=1)
        if planned is not None:
            ahead = as_schedules(planned, series, reach, self._parameter_names)
        return with_inputs(washouts, np.concatenate([past, ahead], axis=1))

    def _threshold(self, observable: FloatArray) -> float:
        given = self.event_threshold
        known = observable[~np.isnan(observable)]
        if isinstance(given, Mapping):
            if list(given) != ["quantile"]:
                raise ValueError(
                    f"event_threshold must be a number or {{'quantile': q}}, not {dict(given)}"
                )
            return threshold_at(given["quantile"], known)
        threshold = float(given)
        low, high = float(np.nanmin(observable)), float(np.nanmax(observable))
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
        for fitted_time in fitted:  # computed numbers differ from typed ones by rounding errors
            if abs(fitted_time - time) <= _ROUNDING * abs(fitted_time):
                return fitted_time
        listed = ", ".join(f"{fitted_time:g}" for fitted_time in fitted)
        raise ValueError(f"prediction_time is {time:g}; fitted were the prediction_times {listed}")

    # -- series, votes, and what came true ---------------------------------------------------------

    def _check_fitted(self) -> None:
        for text in self._changed_parameters():
            raise ValueError(f"{text}: call fit again, or set it back")

    def _changed_parameters(self) -> Iterator[str]:
        """Sentences about parameters that have other values than in the fit."""
        if not hasattr(self, "members_"):
            raise RuntimeError("this EventForecaster is not fitted yet: call fit first")
        for name, value in self._parameters_of_fit.items():
            now = getattr(self, name)
            if name not in _OF_SCORES and not is_same(value, now):
                yield f"{name} was {described(value)} in fit, and is {described(now)} now"

    def _like_training(self, series: Any) -> FloatArray:
        self._check_fitted()
        given = labelled_series(series)
        self._check_clock(given, self.clock_)
        components = self._components
        if self.labels_ is None:
            check_order(self.observable, given.labels)
            if given.labels is not None:
                warnings.warn(
                    f"the series have the labels {', '.join(given.labels)}, and the training "
                    f"series had none: the order of components is taken for the same",
                    stacklevel=4,
                )
        states = components.arranged(given.states, given.labels)
        given.check_units(components.units_for(given.labels, self.units_))
        return states

    def _check_clock(self, series: LabelledSeries, seconds: float | None) -> None:
        """Compare a clock with the sampling interval, or dates with those of the training."""
        interval, with_unit = self._timing.sampling_interval, has_unit(self.sampling_interval)
        step = series.step
        if step is None:
            return
        if series.dated and seconds is not None:
            series.check_step(seconds, "the interval of the training series")
        elif series.dated == with_unit:
            series.check_step(interval, "sampling_interval")
        elif series.dated and self.lyapunov_time is None and interval == 1:
            return  # durations are in samples, of any length
        elif unit_of_dates(*((step, interval) if series.dated else (interval, step))) is None:
            given = f"{interval:g} seconds" if with_unit else f"{interval:g}, in no unit of time"
            raise ValueError(
                f"the {'dates' if series.dated else 'times'} of the series are "
                f"{readable(step) if series.dated else f'{step:g}'} apart, but sampling_interval "
                f"is {given}: give sampling_interval={readable(step)!r} and lyapunov_time with "
                f"its unit, such as '9 hours', or both as numbers of one unit"
            )

    def _in_parts(self, states: FloatArray) -> FloatArray:
        """A single series in parts that are left out in turn."""
        parts, reach = np.array_split(states[0], PARTS), self._timing.boundaries[-1]
        least, shortest = self._samples("washout") + reach, len(parts[-1])
        if shortest < least:
            raise ValueError(
                f"calibrating leaves out one {PARTS}th of a single series in turn; it has "
                f"{shortest} samples, and a washout and the last prediction window take {least}: "
                "give a longer series or several, or calibrate=False"
            )
        return np.stack(parts) if shortest == len(parts[0]) else padded(parts)

    def _short_series(self, states: FloatArray) -> list[str]:
        """A sentence about series that are too short for any forecast; none without such series."""
        lengths, least = series_lengths(states), self._samples("washout")
        least += self._timing.boundaries[-1]
        if lengths is None or not (short := int((lengths < least).sum())):
            return []
        return [
            f"{short} of {len(lengths)} series have no starting point: they have fewer than "
            f"{least} samples, which a washout and the last prediction window take"
        ]

    def _new_stream(self) -> ObservationStream:
        interval = self._timing.sampling_interval
        seconds = interval if has_unit(self.sampling_interval) else self.clock_
        return ObservationStream(self.components_, self._samples("washout"), interval, seconds)

    def _washouts(self, series: Any) -> FloatArray:
        states, washout = self._like_training(series), self._samples("washout")
        if states.shape[1] < washout:
            raise ValueError(
                f"the washout takes {washout} samples, the series have {states.shape[1]}"
            )
        lengths = series_lengths(states)
        if lengths is None:
            return states[:, -washout:]
        if (shortest := int(lengths.min())) < washout:
            raise ValueError(f"the washout takes {washout} samples, a series has {shortest}")
        ends = zip(states, lengths.tolist(), strict=True)
        return np.stack([row[end - washout : end] for row, end in ends])

    def _points(
        self, case: ForecastingCase, observed: FloatArray, value: FloatArray, spacing: int
    ) -> ObservedPoints:
        return observed_points(
            observed,
            value,
            case.system.observable,
            boundaries=self._timing.boundaries,
            washout=self._samples("washout"),
            spacing=spacing,
        )

    def _verified(self, series: Any) -> Verified:
        """Starting points in test series, what their probabilities are made from, valid shares."""
        states, case = self._like_training(series), self._case(self._components)
        for text in self._short_series(states):
            warnings.warn(text, stacklevel=4)
        value = _observable_of(case, states)
        points = self._points(case, states, value, self._samples("start_spacing"))
        events = Events(self._timing, self.event_threshold_)
        return events, points, *self._values(points.washouts)

    def _p_values(self, washouts: FloatArray) -> FloatArray:
        if self.consistency_ is None:
            raise ValueError(
                "there is no test of consistency: it takes trajectories of a kind without "
                f"parameters, a washout of {LEAST_WASHOUT} samples at least and of which the kind "
                "needs no more than half, and two training series, with some 40 valid hindcasts"
            )
        return self.consistency_.p_values(self.members_[0], washouts)

    def _warn_of_invalid(self, valid: FloatArray) -> None:
        """Warn the caller's caller of probabilities that invalid forecasts have a part in."""
        if isinstance(self.members_[0], EventClassifier):
            return
        some = f"behind {(valid < 1).sum()} of {len(valid)} probabilities"
        for text in invalid_share(float(1 - valid.mean()), some, self.members_[0]):
            warnings.warn(f"{text} (valid_share has each)", stacklevel=3)

    def _warn_of_odd(self, washouts: FloatArray) -> None:
        """Warn the caller's caller of washouts that are unlike those of the training series."""
        if self.consistency_ is not None:
            for text in self.consistency_.finding(self._p_values(washouts)):
                warnings.warn(text, stacklevel=3)

    def _values(self, washouts: FloatArray) -> tuple[ByTime, ByTime]:
        """What probabilities after washouts ``(points, steps, component)`` are made from.

        Also the share of the forecasts that are valid.
        """
        events = Events(self._timing, self.event_threshold_)
        if isinstance(classifier := self.members_[0], EventClassifier):
            sound = dict.fromkeys(events.timing.times, np.ones(len(washouts)))
            return events.by_time(classifier.probabilities(washouts)), sound
        observable = self._case(self._components).system.observable
        boundaries = events.timing.boundaries
        votes: list[WindowSummaries] = []
        for member in self.members_:
            votes += window_forecasts(member, observable, washouts, boundaries).members
        return events.shares(votes), events.valid(votes)


def _observable_of(case: ForecastingCase, states: FloatArray) -> FloatArray:
    """Observable of series, ``(series, time)``; NaN where shorter series have ended."""
    if series_lengths(states) is None:
        return case.system.observable(states.transpose(2, 0, 1))
    value = np.full(states.shape[:2], np.nan)
    value[~np.isnan(states[..., 0])] = case.system.observable(samples_of(states).T)
    return value


def _washouts_of(training: FloatArray, points: ObservedPoints, timing: EventTiming) -> FloatArray:
    """Washouts of points of training series, with the inputs over them and over forecasts."""
    washouts, steps = points.washouts, points.washouts.shape[1]
    inputs = training.shape[2] - washouts.shape[2]
    if not inputs:
        return washouts
    around = segments(training, points.points, steps - 1, timing.boundaries[-1])
    return up_to_sample(around, steps, inputs)


def _votes_of_kept(
    members: Sequence[Forecaster],
    case: ForecastingCase,
    training: FloatArray,
    points: ObservedPoints,
    timing: EventTiming,
) -> list[WindowSummaries]:
    """Votes of the members themselves, at some points of the series that they have learnt from."""
    washouts = _washouts_of(training, points, timing)
    some = washouts[:: -(-len(washouts) // _POINTS_OF_KEPT)]
    votes: list[WindowSummaries] = []
    for member in members:
        forecasts = window_forecasts(member, case.system.observable, some, timing.boundaries)
        votes += forecasts.members
    return votes


def _step_error(
    member: Forecaster,
    case: ForecastingCase,
    training: FloatArray,
    points: ObservedPoints,
    names: Sequence[str],
) -> list[str]:
    """A sentence about a member that errs much in its first step (`causes.step_error`).

    It is refitted without the first series, whose points it is judged by, if there are others.
    """
    washout, of_points = points.washouts.shape[1], points.points
    if len(training) > 1:
        member = next(member.leave_one_out(training, case, washout)).within(member.limits)
        first = of_points.series == 0
        of_points = SeriesPoints(of_points.series[first], of_points.step[first])
    if not len(of_points.series):
        return []
    return list(step_error(member, case, training, of_points, washout, names))


def _left_out(
    members: Sequence[Forecaster],
    case: ForecastingCase,
    training: FloatArray,
    points: ObservedPoints,
    timing: EventTiming,
    left_out: Sequence[LeftOut] | None,
) -> list[WindowSummaries]:
    """Votes at points of training series, by members refitted without that series."""
    washouts, steps = _washouts_of(training, points, timing), points.washouts.shape[1]
    votes = []
    for member in members:
        forecasts = out_of_sample_forecasts(
            member,
            training,
            case,
            steps,
            case.system.observable,
            washouts,
            points.points.series,
            timing.boundaries,
            left_out,
        )
        votes += forecasts.members
    return votes

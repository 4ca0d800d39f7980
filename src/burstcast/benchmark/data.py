"""Data of a case of the benchmark, made from a seed: what is exported, and the truth, which is not.

Series, noise and resamples have the streams of random numbers that a case of the workflow has: with
the same settings and the same seed, both have the same data, bit for bit.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from burstcast import random_streams
from burstcast.arrays import FloatArray, IntArray
from burstcast.benchmark.cases import SEED, BenchmarkCase
from burstcast.benchmark.records import MissingRecordError
from burstcast.benchmark.task import (
    ForecastTask,
    TaskData,
    before_horizon,
    data_digest,
    horizon_starts,
    horizon_stream,
)
from burstcast.data.dataset import (
    component_scales,
    generate_ensemble,
    initial_states,
    observed_series,
)
from burstcast.data.starting_points import (
    SeriesPoints,
    crossing_points,
    horizon_events,
    segments,
)
from burstcast.forecast.horizon import HorizonSearch
from burstcast.forecast.observed_points import ObservedPoints, observed_points
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.sampling import sampled_initial_states
from burstcast.systems.state_space import component_names


@dataclass(frozen=True)
class CaseData:
    """Data of a case under one seed."""

    case: BenchmarkCase
    seed: int
    training: FloatArray  #: observed training series, ``(series, time, component)``
    #: starting points in the test series, their observed washouts, and the true windows
    test: ObservedPoints
    #: true states of the system at the starting points of `test`, ``(points, component)``: for
    #: bounds alone
    true_states: FloatArray
    observable: FloatArray  #: true observable of the test series, ``(series, time)``
    #: before_events, before_events_true: observed components, and true states of the system, up to
    #: each event whose prediction horizon is measured, ``(events, steps, component)``
    before_events: FloatArray
    before_events_true: FloatArray
    truth_before_events: FloatArray  #: true observable of the same steps, ``(events, steps)``
    event_points: SeriesPoints  #: where these events begin in the kept series
    mean_observable: float  #: over all kept series

    @property
    def search(self) -> HorizonSearch:
        """Search for prediction horizons."""
        return self.case.horizon_search(self.mean_observable)

    @cached_property
    def horizon_starts(self) -> tuple[IntArray, IntArray]:
        """Starting points of prediction horizons (`burstcast.benchmark.task.horizon_starts`)."""
        stream = horizon_stream(self.seed, self.case.name)
        return horizon_starts(self.event_points, self.search, stream)

    def before_horizon(self, states: FloatArray) -> FloatArray:
        """Washouts ``(points, steps, component)`` of `horizon_starts`, from segments of events."""
        return before_horizon(states, self.horizon_starts, self.search.washout)

    @cached_property
    def digest(self) -> str:
        """Sixteen hexadecimal digits that depend on all data that are exported."""
        horizon = self.before_horizon(self.before_events)
        return data_digest([self.training, self.test.washouts, horizon])

    @cached_property
    def task(self) -> ForecastTask:
        """Task of the forecasts."""
        return ForecastTask(
            case=self.case.name,
            version=str(self.case.version),
            seed=self.seed,
            space=self.case.space,
            points=len(self.test.points),
            boundaries=self.case.boundaries,
            prediction_times_lt=self.case.prediction_times_lt,
            window_lt=self.case.window_lt,
            resolution_lt=self.case.resolution_lt,
            horizon_points=len(self.horizon_starts[0]),
            horizon_steps=self.search.longest_lead_time,
        )

    @property
    def exported(self) -> TaskData:
        """Exported data, without the truth."""
        case = self.case
        return TaskData(
            task=self.task,
            about=case.about,
            training=self.training,
            points=self.test.points,
            washouts=self.test.washouts,
            horizon_washouts=self.before_horizon(self.before_events),
            noise=case.noise,
            event_threshold=case.event_threshold,
            sampling_interval=case.sampling_interval,
            search=self.search,
            tolerance=case.tolerance,
        )


def make_case(case: BenchmarkCase, seed: int = SEED) -> CaseData:
    """Make the data of a case: a second or two; a turbulent flow takes a minute."""
    try:
        states = _simulated(case, seed) if case.record is None else case.record()
    except MissingRecordError as error:
        raise MissingRecordError(f"the case {case.name}: {error}") from None
    training, test = case.training_series, case.test_series
    if len(states) < training + test:
        raise ValueError(
            f"under the seed {seed}, {len(states)} series of the case {case.name} do not "
            f"laminarise, and it takes {training + test}: choose another seed"
        )
    observable = np.stack([case.system.observable(series.T) for series in states])
    observed = _observed(case, states, observable, seed)
    rows = slice(training, training + test)
    points = observed_points(
        observed[rows],
        observable[rows],
        case.space.observable,
        spacing=case.steps(case.start_spacing_lt),
        washout=case.steps(case.washout_lt),
        boundaries=case.boundaries,
    )
    mean = float(observable.mean())
    before = case.horizon_search(mean).steps_before_event
    events = horizon_events(
        crossing_points(observable, case.event_threshold), training, before, case.horizon_events
    )
    found = CaseData(
        case=case,
        seed=seed,
        training=observed[:training],
        test=points,
        true_states=segments(states[rows], points.points, 0, 0)[:, 0],
        observable=observable[rows],
        before_events=segments(observed, events, before, 0),
        before_events_true=segments(states, events, before, 0),
        truth_before_events=segments(observable, events, before, 0),
        event_points=events,
        mean_observable=mean,
    )
    if case.digest and seed == SEED and found.digest != case.digest:
        raise ValueError(
            f"this machine makes other data of the case {case.name} (digest {found.digest}) than "
            f"the frozen ones ({case.digest}): its scores could not be compared with the "
            f"leaderboard"
        )
    return found


def _simulated(case: BenchmarkCase, seed: int) -> FloatArray:
    """True series that do not laminarise, ``(series, time, component)``."""
    assert isinstance(case.system, DynamicalSystem)
    stream = random_streams.stream(seed, "ensemble", case.ensemble_name)
    if case.initial_state is None:
        start = sampled_initial_states(case.system, case.series, stream)
    else:
        start = initial_states(
            np.array(case.initial_state),
            case.perturbed_component,
            case.perturbation,
            case.series,
            stream,
        )
    batches = generate_ensemble(
        case.system,
        start,
        time_step=case.time_step,
        sampling_stride=case.sampling_stride,
        transient_steps=round(case.transient / case.time_step),
        kept_steps=round(case.duration / case.time_step),
        laminarisation_threshold=case.laminarisation_threshold,
    )
    return np.concatenate([batch.states for batch in batches])


def _observed(
    case: BenchmarkCase, states: FloatArray, observable: FloatArray, seed: int
) -> FloatArray:
    """Noisy observations of true states, ``(series, time, component)``."""
    measured = observable[..., np.newaxis]
    if case.sensors is not None:
        # a series at a time, since series of a turbulent flow are large
        readings = [np.moveaxis(case.sensors(np.moveaxis(one, -1, 0)), 0, -1) for one in states]
        parts = [(np.stack(readings), case.ensemble_name)]
        parts.append((measured, f"{case.ensemble_name} observable"))
    elif case.space is case.system:
        parts = [(states, case.name)]
    else:
        names = component_names(case.system)
        seen = states[..., [names.index(name) for name in case.observed]]
        # in one layout: the last bits of sums over components depend on it
        both = np.concatenate([seen, measured], axis=2)
        parts = [(np.ascontiguousarray(both), case.name)]
    noisy = []
    for true, stream in parts:
        scales = component_scales(true[: case.training_series])
        noisy.append(observed_series(true, 0, case.noise, scales, seed, stream))
    return noisy[0] if len(noisy) == 1 else np.concatenate(noisy, axis=2)

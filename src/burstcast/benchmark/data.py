"""Data of a case of the benchmark, made from a seed: what is exported, and the truth, which is not.

Series, noise and resamples have the streams of random numbers that a case of the workflow has: with
the same settings and the same seed, both have the same data, bit for bit.
"""

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from burstcast import random_streams
from burstcast.arrays import FloatArray, IntArray
from burstcast.benchmark.cases import SEED, BenchmarkCase
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
from burstcast.systems.sampling import sampled_initial_states
from burstcast.systems.state_space import component_names

_DIGEST_DECIMALS = 6
"""Data are rounded to so many decimals before they are digested: rounding errors of a machine, such
as those of another logarithm, then do not count, and chaos amplifies all that do."""


@dataclass(frozen=True)
class CaseData:
    """Data of a case under one seed.

    Attributes
    ----------
    case, seed
        Which.
    training
        Observed training series, ``(series, time, component)``.
    test
        Starting points in the test series, their observed washouts, and the true windows.
    true_states
        True states of the system at the starting points of `test`, ``(points, component)``: for
        bounds alone.
    observable
        True observable of the test series, ``(series, time)``.
    before_events, before_events_true
        Observed components, and true states of the system, up to each event whose prediction
        horizon is measured, ``(events, steps, component)``.
    truth_before_events
        True observable of the same steps, ``(events, steps)``.
    event_points
        Where these events begin in the kept series.
    mean_observable
        Over all kept series.
    """

    case: BenchmarkCase
    seed: int
    training: FloatArray
    test: ObservedPoints
    true_states: FloatArray
    observable: FloatArray
    before_events: FloatArray
    before_events_true: FloatArray
    truth_before_events: FloatArray
    event_points: SeriesPoints
    mean_observable: float

    @property
    def steps(self) -> int:
        """Steps of a forecast from a starting point of the test."""
        return self.case.boundaries[-1]

    @property
    def search(self) -> HorizonSearch:
        """How prediction horizons are looked for."""
        return self.case.horizon_search(self.mean_observable)

    @cached_property
    def horizon_starts(self) -> tuple[IntArray, IntArray]:
        """Starting points of prediction horizons: row of the event, and step of its segment.

        In a random order, which does not tell how far the event is. Points that are the same step
        of the same series, before two events, are there once.
        """
        search = self.search
        leads = np.array([self.case.steps(lead) for lead in search.lead_times_lt])
        event = np.repeat(np.arange(len(self.event_points)), len(leads))
        step = np.tile(self.before_events.shape[1] - 1 - leads, len(self.event_points))
        before = search.steps_before_event
        in_series = self.event_points.step[event] - before + step
        where = np.stack([self.event_points.series[event], in_series], axis=1)
        _, first = np.unique(where, axis=0, return_index=True)
        stream = random_streams.stream(self.seed, "benchmark horizon", self.case.name)
        chosen = stream.permutation(np.sort(first))
        return event[chosen], step[chosen]

    def before_horizon(self, states: FloatArray) -> FloatArray:
        """Washouts ``(points, steps, component)`` of `horizon_starts`, from segments of events."""
        event, step = self.horizon_starts
        starts = SeriesPoints(event, step)
        return segments(states, starts, self.search.washout - 1, 0)

    @cached_property
    def digest(self) -> str:
        """Sixteen hexadecimal digits that depend on all data that are exported."""
        found = hashlib.sha256()
        for array in (self.training, self.test.washouts, self.before_horizon(self.before_events)):
            # zero has one sign
            found.update((np.round(array, _DIGEST_DECIMALS) + 0.0).tobytes())
        return found.hexdigest()[:16]


def make_case(case: BenchmarkCase, seed: int = SEED) -> CaseData:
    """Make the data of a case: a second or two; a turbulent flow takes a minute.

    Parameters
    ----------
    case
        The case.
    seed
        Root of all its random numbers.

    Raises
    ------
    ValueError
        If too many series laminarise under this seed, or if data under `SEED` are not those of the
        frozen case.
    """
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
    states = np.concatenate([batch.states for batch in batches])
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
            f"those that were frozen ({case.digest}): its scores could not be compared with the "
            f"leaderboard"
        )
    return found


def _observed(
    case: BenchmarkCase, states: FloatArray, observable: FloatArray, seed: int
) -> FloatArray:
    """What is observed of true states, with noise, ``(series, time, component)``."""
    measured = observable[..., np.newaxis]
    if case.sensors is not None:
        # a series at a time: those of a turbulent flow are large
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

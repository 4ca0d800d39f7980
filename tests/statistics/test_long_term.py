"""Long-term runs of made-up forecasters whose fate is known; survival and escape rates."""

from dataclasses import dataclass, field

import numpy as np
import pytest
import scipy.stats
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.statistics import long_term
from burstcast.statistics.long_term import (
    Fate,
    FixedPointCriterion,
    LongTermSettings,
    long_term_starting_points,
    run_long_term,
)
from burstcast.statistics.reductions import reduce_series
from burstcast.statistics.survival import Lifetimes, escape_rate, survival_curve
from helpers_library import MadeUpForecaster

EDGES = np.linspace(0.0, 1.0, 11)
FIXED_POINT = FixedPointCriterion(variation=0.01, above=0.05, interval=40)


def first_component(state):
    return state[0]


@dataclass
class Scripted(MadeUpForecaster):
    """Plays given series ``(steps, dimension, trajectories)``; the washout tells which one.

    Counts how many trajectory steps it was asked for.
    """

    script: np.ndarray
    bound: float = np.inf
    asked: int = field(default=0)

    def start(self, washout):
        # which trajectory, and how far it is
        return np.stack([washout[-1, 0], np.zeros(washout.shape[2])])

    def advance(self, memory, steps):
        which, begin = memory[0].astype(int), int(memory[1, 0])
        self.asked += steps * len(which)
        return self.script[begin : begin + steps, :, which], memory + np.array([[0.0], [steps]])

    def diverged(self, outputs):
        return ~(np.abs(outputs) <= self.bound).all(axis=(0, 1))

    def washouts(self):
        points = self.script.shape[2]
        washouts = np.zeros((points, 3, self.script.shape[1]))
        washouts[:, -1] = np.arange(points)[:, np.newaxis]
        return washouts


def brute_force(states):
    """Fate and lifetime of one trajectory ``(steps, dimension)`` from its whole course."""
    observable = states[:, 0]
    for step, state in enumerate(states, start=1):
        if not (np.abs(state) <= 10.0).all():
            return Fate.DIVERGED, step
        if state[0] > 0.48:
            return Fate.LAMINAR, step
    last = observable[-FIXED_POINT.interval :]
    if not (np.ptp(last) < FIXED_POINT.variation and last.min() > FIXED_POINT.above):
        return Fate.KEPT, len(states)
    since = 0
    for step in range(len(states)):
        if np.ptp(observable[since : step + 1]) >= FIXED_POINT.variation:
            since = step
    return Fate.FIXED_POINT, min(since, len(states) - FIXED_POINT.interval) + 1


def script_of(kinds, steps, seed=0):
    """Series of given kinds, with a second component that moves as the first one does."""
    generator, time, interval = np.random.default_rng(seed), np.arange(steps), FIXED_POINT.interval
    columns = []
    for kind in kinds:
        values, event = generator.uniform(0.1, 0.4, steps), int(generator.integers(0, steps))
        lost = generator.choice([np.nan, np.inf, -np.inf, 1e200])
        soon = slice(min(event + 3, steps - 1), None)
        changes = {
            "laminar": [(slice(event, None), 0.5)],
            "diverging": [(slice(event, None), lost)],
            "laminar then diverging": [(event, 0.7), (soon, np.nan)],
            "at the threshold": [(event, 0.48)],
            "just beyond the threshold": [(event, np.nextafter(0.48, 1))],
            "settling": [(slice(None), 0.2 + 0.1 * np.exp(-time / 3) * np.cos(time))],
            "settling low": [(slice(None), 0.04 + 0.1 * np.exp(-time / 3))],
            "settling late": [(slice(-interval, None), 0.3)],
            "settling too late": [(slice(1 - interval, None), 0.3)],
            "resting and leaving": [(slice(steps // 4), 0.3)],
            "resting": [(slice(None), 0.3)],
        }
        for where, value in changes.get(kind, ()):
            values[where] = value
        columns.append(np.stack([values, -values], axis=1))
        if kind == "both at once":
            columns[-1][event] = 0.5, np.nan
    return np.stack(columns, axis=2)


def copies(series):
    """Three trajectories alike: of one alone, the washouts would have no range to compare with."""
    return np.repeat(series[:, :, np.newaxis], 3, axis=2)


KINDS = (
    *("chaotic", "laminar", "diverging", "laminar then diverging", "both at once"),
    *("at the threshold", "just beyond the threshold", "settling", "settling low"),
    *("settling late", "settling too late", "resting and leaving", "resting"),
)


def run(script, threshold=0.48, fixed_point=FIXED_POINT, bound=10.0, chunk=100):
    forecaster = Scripted(script, bound)
    settings = LongTermSettings(len(script), EDGES, threshold, fixed_point)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(long_term, "STEPS_PER_CHUNK", chunk)
        return run_long_term(
            forecaster, first_component, forecaster.washouts(), settings
        ), forecaster


@settings(max_examples=60)
@given(
    st.lists(st.sampled_from(KINDS), min_size=1, max_size=12),
    st.integers(FIXED_POINT.interval, 260),
    st.integers(1, 300),
    st.integers(0, 1000),
)
def test_fates_and_statistics_are_those_of_the_whole_series(kinds, steps, chunk, seed):
    script = script_of(kinds, steps, seed)
    result, _ = run(script, chunk=chunk)
    expected = [brute_force(states) for states in script.transpose(2, 0, 1)]
    fates, lifetimes = map(list, zip(*expected, strict=True))
    assert result.fates.tolist() == fates
    assert result.lifetimes.tolist() == lifetimes
    kept = script[:, :, np.array(fates) == Fate.KEPT].transpose(2, 0, 1)
    assert result.statistics.moments.count == kept.shape[0] * steps
    if len(kept):
        expected = reduce_series([kept], first_component, EDGES).merged(slice(None))
        np.testing.assert_array_equal(result.statistics.histogram.counts, expected.histogram.counts)
        np.testing.assert_array_equal(
            result.statistics.moments.mean_product, expected.moments.mean_product
        )


def test_nothing_is_discarded_without_criteria():
    script = script_of(["chaotic", "laminar", "settling"], 120)
    assert (run(script, threshold=None, fixed_point=None)[0].fates == Fate.KEPT).all()


@pytest.mark.parametrize(
    ("kind", "least", "most"),
    [("laminar", 0.1, 0.15), ("settling", 0, 0.6), ("chaotic", 1, 1), ("diverging", 0, 0.99)],
)
def test_a_run_that_has_ended_costs_no_more_time(kind, least, most):
    script = script_of([kind] * 3, 4000)
    if kind == "laminar":
        script[400:] = 0.5
    result, forecaster = run(script)
    assert least <= forecaster.asked / (3 * 4000) <= most
    assert np.isnan(result.statistics.moments.mean).all() == (kind != "chaotic")


def test_slow_departure_from_an_unstable_fixed_point_is_not_cut_off():
    # From a disturbance as small as rounding errors to the size of the flow in 1500 steps: at rest,
    # as far as one can see, for most of that time.
    time = np.arange(1600)
    growth = np.exp(np.log(0.1 / 1e-17) * (time / 1500))
    values = 0.2 + np.minimum(1e-17 * growth, 0.1) * np.cos(time)
    result, forecaster = run(copies(np.stack([values, values], axis=1)))
    assert (result.fates == Fate.KEPT).all()
    assert forecaster.asked == 3 * 1600
    # nor is a flow whose observable alone is at rest: what moves moves the observable later
    values = np.where(time < 900, 0.2, 0.2 + 0.1 * np.sin(time))
    result, _ = run(copies(np.stack([values, np.sin(time)], axis=1)))
    assert (result.fates == Fate.KEPT).all()


@pytest.mark.parametrize("chunk", [2, 7, 100])
@pytest.mark.parametrize("small", [0.25, 2.0**-33])
def test_a_variation_as_large_as_the_criterion_says_is_no_fixed_point(chunk, small):
    # exact sums; the smaller one is below FIXED_POINT_RANGE of the washouts, too
    values = np.where(np.arange(1000) % 2, 0.25, 0.25 + small)
    states = np.stack([values, np.full(1000, 0.1)], axis=1)
    for variation, fate in ((small, Fate.KEPT), (1.001 * small, Fate.FIXED_POINT)):
        criterion = FixedPointCriterion(variation=variation, above=0.05, interval=40)
        result, _ = run(copies(states), threshold=None, fixed_point=criterion, chunk=chunk)
        assert set(result.fates) == {fate}


def test_starting_points_are_shared_out_evenly_as_many_as_there_is_room_for():
    points = long_term_starting_points(3, 100, spacing=10, washout=5, count=8)
    assert points.series.tolist() == [0, 0, 0, 1, 1, 1, 2, 2]
    assert points.step.tolist() == [4, 14, 24, 4, 14, 24, 4, 14]
    points = long_term_starting_points(2, 30, spacing=10, washout=5, count=500)
    assert points.series.tolist() == [0, 0, 0, 1, 1, 1]


# -- survival curves and escape rates --------------------------------------------------------------


def exponential(rate, series, length, seed=1):
    """Lifetimes that are exponential, seen at whole steps and for so long."""
    steps = np.ceil(np.random.default_rng(seed).exponential(1 / rate, series)).astype(int)
    return Lifetimes(np.minimum(steps, length), steps <= length, length)


@settings(max_examples=40)
@given(st.lists(st.integers(1, 12), min_size=1, max_size=40), st.floats(0.5, 0.99), st.data())
def test_survival_curve_is_the_kaplan_meier_estimate_with_exact_intervals(ends, confidence, data):
    """Escapes at the last step and survivors are told apart."""
    steps = np.minimum(ends, 10)
    escaped = np.array([end < 10 or (end == 10 and data.draw(st.booleans())) for end in ends])
    curve = survival_curve(Lifetimes(steps, escaped, 10), np.arange(11), confidence)
    censored = scipy.stats.CensoredData(uncensored=steps[escaped], right=steps[~escaped])
    expected = scipy.stats.ecdf(censored).sf.evaluate(np.arange(11))
    np.testing.assert_allclose(curve[0], expected, atol=1e-12)
    for share, low, high in zip(*curve, strict=True):
        alive = scipy.stats.binomtest(round(share * len(ends)), len(ends))
        assert (low, high) == pytest.approx(alive.proportion_ci(confidence, "exact"), abs=1e-9)


def test_escape_rate_is_the_maximum_of_the_likelihood():
    lifetimes = exponential(1e-3, 400, 2000)
    result = escape_rate(lifetimes, 1.0, 0.95, start=0)
    data = scipy.stats.CensoredData(
        uncensored=lifetimes.steps[lifetimes.escaped], right=lifetimes.steps[~lifetimes.escaped]
    )
    _, scale = scipy.stats.expon.fit(data, floc=0)
    assert result.rate == pytest.approx(1 / scale, rel=1e-6)
    assert result.escapes == lifetimes.escaped.sum()


def test_units_are_those_of_time_and_nothing_at_risk_has_no_rate():
    lifetimes = exponential(1e-2, 50, 100)
    steps, times = (escape_rate(lifetimes, interval, 0.9) for interval in (1.0, 0.25))
    assert times.rate == pytest.approx(4 * steps.rate)
    assert times.time_at_risk == pytest.approx(steps.time_at_risk / 4)
    gone = Lifetimes(np.array([3, 4]), np.array([True, True]), 100)
    result = escape_rate(gone, 1.0, 0.95)
    assert (result.escapes, result.time_at_risk) == (0, 0)
    assert np.isnan([result.rate, result.low, result.high]).all()


@given(st.integers(0, 30), st.floats(0.5, 0.99))
def test_ends_of_the_interval_have_exact_tails(escapes, confidence):
    steps = np.where(np.arange(40) < escapes, 60, 100)
    lifetimes = Lifetimes(steps, np.arange(40) < escapes, 100)
    result = escape_rate(lifetimes, 1.0, confidence, start=20)
    tail = (1 - confidence) / 2
    counts = scipy.stats.poisson
    assert counts.cdf(escapes, result.high * result.time_at_risk) == pytest.approx(tail)
    if escapes:
        assert counts.sf(escapes - 1, result.low * result.time_at_risk) == pytest.approx(tail)
    else:
        assert result.rate == result.low == 0.0
        # the rule of three
        assert result.high == pytest.approx(-np.log(tail) / result.time_at_risk)


def test_the_beginning_is_left_out():
    steps, escaped = np.array([100, 500, 501, 2000]), np.array([True, True, True, False])
    result = escape_rate(Lifetimes(steps, escaped, 2000), 1.0, 0.95)
    assert (result.escapes, result.time_at_risk) == (1, 1501)
    assert result == escape_rate(Lifetimes(steps, escaped, 2000), 1.0, 0.95, start=500)


NOBODY = Lifetimes(np.array([], int), np.array([], bool), 9)


def run_of_nothing():
    settings, nothing = LongTermSettings(5, EDGES, None, None), np.zeros((0, 3, 2))
    return run_long_term(Scripted(np.zeros((5, 2, 1))), first_component, nothing, settings)


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: LongTermSettings(39, EDGES, None, FIXED_POINT), "judged by its last 40"),
        (lambda: LongTermSettings(0, EDGES, None, None), "one step"),
        (run_of_nothing, "starting point"),
        (lambda: long_term_starting_points(2, 4, spacing=10, washout=5, count=500), "no room"),
        (lambda: escape_rate(exponential(1e-2, 5, 100), 1.0, 0.95, start=100), "step 100 of 100"),
        (
            lambda: survival_curve(exponential(1e-2, 5, 100), np.array([101]), 0.95),
            "100 steps only",
        ),
        (lambda: survival_curve(NOBODY, np.array([1]), 0.95), "needs a series"),
    ],
)
def test_what_makes_no_sense_is_refused(made, message):
    with pytest.raises(ValueError, match=message):
        made()

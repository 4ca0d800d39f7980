"""Return times: counts, intervals and their coverage against closed forms."""

import numpy as np
import pytest
import scipy
from scipy.signal import lfilter

from burstcast.base.poisson import poisson_interval, rate_bound
from burstcast.statistics.return_times import events_in_blocks, return_times


def ornstein_uhlenbeck(series, samples, interval, generator):
    """Exact samples of the process of unit variance and correlation time 1, stationary."""
    memory = np.exp(-interval)
    noise = generator.normal(size=(series, samples)) * np.sqrt(1 - memory**2)
    noise[:, 0] /= np.sqrt(1 - memory**2)
    return lfilter([1.0], [1.0, -memory], noise, axis=1)


def crossing_rate(level, interval):
    """Upward crossings of the sampled process per unit of time: P(X_0 < u <= X_1) / interval."""
    correlation = np.exp(-interval)
    both = scipy.stats.multivariate_normal([0, 0], [[1, correlation], [correlation, 1]])
    return (scipy.stats.norm.cdf(level) - both.cdf([level, level])) / interval


def coverage_of_ornstein_uhlenbeck(repetitions, seed):
    """Share of intervals that hold the closed form, by level, and how often blocks were used."""
    levels, interval = np.array([0.5, 1.0, 1.5, 2.0]), 0.1
    truth = np.array([1 / crossing_rate(level, interval) for level in levels])
    generator = np.random.default_rng(seed)
    held, blocks = np.zeros((2, repetitions, 4), dtype=bool)
    for number in range(repetitions):
        process = ornstein_uhlenbeck(1, 20_001, interval, generator)
        found = return_times(*events_in_blocks(process, levels, interval, steps=500), levels)
        held[number] = (found.low <= truth) & (truth <= found.high)
        blocks[number] = found.clustered
    return held.mean(axis=0), blocks.mean(axis=0)


def coverage_of_poisson(repetitions, seed):
    """Share of intervals that hold the return time of Poisson processes of three rates."""
    rates, generator = np.array([0.1, 0.3, 2.0]), np.random.default_rng(seed)
    held = np.zeros((repetitions, 3), dtype=bool)
    for number in range(repetitions):
        times = generator.uniform(1.0, 20.0, size=60)
        found = return_times(generator.poisson(np.outer(times, rates)), times, rates)
        held[number] = (found.low <= 1 / rates) & (1 / rates <= found.high)
    return held.mean(axis=0)


def test_intervals_hold_closed_forms():
    """A hundred repetitions: within three standard errors of 0.95."""
    of_process, blocks = coverage_of_ornstein_uhlenbeck(100, seed=1)
    assert (of_process >= 0.88).all()
    # crossings of high levels come in clusters: intervals of blocks are used, and needed
    assert blocks[0] < 0.5 < blocks[2]
    assert (coverage_of_poisson(100, seed=2) >= 0.88).all()


def test_intervals_that_took_clusters_for_independent_events_would_be_too_short():
    levels, interval, held = [2.0], 0.1, []
    truth, generator = 1 / crossing_rate(2.0, interval), np.random.default_rng(5)
    for _ in range(200):
        process = ornstein_uhlenbeck(1, 20_001, interval, generator)
        events, time = events_in_blocks(process, levels, interval)
        low, high = poisson_interval(int(events.sum()), float(time.sum()), 0.95)
        held.append(1 / high <= truth <= 1 / low)
    assert np.mean(held) < 0.9


@pytest.mark.long
def test_coverage_of_intervals_in_500_repetitions():
    of_process, _ = coverage_of_ornstein_uhlenbeck(500, seed=3)
    assert ((of_process >= 0.93) & (of_process <= 0.97)).all(), of_process
    of_counts = coverage_of_poisson(500, seed=4)
    assert ((of_counts >= 0.93) & (of_counts <= 0.97)).all(), of_counts


@pytest.mark.parametrize(("mean", "most"), [(5, 0.985), (19, 0.97), (126, 0.96), (1200, 0.955)])
def test_poisson_interval_covers_by_summation(mean, most):
    """Coverage without chance: the sum over all counts whose interval holds the mean."""
    counts = np.arange(4 * mean + 40)
    ends = np.array([poisson_interval(count, 1.0, 0.95) for count in counts.tolist()])
    holds = (ends[:, 0] <= mean) & (mean <= ends[:, 1])
    assert 0.95 <= scipy.stats.poisson.pmf(counts, mean)[holds].sum() <= most


def test_poisson_interval_is_garwoods():
    """His interval by the chi-squared distribution."""
    low, high = poisson_interval(12, 3.0, 0.9)
    quantile = scipy.stats.chi2.ppf
    assert low == pytest.approx(quantile(0.05, 24) / 2 / 3)
    assert high == pytest.approx(quantile(0.95, 26) / 2 / 3)


def test_where_nothing_was_seen_the_bound_is_one_sided():
    found = return_times(np.zeros((4, 2)), [10.0, 20.0, 30.0, 40.0], [1.0, 2.0])
    assert found.return_time.tolist() == found.high.tolist() == [np.inf, np.inf]
    # a process with this rate has no event in all the time with probability 0.05
    assert np.exp(-100.0 / found.low) == pytest.approx([0.05, 0.05])
    assert np.isnan(found.dispersion).all()
    assert not found.clustered.any()
    assert rate_bound(100.0, 0.95) == pytest.approx(3.0 / 100, rel=2e-3)


def test_dispersion_of_blocks_is_pearsons_statistic():
    counts, times = np.array([3, 0, 9, 4]), np.array([1.0, 2.0, 3.0, 2.0])
    found = return_times(counts, times)
    statistic = scipy.stats.chisquare(counts, 16 * times / 8).statistic
    assert found.dispersion == pytest.approx([statistic / 3])
    assert (found.time, found.blocks) == (8.0, 4)
    # blocks without time of observation are none
    padded = return_times([*counts, 0], [*times, 0.0])
    assert padded.dispersion == pytest.approx(found.dispersion)
    assert padded.blocks == 4


def test_clustered_events_are_worth_fewer():
    """Each independent event is counted five times: the interval is that of the few."""
    generator = np.random.default_rng(7)
    independent = generator.poisson(4.0, size=(400, 1))
    one, five = (return_times(times * independent, 10.0) for times in (1, 5))
    assert (one.clustered.tolist(), five.clustered.tolist()) == ([False], [True])
    assert five.return_time == pytest.approx(one.return_time / 5)
    assert five.low == pytest.approx(one.low / 5, rel=0.02)
    assert five.high == pytest.approx(one.high / 5, rel=0.02)


def test_events_in_blocks_are_upward_crossings_of_each_stretch():
    generator = np.random.default_rng(8)
    series, levels = generator.normal(size=(3, 47)), [0.0, 1.0]
    events, time = events_in_blocks(series, levels, 0.5, steps=10)
    row = 0
    for of_series in series:
        for start in range(0, 46, 10):
            steps = range(start + 1, min(start + 10, 46) + 1)
            for number, level in enumerate(levels):
                expected = sum(of_series[step - 1] < level <= of_series[step] for step in steps)
                assert events[row, number] == expected
            assert time[row] == 0.5 * len(steps)
            row += 1
    assert row == len(events) == len(time)
    whole, lengths = events_in_blocks(series, levels, 0.5)
    assert whole.sum(axis=0).tolist() == events.sum(axis=0).tolist()
    assert lengths.tolist() == [23.0] * 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([1.5], 1.0), "whole numbers"),
        (([[1, 2]], 1.0, [0.1]), "1 levels, but events of 2"),
        (([1], 1.0, [0.1], 1.0), "confidence must lie in"),
        (([-1], 1.0), "must not be negative"),
        (([1], 0.0), "must not be negative"),
        (([0], 0.0), "some time of observation"),
    ],
)
def test_counts_that_mean_nothing_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        return_times(*arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((np.zeros(1), [1], 1.0), "two samples"), ((np.zeros(9), [1], 1.0, 0), "a step at least")],
)
def test_series_without_blocks_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        events_in_blocks(*arguments)

"""Records with gaps and cycles, over several files: against brute force, and every message."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import curve_fit

from burstcast.data.cycles import Cycle, with_waves, without_cycle
from burstcast.data.measured_data import Blocks, Run
from burstcast.data.records import (
    Record,
    Timing,
    Treatment,
    long_runs,
    runs_without_gaps,
    training_rows,
)

NAN = float("nan")
BY_T = Timing(5.0, "t", "minute")


def record(time, **columns):
    columns = {name: np.array(values, dtype=float) for name, values in columns.items()}
    return Record([Run("a.csv", {"t": np.array(time, dtype=float), **columns})])


def listed(runs, name="u"):
    return [run.columns[name].tolist() for run in runs]


def test_a_regular_record_stays_as_it_is():
    values = np.random.default_rng(1).normal(size=50)
    time = 1000.3 + 5 * np.arange(50)
    (run,) = runs_without_gaps(record(time, u=values), BY_T)
    assert np.array_equal(run.columns["u"], values)
    np.testing.assert_allclose(run.columns["t"], time, rtol=1e-15)
    assert run.name == "a.csv, rows 1 to 50"


def test_missing_rows_and_empty_cells_cut():
    found = runs_without_gaps(
        record([0, 5, 10, 20, 25, 30, 35], u=[1, 2, 3, 4, 5, NAN, 7], v=[1] * 7), BY_T
    )
    assert listed(found) == [[1, 2, 3], [4, 5], [7]]
    assert [run.name for run in found] == [
        "a.csv, rows 1 to 3",
        "a.csv, rows 4 to 5",
        "a.csv, rows 7 to 7",
    ]
    # the same of a column without times, where no row is missing
    values = np.array([1, 2, NAN, 4])
    found = runs_without_gaps(Record([Run("a.csv", {"u": values})]), Timing(5.0))
    assert listed(found) == [[1, 2], [4]]


def test_gaps_that_are_interpolated():
    gaps = record([0, 5, 15, 20, 25, 45], u=[0, 1, 3, NAN, 5, 9], v=[0, 1, 3, 40, 5, 9])
    found = runs_without_gaps(gaps, BY_T, longest=10)
    assert listed(found) == [[0, 1, 2, 3, 4, 5], [9]]
    assert listed(found, "v")[0] == [0, 1, 2, 3, 40, 5]  # numbers of incomplete rows are kept
    assert listed(found, "t")[0] == [0, 5, 10, 15, 20, 25]
    assert listed(runs_without_gaps(gaps, BY_T, longest=20)) == [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]]
    assert listed(runs_without_gaps(gaps, BY_T, longest=9.9)) == [[0, 1], [3], [5], [9]]


def test_two_rows_at_one_place_do_not_shift_others():
    # the second of them is incomplete
    twice = record([0, 5, 5.2, 15], u=[0, 1, 1, 3], v=[0, 1, NAN, 3])
    (run,) = runs_without_gaps(twice, BY_T, longest=10)
    assert run.columns["u"].tolist() == [0, 1, 2, 3]


def test_times_off_the_grid_begin_another_run():
    # a sensor that was started again two minutes later, and a clock that drifts
    assert listed(runs_without_gaps(record([0, 5, 12, 17], u=[1, 2, 3, 4]), BY_T)) == [
        [1, 2],
        [3, 4],
    ]
    jitter = record([0, 5.4, 9.6, 15.3], u=[1, 2, 3, 4])
    assert listed(runs_without_gaps(jitter, BY_T)) == [[1, 2, 3, 4]]
    drift = np.cumsum(np.full(7, 5.2))
    assert listed(runs_without_gaps(record(drift, u=range(7)), BY_T)) == [
        [0, 1, 2],
        [3, 4, 5],
        [6],
    ]


@given(
    steps=st.lists(st.integers(1, 5), min_size=1, max_size=40),
    holes=st.sets(st.integers(0, 40)),
    longest=st.integers(1, 5),
)
def test_against_brute_force(steps, holes, longest):
    place = np.cumsum([0, *steps])
    values = np.where([row in holes for row in range(len(place))], NAN, 2.0 * place)
    found = runs_without_gaps(record(5.0 * place, u=values), BY_T, 5.0 * longest)
    # on the whole grid: holes no longer than so many steps are filled
    known = {int(one) for one, value in zip(place, values, strict=True) if value == value}
    runs: list[list[float]] = []
    last = None
    for one in sorted(known):
        if last is None or one - last > max(1, longest):
            runs.append([])
        else:
            runs[-1] += [2.0 * between for between in range(last + 1, one)]
        runs[-1].append(2.0 * one)
        last = one
    assert len(found) == len(runs)
    for run, expected in zip(found, runs, strict=True):
        np.testing.assert_allclose(run.columns["u"], expected, atol=1e-9)
        np.testing.assert_allclose(run.columns["t"], np.array(expected) * 2.5, atol=1e-9)


@pytest.mark.parametrize(
    ("time", "values", "message"),
    [
        ([0, 5, 5], [1, 2, 3], r"a.csv, row 3: column 't' stays at the time of a.csv, row 2"),
        ([0, 60, 5], [1, 2, 3], r"row 3: column 't' goes back by 55 minutes from .* row 2; times"),
        ([0, NAN, 5], [1, 2, 3], r"a.csv, row 2: column 't' has no time"),
        ([0, 5, 10], [1, np.inf, 3], r"a.csv, row 2: column 'u' is infinite; write nan for gaps"),
    ],
)
def test_clocks_that_jump_are_refused(time, values, message):
    with pytest.raises(ValueError, match=message):
        runs_without_gaps(record(time, u=values), BY_T)


def needed(known):
    return known


def treat(runs, blocks=None, training=1, **options):
    return Treatment(BY_T, **options)(runs, needed, blocks, training)


def run(name, time, values):
    time, values = np.array(time, dtype=float), np.array(values, dtype=float)
    return Run(name, {"t": time, "u": values})


def test_files_that_are_parts_of_one_record():
    parts = [run("a.csv", [0, 5], [1, 2]), run("b.csv", [10, 15], [3, 4])]
    found, left_out = treat(parts, joined=True)
    assert listed(found) == [[1, 2, 3, 4]]
    assert found[0].name == "a.csv, row 1 to b.csv, row 2"
    assert left_out == ""
    assert listed(treat(parts, has_dates=True)[0]) == [[1, 2], [3, 4]]
    message = r"a.csv, row 1: column 't' goes back by 15 minutes from the time of b.csv, row 2"
    with pytest.raises(ValueError, match=message):
        treat(parts[::-1], joined=True)
    late = [parts[0], run("b.csv", [20, 25], [3, 4])]
    with pytest.raises(ValueError, match=r"b.csv, row 1: .* 15 minutes after a.csv, row 2, not a"):
        treat(late, joined=True)
    assert listed(treat(late, Blocks(2, 1), joined=True, cut=True)[0]) == [[1, 2], [3, 4]]


def test_short_parts_are_left_out_and_told():
    one = run("a.csv", [0, 5, 10, 20, 25], [1, 2, 3, 4, 5])
    found, left_out = treat([one], Blocks(3, 1), cut=True)
    assert listed(found) == [[1, 2, 3]]
    assert re.fullmatch(
        r"gaps leave 2 parts of the record; 1 of them, with 2 of 5 rows, are shorter than a block "
        r"of 3 and left out; the first is a.csv, rows 4 to 5",
        left_out,
    )
    with pytest.raises(ValueError, match=r"as a block .* takes, 4: the longest of 2 has 3"):
        treat([one], Blocks(4, 1), cut=True)
    with pytest.raises(ValueError, match="there are none"):
        long_runs([], 2)


def test_waves_and_their_fit():
    cycle = Cycle(24.0, 2)
    assert cycle.names == ("cycle_cos", "cycle_sin", "cycle_cos_2", "cycle_sin_2")
    time = np.arange(0.0, 120, 0.7)

    def curve(t, mean, a, b, c, d):
        angle = 2 * np.pi * t / 24
        waves = a * np.cos(angle) + b * np.sin(angle)
        return mean + waves + c * np.cos(2 * angle) + d * np.sin(2 * angle)

    values = curve(time, 3, 1, -2, 0.5, 4) + np.random.default_rng(1).normal(size=len(time))
    fitted = cycle.fit(time, values[:, np.newaxis])
    expected, _ = curve_fit(curve, time, values)  # of other software
    np.testing.assert_allclose(fitted[:, 0], expected, rtol=1e-6)
    np.testing.assert_allclose(cycle.values(time, fitted)[:, 0], curve(time, *expected), rtol=1e-6)
    # of a period from any epoch
    np.testing.assert_allclose(cycle.waves(time + 24e6), cycle.waves(time), atol=1e-6)


def test_a_cycle_is_fitted_to_training_samples_alone():
    time = np.arange(0.0, 480, 5)
    values = 10 + 3 * np.sin(2 * np.pi * time / 60)
    changed = np.where(time < 240, values, 1e6)  # whatever follows the training
    found, _ = treat(
        [run("a.csv", time, changed)],
        Blocks(12, 1),
        training=4,
        cycle=Cycle(60, 1),
        removed_from=("u",),
    )
    np.testing.assert_allclose(found[0].columns["u"][: 12 * 4], 0, atol=1e-9)
    assert np.all(found[0].columns["u"][48:] > 1e5)
    waves = np.cos(2 * np.pi * time / 60)
    np.testing.assert_allclose(found[0].columns["cycle_cos"], waves, atol=1e-12)
    with pytest.raises(ValueError, match=r"samples in 2 of 4 equal parts of the period, 60"):
        treat([run("a.csv", time, values)], Blocks(6, 1), cycle=Cycle(60, 1), removed_from=("u",))
    gap = np.where(time == 5, NAN, values)
    with pytest.raises(ValueError, match=r"a.csv: column 'u' has no number in row 2 of 96"):
        treat([run("a.csv", time, gap)], None, cycle=Cycle(60, 1), removed_from=("u",))
    with pytest.raises(ValueError, match=r"a.csv has a column 'cycle_cos', as a wave of"):
        with_waves([Run("a.csv", {"t": time, "cycle_cos": values})], Cycle(60, 1), "t")


def test_training_rows_over_several_runs():
    # runs of 10, 5 and 10 samples make 3, 1 and 3 blocks of 3
    assert training_rows([10, 5, 10], Blocks(3, 1), 2) == [slice(0, 6)]
    assert training_rows([10, 5, 10], Blocks(3, 1), 5) == [slice(0, 9), slice(0, 3), slice(0, 3)]
    assert training_rows([10, 10], None, 1) == [slice(0, 10)]
    one = run("a.csv", np.arange(0.0, 50, 5), np.arange(10.0))
    runs = [one, run("b.csv", np.arange(0.0, 50, 5), np.arange(10.0) + 100)]
    (first, second) = without_cycle(runs, Cycle(20, 1), "t", ["u"], [slice(0, 4)])
    # four samples of a period: their mean and wave alone
    np.testing.assert_allclose(second.columns["u"] - first.columns["u"], 100, atol=1e-9)

"""From columns to series: what is taken, how it is cut, and every message about what is wrong."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.measured_data import (
    Blocks,
    Quantity,
    Run,
    check_varying,
    code_of_gaps,
    kept_series,
    series_of_runs,
)
from burstcast.systems.measured import MeasuredSeries

GENERATOR = np.random.default_rng(1)


def run(name="run_1.csv", length=20, **columns):
    found = {key: GENERATOR.normal(size=length) for key in ("u", "v", "flow rate [l/s]")}
    return Run(name, {**found, **columns})


def series(runs, components, observable, blocks=None):
    quantities = [Quantity(text) for text in components]
    space = MeasuredSeries([one.name for one in quantities], observable)
    return series_of_runs(runs, space, quantities, blocks)


def test_columns_expressions_and_names() -> None:
    runs = [run("a"), run("b")]
    found = series(runs, ["v", "u2 = u**2", "q = flow rate [l/s]", "u - v"], "v")
    for states, one in zip(found, runs, strict=True):
        u, v, q = one.columns.values()
        np.testing.assert_array_equal(states, np.stack([v, u * u, q, u - v], axis=1))


def test_an_observable_that_is_none_of_the_components_comes_last() -> None:
    one = run()
    found = series([one], ["u"], "u * v")
    np.testing.assert_array_equal(found[0, :, 1], one.columns["u"] * one.columns["v"])
    # an expression of components is none of its own
    assert series([one], ["u", "v"], "u * v").shape == (1, 20, 2)


@given(length=st.integers(5, 200), samples=st.integers(2, 60), gap=st.integers(1, 30))
def test_blocks_lie_end_to_end_with_gaps(length: int, samples: int, gap: int) -> None:
    one = Run("a", {"u": np.arange(length) + 1.0})
    if length < samples:
        with pytest.raises(ValueError, match=f"a has {length} rows, but a block .* {samples}"):
            series([one], ["u"], "u", Blocks(samples, gap))
        return
    found = series([one], ["u"], "u", Blocks(samples, gap))[:, :, 0]
    # brute force: row by row
    rows, expected = list(range(1, length + 1)), []
    while len(rows) >= samples:
        expected.append(rows[:samples])
        rows = rows[samples - 1 + gap :]
    assert found.tolist() == expected
    assert len(set(found.flat)) == found.size  # no sample twice


def test_runs_of_unequal_length_are_cut() -> None:
    runs = [run("a", 11), run("b", 30)]
    assert series(runs, ["u"], "u", Blocks(5, 2)).shape == (2 + 5, 5, 1)
    with pytest.raises(ValueError, match=r"a has 11 rows, b 30; .*data\.blocks"):
        series(runs, ["u"], "u")


def test_blocks_in_time_units() -> None:
    assert Blocks.of(10.0, 2.0, 0.5) == Blocks(21, 4)
    assert Blocks.of(0.3, 0.0, 0.1) == Blocks(4, 1)
    assert Blocks.of(1.0, 0.25, 0.1) == Blocks(11, 3)  # at least the gap


@pytest.mark.parametrize(
    ("columns", "components", "observable", "message"),
    [
        ({}, ["w"], "u", "run_1.csv: there is no column 'w'.*the columns are u, v, flow rate"),
        ({}, ["u", "vv"], "u", "no column 'vv' .did you mean 'v'"),
        ({}, ["u"], "u + w", "run_1.csv: there is no column 'w'"),
        ({}, ["u", "w = a b"], "u", "no column 'a b', and 'a b' is no arithmetic expression"),
        (
            {"u": np.array([0.0, 1, np.nan, 2, np.nan])},
            ["u"],
            "u",
            r"run_1.csv: column 'u' has no number in row 3 of 5 \(2 such rows in all\)",
        ),
        ({"u": np.array([0.0, 1, -np.inf])}, ["u"], "u", "'u' is infinite in row 3 of 3"),
        (
            {"u": np.array([1.0, -1, 2])},
            ["r = sqrt(u)"],
            "r",
            "run_1.csv: the component 'r' has no number in row 2 of 3",
        ),
    ],
)
def test_mistakes(columns, components, observable, message) -> None:
    length = len(next(iter(columns.values()), np.empty(20)))
    with pytest.raises(ValueError, match=message):
        series([run(length=length, **columns)], components, observable)


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        (np.ma.masked_greater(np.arange(20.0), 17), ValueError, r"\[18\] is \(2 in all\)"),
        (np.full(20, 9.969209968386869e36), ValueError, "has no number in row 1 of 20"),
        (np.arange(20) * 1j, TypeError, "real numbers, not of complex128"),
        (np.arange(20).astype(str), TypeError, "real numbers, not of <U2"),
    ],
)
def test_columns_without_real_numbers(values, error, message) -> None:
    with pytest.raises(error, match=rf"run_1\.csv: column 'u' .*{message}"):
        series([run(u=values)], ["u"], "u")


def test_micro_signs() -> None:
    """Python takes the sign and the Greek letter for one name; files do not."""
    micro, greek = "\N{MICRO SIGN}", "\N{GREEK SMALL LETTER MU}"
    both = run(**{greek: np.arange(20.0)}, **{micro: np.arange(1.0, 21)})
    assert np.array_equal(series([both], [f"2 * {micro}"], micro)[0, :, 0], np.arange(2.0, 42, 2))
    assert MeasuredSeries([micro], f"2 * {micro}").dimension == 1
    alike = r"run_1\.csv: there is no column .* is written with other characters: copy it"
    for text in (greek, f"2 * {greek}"):
        with pytest.raises(ValueError, match=alike):
            series([run(**{micro: np.arange(20.0)})], [text], text)


def test_constant_components() -> None:
    series = np.stack([np.zeros((5, 2)), np.ones((5, 2))])
    check_varying(series, ["u", "v"], "the series")  # constant in each of them, not in all
    series[..., 1] = 3.5
    with pytest.raises(ValueError, match=r"component 'v' is 3\.5 in all of the training series"):
        check_varying(series, ["u", "v"], "the training series")


@pytest.mark.parametrize(
    ("code", "times", "found"),
    [
        (99.0, 20, True),
        (-999.99, 2, True),
        (9999, 3, True),
        (99.0, 1, False),  # it does not repeat
        (98.0, 20, False),  # it is not written as codes are
        (9.0, 20, False),  # nor far away
        (0.0, 200, False),  # a rain gauge
    ],
)
def test_codes_for_missing_numbers(code, times, found) -> None:
    values = np.append(1.5 + 0.8 * np.sin(np.arange(500) / 40), np.full(times, code))
    assert code_of_gaps(values) == (code if found else None)


def test_no_codes_among_few_values() -> None:
    assert code_of_gaps(np.array([0.0, 99, 0, 99])) is None  # two states of a switch
    assert code_of_gaps(np.full(3, np.nan)) is None


def test_gaps_in_columns_that_nobody_asks_for() -> None:
    assert series([run(v=np.full(20, np.nan))], ["u"], "u").shape == (1, 20, 1)


def test_series_beyond_the_laminarisation_threshold() -> None:
    observable = np.array([[-3.0, -2, -3], [-3, -3, -3], [0, -3, 0]])
    index, lifetimes = kept_series(observable, -2.5)
    assert index.tolist() == [1]
    assert lifetimes.tolist() == [1, 2, 0]
    index, lifetimes = kept_series(observable, None)
    assert (index.tolist(), lifetimes.tolist()) == ([0, 1, 2], [2, 2, 2])
    with pytest.raises(ValueError, match="all 3 series exceed laminarisation_threshold, -4"):
        kept_series(observable, -4)

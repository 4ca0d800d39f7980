"""Tables for papers: cells, wide tables, and that they are no wider than a page."""

import math
import re

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.tables.typesetting import (
    COLUMN_GAP,
    PAGE_WIDTH,
    number_writer,
    panels,
    text_width,
    to_latex,
    wide_table,
    with_interval,
)

# Widths of cmr8 in points: a digit is 4.25 wide, and so on.
CMR8 = {
    **dict.fromkeys("0123456789", 4.25),
    **{".": 2.36, "(": 3.31, ")": 3.31, " ": 2.83, ",": 2.36, "-": 2.83},
    **{"a": 4.25, "b": 4.72, "c": 3.78, "d": 4.72, "e": 3.78, "f": 2.6, "g": 4.25, "h": 4.72},
    **{"i": 2.36, "j": 2.6, "k": 4.49, "l": 2.36, "m": 7.08, "n": 4.72, "o": 4.25, "p": 4.72},
    **{"q": 4.49, "r": 3.33, "s": 3.35, "t": 3.31, "u": 4.72, "v": 4.49, "w": 6.14, "x": 4.49},
    **{"y": 4.49, "z": 3.78, "R": 6.26, "V": 6.38, "S": 4.72, "N": 6.38, "A": 6.38, "E": 5.79},
}


@given(st.text(alphabet=list(CMR8), min_size=1, max_size=60))
def test_widths_are_not_below_those_of_the_typeface(text):
    assert text_width(text) >= 0.98 * sum(CMR8[letter] for letter in text)


def test_what_only_looks_different_has_no_width():
    assert text_width(r"$\mathrm{in}$") == text_width("in")
    assert text_width(r"a\_b") == text_width("a_b")
    assert text_width(r"$\rho$") > 0


def test_a_cell_is_a_value_with_its_interval():
    write = number_writer(".3f")
    assert with_interval(0.8184, 0.815, 0.8241, write) == "$0.818$ ($0.815$ to $0.824$)"
    assert with_interval(1.0, 1.0, 1.0, write) == "$1.000$"
    assert with_interval(0.5, math.nan, math.nan, write) == "$0.500$"
    assert with_interval(math.nan, math.nan, math.nan, write) == "--"
    assert number_writer(None)(1e-9) == "$10^{-9}$"


def long_form():
    rows = [
        ("a", 1.0, "f_score", 0.5, 0.25, 0.75),
        ("a", 2.0, "f_score", 0.25, math.nan, math.nan),
        ("b", 1.0, "f_score", math.nan, math.nan, math.nan),
    ]
    return pd.DataFrame(rows, columns=["who", "time", "metric", "value", "low", "high"])


def test_rows_and_columns_are_in_the_order_of_the_table():
    cells = wide_table(long_form(), ["who"], "time", specs={"f_score": ".2f"})
    assert cells.columns.tolist() == ["who", 1.0, 2.0]
    assert cells.to_numpy().tolist() == [
        ["a", "$0.50$ ($0.25$ to $0.75$)", "$0.25$"],
        ["b", "--", "--"],
    ]


def test_two_values_for_one_cell_are_an_error():
    twice = pd.concat([long_form(), long_form()])
    with pytest.raises(ValueError, match="two rows have the same who, time"):
        wide_table(twice, ["who"], "time")


@given(st.integers(1, 2), st.lists(st.integers(1, 30), min_size=1, max_size=12))
def test_parts_have_all_columns_once_and_fit_the_page(keys, lengths):
    names = [f"k{number}" for number in range(keys)] + [f"c{n}" for n in range(len(lengths))]
    row = ["x"] * keys + ["8" * length for length in lengths]
    parts = panels(pd.DataFrame([row], columns=names), {}, keys)
    assert [name for part in parts for name in part[keys:]] == names[keys:]
    cells = dict(zip(names, row, strict=True))
    for part in parts:
        assert part[:keys] == names[:keys]
        widths = [max(text_width(cells[name]), text_width(name)) for name in part]
        assert sum(widths) + COLUMN_GAP * (len(part) - 1) <= PAGE_WIDTH


def test_a_table_is_a_table_environment_with_booktabs_rules():
    cells = pd.DataFrame({"case_name": ["Re400"], "p50": ["$0.512$"]})
    text = to_latex(cells, "Scores.", "tab:scores", heads={"p50": r"$p_{50}$"})
    assert text.splitlines() == [
        r"\begin{table}",
        r"  \centering",
        r"  \caption{Scores.}",
        r"  \label{tab:scores}",
        r"  \footnotesize",
        r"  \setlength{\tabcolsep}{4pt}",
        r"  \begin{tabular}{@{}lr@{}}",
        r"    \toprule",
        r"    case\_name & $p_{50}$ \\",
        r"    \midrule",
        r"    Re400 & $0.512$ \\",
        r"    \bottomrule",
        r"  \end{tabular}",
        r"\end{table}",
    ]
    assert text.endswith("\n")


def test_what_is_too_wide_stands_below():
    cells = pd.DataFrame({"who": ["a"], **{f"c{n}": ["8" * 20] for n in range(9)}})
    text = to_latex(cells, "c", "l")
    assert text.count(r"\begin{tabular}") == text.count(r"\end{tabular}") == 3
    rows = re.findall(r"^    a & .*$", text, re.M)
    assert [row.count("&") for row in rows] == [3, 3, 3]

"""Tables of papers and pages: percentiles, LaTeX, widths, and rows that are shown."""

import math
import re
from itertools import product

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.figures.parts.ranked import shown_once
from burstcast.tables.latex import escape, latex_number, to_latex
from burstcast.tables.parameters import data_parameters, network_parameters, side_by_side
from burstcast.tables.percentiles import percentiles
from burstcast.tables.wide import cell, wide_table

KEYS = ["case", "reynolds", "neurons"]
CASES = [("Re600", 600.0, 500), ("Re400", 400.0, 500), ("lorenz", math.nan, 500)]
VALUES = st.one_of(st.floats(-1e3, 1e3), st.just(math.nan))


def networks(entries):
    """Rows of networks from their cases, scores and recalls."""
    rows = [(*CASES[case], *metrics) for case, *metrics in entries]
    return pd.DataFrame(rows, columns=[*KEYS, "score", "recall"])


def quantile_by_hand(values, fraction):
    """Linear interpolation between order statistics, written out; of defined values alone."""
    ordered = sorted(value for value in values if not math.isnan(value))
    if not ordered:
        return math.nan
    position = fraction * (len(ordered) - 1)
    below = math.floor(position)
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + (position - below) * (ordered[above] - ordered[below])


@given(st.lists(st.tuples(st.integers(0, 2), VALUES, VALUES), max_size=12))
def test_percentiles_interpolate_between_order_statistics_of_each_group(entries):
    """Groups in the order of their appearance, also without a Reynolds number."""
    table = percentiles(networks(entries), KEYS, ["score", "recall"])
    assert list(table.columns) == [*KEYS, "metric", "p25", "p50", "p75", "networks"]
    groups = product(dict.fromkeys(case for case, *_ in entries), enumerate(["score", "recall"], 1))
    rows = table.to_dict("records")
    for row, (case, (place, metric)) in zip(rows, groups, strict=True):
        values = [entry[place] for entry in entries if entry[0] == case]
        keys = dict(zip(KEYS, CASES[case], strict=True))
        quantiles = {f"p{100 * f:g}": quantile_by_hand(values, f) for f in (0.25, 0.5, 0.75)}
        expected = keys | quantiles | {"networks": sum(not math.isnan(value) for value in values)}
        assert row.pop("metric") == metric
        assert row.pop("case") == expected.pop("case")
        assert row == pytest.approx(expected, abs=1e-9, nan_ok=True)


def test_infinite_values_and_missing_columns_are_refused():
    with pytest.raises(ValueError, match="infinite values in column score"):
        percentiles(networks([(0, 1.0, 1.0), (0, math.inf, 1.0)]), KEYS, ["score"])
    with pytest.raises(KeyError, match="the table has no column precision"):
        percentiles(networks([(0, 1.0, 1.0)]), KEYS, ["precision"])


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (400, "$400$"),
        (4 * math.pi, r"$4\pi$"),
        (math.pi, r"$\pi$"),
        (3.14, "$3.14$"),
        (0.25, "$0.25$"),
        (1e-12, "$10^{-12}$"),
        (1.6e-7, r"$1.6\times10^{-7}$"),
        (-0.5, "$-0.5$"),
        (0.0, "$0$"),
    ],
)
def test_latex_number(value, expected):
    assert latex_number(value) == expected


def test_escape_makes_every_special_character_literal():
    assert escape("a_b & 5% {x} #1 $y") == r"a\_b \& 5\% \{x\} \#1 \$y"
    assert escape("~^\\") == r"\textasciitilde{}\textasciicircum{}\textbackslash{}"
    with pytest.raises(ValueError, match="nan"):
        latex_number(math.nan)


DATA = {
    **{"time_step": 0.25, "event_threshold": 0.1, "series_kept": 1436},
    **{"series_duration": 4000.0, "training_series": 10},
}


def test_the_papers_parameter_tables():
    flow = [("L_x", "Length of the domain in the $x$-direction", 4 * math.pi)]
    flow += [(r"\mathrm{Re}", "Reynolds number", 400.0)]
    data = data_parameters(system=flow, **DATA, laminarisation_threshold=0.48)
    values = ["4\\pi", "400", "0.25", "0.48", "0.1", "1436", "4000", "10"]
    assert list(data["Value"]) == [f"${value}$" for value in values]
    assert data.loc[3, "Parameter"] == "$k_l$"
    bounds = {"spectral_radius": (0.1, 1.0), "input_scaling": (0.1, 10.0)}
    others = {"connectivity": 20, "input_bias": 0.1, "noise": 0.01}
    network = network_parameters(**bounds, tikhonov=[1e-6, 1e-9, 1e-12], **others)
    values = ["[0.1, 1]", "[0.1, 10]", "[10^{-6}, 10^{-9}, 10^{-12}]", "20", "0.1"]
    assert list(network["Value"]) == [f"${number}$" for number in [*values, r"0.01\,\sigma_u"]]
    data = data_parameters(system=[], **DATA, laminarisation_threshold=None, symbol="z")
    assert not data["Explanation"].str.contains("Laminarisation").any()
    assert "$z_e$" in list(data["Parameter"])


def parameters(**values):
    return pd.DataFrame(
        [(f"${name}$", name, value) for name, value in values.items()],
        columns=["Parameter", "Explanation", "Value"],
    )


def test_parameter_tables_side_by_side_keep_the_order_and_show_what_is_missing():
    joined = side_by_side(
        {"first": parameters(a="$1$", b="$2$"), "second": parameters(a="$3$", c="$4$")}
    )
    assert list(joined.columns) == ["Parameter", "Explanation", "first", "second"]
    assert joined["Explanation"].tolist() == ["a", "b", "c"]
    assert joined["first"].tolist()[:2] == ["$1$", "$2$"]
    assert joined["second"].tolist()[::2] == ["$3$", "$4$"]
    assert joined["first"].isna().tolist() == [False, False, True]
    assert joined["second"].isna().tolist() == [False, True, False]
    table = parameters(a="$1$")
    assert side_by_side({"Re400": table}) is table


# -- LaTeX -----------------------------------------------------------------------------------------


def test_a_cell_is_a_value_with_its_interval():
    assert cell(0.8184, 0.815, 0.8241, ".3f") == "$0.818$ ($0.815$ to $0.824$)"
    assert cell(1.0, 1.0, 1.0, ".3f") == "$1.000$"
    assert cell(0.5, math.nan, 1.0, ".3f") == "$0.500$"
    assert cell(math.nan, math.nan, math.nan, ".3f") == "--"
    assert cell(1e-9, math.nan, math.nan, None) == "$10^{-9}$"


def long_form():
    rows = [
        ("a", 1.0, "f_score", 0.5, 0.25, 0.75),
        ("a", 2.0, "f_score", 0.25, math.nan, math.nan),
        ("b", 1.0, "f_score", math.nan, math.nan, math.nan),
    ]
    return pd.DataFrame(rows, columns=["who", "time", "metric", "value", "low", "high"])


def test_rows_and_columns_are_in_the_order_of_the_table_one_value_for_a_cell():
    cells = wide_table(long_form(), ["who"], "time", specs={"f_score": ".2f"})
    assert cells.columns.tolist() == ["who", 1.0, 2.0]
    assert cells.to_numpy().tolist() == [
        ["a", "$0.50$ ($0.25$ to $0.75$)", "$0.25$"],
        ["b", "--", "--"],
    ]
    twice = pd.concat([long_form(), long_form()])
    with pytest.raises(ValueError, match="two rows have the same who, time"):
        wide_table(twice, ["who"], "time", specs={})


LATEX = r"""\begin{table}
  \centering
  \caption{Scores.}
  \label{tab:scores}
  \footnotesize
  \resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{\begin{tabular}{@{}lr@{}}
    \toprule
    case\_name & $p_{50}$ \\
    \midrule
    Re400 & $0.512$ \\
    \bottomrule
  \end{tabular}}
\end{table}
"""


def test_a_table_is_a_table_environment_with_booktabs_rules_of_four_columns_side_by_side():
    cells = pd.DataFrame({"case_name": ["Re400"], "p50": ["$0.512$"]})
    assert to_latex(cells, "Scores.", "tab:scores", heads={"p50": r"$p_{50}$"}) == LATEX
    cells = pd.DataFrame({"who": ["a"], **{f"c{n}": [f"v{n}"] for n in range(9)}})
    rows = re.findall(r"^    a & (.*) ..$", to_latex(cells, "c", "l"), re.M)
    assert rows == ["v0 & v1 & v2 & v3", "v4 & v5 & v6 & v7", "v8"]


# -- rows of the ranking ---------------------------------------------------------------------------


def test_committees_stand_for_their_members_and_common_alarms_are_shown_once():
    flow = ["equations", "observable_now", "published_precursor"]
    kept = ["analogues", "climatology", "esn-N50-RV-committee"]
    kept += ["esn-N90-RV-seed0", "esn-N50-SSV-seed0"]
    members = ["esn-N50-RV-seed0", "esn-N50-RV-seed1", "analogues-committee"]
    alarms = {"flow": flow, "modes": [*members[:2], *kept, members[2], "observable_now"]}
    pairs = [(case, alarm) for case, names in alarms.items() for alarm in names]
    times = pd.DataFrame({"prediction_time_lt": [0.5, 1.0]})
    rows = pd.DataFrame(pairs, columns=["case", "alarm"]).merge(times, "cross")
    for _, part in shown_once(rows).groupby("prediction_time_lt"):
        expected = [("flow", alarm) for alarm in flow] + [("modes", alarm) for alarm in kept]
        assert list(zip(part["case"], part["alarm"], strict=True)) == expected

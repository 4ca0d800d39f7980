import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.statistics.percentiles import percentiles
from burstcast.tables.latex import (
    data_parameters,
    escape,
    latex_number,
    network_parameters,
    side_by_side,
)

KEYS = ["case", "reynolds", "neurons"]


def networks(values: list[float], **keys: object) -> pd.DataFrame:
    defaults: dict[str, object] = {"case": "Re400", "reynolds": 400.0, "neurons": 500}
    return pd.DataFrame(
        [{**defaults, **keys, "seed": seed, "score": v} for seed, v in enumerate(values)]
    )


def quantile_by_hand(values: list[float], fraction: float) -> float:
    """Linear interpolation between order statistics, written out."""
    ordered = sorted(values)
    position = fraction * (len(ordered) - 1)
    below = math.floor(position)
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + (position - below) * (ordered[above] - ordered[below])


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=12))
def test_percentiles_interpolate_between_order_statistics(values: list[float]) -> None:
    row = percentiles(networks(values), KEYS, ["score"]).iloc[0]
    for name, fraction in (("p25", 0.25), ("p50", 0.5), ("p75", 0.75)):
        assert row[name] == pytest.approx(quantile_by_hand(values, fraction), abs=1e-9)
    assert row["networks"] == len(values)


def test_undefined_values_are_ignored_and_not_counted() -> None:
    row = percentiles(networks([0.1, math.nan, 0.3, math.nan]), KEYS, ["score"]).iloc[0]
    assert row["p50"] == pytest.approx(0.2)
    assert row["networks"] == 2


def test_percentiles_of_nothing_are_empty() -> None:
    row = percentiles(networks([math.nan, math.nan]), KEYS, ["score"]).iloc[0]
    assert np.isnan(row["p25"])
    assert np.isnan(row["p50"])
    assert row["networks"] == 0


def test_groups_stay_apart_also_when_row_labels_repeat() -> None:
    table = pd.concat([networks([1.0, 1.0]), networks([5.0], case="Re600", reynolds=600.0)])
    result = percentiles(table, KEYS, ["score"])
    assert list(result["case"]) == ["Re400", "Re600"]
    assert list(result["p50"]) == [1.0, 5.0]
    assert list(result["networks"]) == [2, 1]


def test_a_case_without_reynolds_number_is_a_group() -> None:
    table = networks([1.0, 3.0], case="lorenz", reynolds=math.nan)
    result = percentiles(table, KEYS, ["score"])
    assert len(result) == 1
    assert result.loc[0, "p50"] == 2.0
    assert np.isnan(result.loc[0, "reynolds"])


def test_columns_are_keys_then_metric_then_percentiles() -> None:
    result = percentiles(networks([1.0]).assign(other=2.0), KEYS, ["score", "other"])
    assert list(result.columns) == [*KEYS, "metric", "p25", "p50", "p75", "networks"]
    assert list(result["metric"]) == ["score", "other"]


def test_percentiles_of_an_empty_table_have_its_columns() -> None:
    result = percentiles(networks([1.0]).iloc[:0], KEYS, ["score"])
    assert result.empty
    assert "p50" in result.columns


def test_infinite_values_and_missing_columns_are_refused() -> None:
    with pytest.raises(ValueError, match="infinite values in column score"):
        percentiles(networks([1.0, math.inf]), KEYS, ["score"])
    with pytest.raises(KeyError, match="the table has no column recall"):
        percentiles(networks([1.0]), KEYS, ["recall"])


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
def test_latex_number(value: float, expected: str) -> None:
    assert latex_number(value) == expected


def test_latex_number_refuses_what_is_no_number() -> None:
    with pytest.raises(ValueError, match="nan"):
        latex_number(math.nan)


def test_escape_makes_every_special_character_literal() -> None:
    assert escape("a_b & 5% {x} #1 $y") == r"a\_b \& 5\% \{x\} \#1 \$y"
    assert escape("~^\\") == r"\textasciitilde{}\textasciicircum{}\textbackslash{}"


def test_the_papers_parameter_tables() -> None:
    data = data_parameters(
        system=[
            ("L_x", "Length of the domain in the $x$-direction", 4 * math.pi),
            (r"\mathrm{Re}", "Reynolds number", 400.0),
        ],
        time_step=0.25,
        laminarisation_threshold=0.48,
        event_threshold=0.1,
        series_kept=1436,
        series_duration=4000.0,
        training_series=10,
    )
    values = ["4\\pi", "400", "0.25", "0.48", "0.1", "1436", "4000", "10"]
    assert list(data["Value"]) == [f"${value}$" for value in values]
    assert data.loc[3, "Parameter"] == "$k_l$"
    network = network_parameters(
        spectral_radius=(0.1, 1.0),
        input_scaling=(0.1, 10.0),
        tikhonov=[1e-6, 1e-9, 1e-12],
        connectivity=20,
        input_bias=0.1,
        noise=0.01,
    )
    assert list(network["Value"]) == [
        "$[0.1, 1]$",
        "$[0.1, 10]$",
        "$[10^{-6}, 10^{-9}, 10^{-12}]$",
        "$20$",
        "$0.1$",
        r"$0.01\,\sigma_u$",
    ]


def test_a_system_that_does_not_laminarise_has_no_such_row() -> None:
    data = data_parameters(
        system=[],
        time_step=0.01,
        laminarisation_threshold=None,
        event_threshold=40.0,
        series_kept=20,
        series_duration=100.0,
        training_series=5,
        symbol="z",
    )
    assert not data["Explanation"].str.contains("Laminarisation").any()
    assert "$z_e$" in list(data["Parameter"])


def parameters(**values):
    return pd.DataFrame(
        [(f"${name}$", name, value) for name, value in values.items()],
        columns=["Parameter", "Explanation", "Value"],
    )


def test_one_parameter_table_stays_as_it_is():
    table = parameters(a="$1$")
    assert side_by_side({"Re400": table}) is table


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

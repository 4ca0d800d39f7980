"""Bars and bands: of one kind in a figure, over what is independent; curves that are cut."""

import numpy as np
import pandas as pd
import pytest

from burstcast.figures.control_tradeoff import control_tradeoff, over_flows
from burstcast.figures.parts.alarm_scores import median_network
from burstcast.figures.parts.percentile_curves import draw_percentiles
from burstcast.figures.parts.style import observable_label, validation_style
from burstcast.figures.reliability import FEW_FORECASTS
from burstcast.figures.reliability import draw as reliability

RANDOM = {"case": "Re400", "forecaster": "random", "neurons": 700.0, "validation": "RV"}
PAPERS = {
    "strategy": "prediction_triggered",
    "starts": "quiet",
    "delay_lt": 0.0,
    "quiet_lt": 0.0,
    "strength": 1.0,
}


def test_bars_of_control_are_intervals_over_flows():
    quartiles = pd.DataFrame(
        [
            {
                **RANDOM,
                "prediction_time_lt": 1.0,
                "metric": metric,
                "p25": p25,
                "p50": p50,
                "p75": p75,
            }
            for metric, p25, p50, p75 in (
                ("reduction", -0.16, -0.1, -0.07),
                ("control_fraction", 0.092, 0.095, 0.096),
            )
        ]
    )
    ends = {
        "relative_exceedance": [(0.86, 1.28), (1.02, 1.5), (0.91, 1.37)],
        "control_fraction": [(0.07, 0.11), (0.08, 0.1), (0.08, 0.12)],
    }
    strategies = pd.DataFrame(
        {**RANDOM, **PAPERS, "prediction_time_lt": 1.0, "seed": seed, "metric": metric}
        | {"low": low, "high": high}
        for metric, pairs in ends.items()
        for seed, (low, high) in enumerate(pairs)
    )
    late = strategies.assign(delay_lt=1.0, low=9.0, high=9.9)  # another strategy than the paper's
    found = over_flows(quartiles, pd.concat([strategies, late])).set_index("metric")
    assert found.loc["reduction", ["p25", "p75"]].tolist() == pytest.approx([1 - 1.37, 1 - 0.91])
    assert found.loc["control_fraction", ["p25", "p75"]].tolist() == [0.08, 0.11]
    assert found["p50"].tolist() == quartiles["p50"].tolist()
    # the bar holds zero, which quartiles of three networks exclude
    figure = control_tradeoff(found.reset_index())
    bars = figure.axes[0].collections[0].get_segments()[0]
    assert bars[0, 1] < 0 < bars[1, 1]


def test_the_band_of_the_median_network_is_of_the_same_kind_as_all_others():
    rows = [("esn", 0.5, 0.3, 0.6), ("esn", 0.6, 0.4, 0.9), ("esn", 0.7, 0.5, 0.8)]
    table = pd.DataFrame(rows, columns=["forecaster", "value", "low", "high"]).assign(time=1.0)
    other = table.iloc[:1].assign(forecaster="equations")
    found = median_network(pd.concat([table, other]), "time").set_index("forecaster")
    assert found.loc["esn", ["value", "low", "high"]].tolist() == [0.6, 0.4, 0.8]
    assert found.loc["equations", ["value", "low", "high"]].tolist() == [0.5, 0.3, 0.6]


def test_bins_of_few_forecasts_are_not_joined():
    counts = [100, FEW_FORECASTS - 1, FEW_FORECASTS, 50]
    bins = pd.DataFrame(
        {
            "case": "Re400",
            "forecaster": "quadratic",
            "neurons": np.nan,
            "validation": None,
            "probability": "calibrated",
            "prediction_time_lt": 2.0,
            "bin": range(4),
            "forecasts": counts,
            "mean_probability": [0.0, 0.3, 0.6, 1.0],
            "observed_frequency": [0.0, 1.0, 0.5, 1.0],
            "consistency_low": 0.0,
            "consistency_high": 1.0,
        }
    )
    figure = reliability(bins, [2.0], 500, "RV")
    lines = {line.get_linestyle(): line for line in figure.axes[0].lines[1:]}
    assert lines["-"].get_xdata().tolist() == [0.0, 0.6, 1.0]
    assert lines["None"].get_xdata().tolist() == [0.3]


def test_two_sizes_are_not_joined_by_a_line():
    from matplotlib.figure import Figure

    rows = pd.DataFrame({"neurons": [300, 700, 900], "p25": 0.1, "p50": 0.2, "p75": 0.3})
    for count, joined in ((2, False), (3, True)):
        axes = Figure().subplots()
        draw_percentiles(axes, rows.iloc[:count], "neurons", validation_style("RV"))
        assert (axes.lines[0].get_linestyle() != "None") is joined


@pytest.mark.parametrize(
    ("symbol", "name", "label"),
    [
        ("lynx", "Lynx", "$lynx$"),
        (r"\mathrm{n1}", "N1", r"$\mathrm{n1}$"),
        (r"\mathrm{a\_b}", "a_b", r"$\mathrm{a\_b}$"),
        ("k", "kinetic energy", "Kinetic energy, $k$"),
    ],
)
def test_an_axis_says_a_name_once(symbol, name, label):
    assert observable_label(symbol, name) == label

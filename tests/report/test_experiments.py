"""Tables of programs in benchmarks/ on pages: means and paired differences over training sets."""

import experiments
import numpy as np
import pytest
from kept_tables import KEPT, Tables
from scipy import stats

from burstcast.figures.parts.style import render
from helpers_library import assert_same_picture

BENCHMARKS = KEPT.parents[1] / "benchmarks"
PLAIN, BOTH = [0.71, 0.74, 0.76], [0.83, 0.87, 0.86]


@pytest.fixture
def tables(tmp_path):
    """Two variants of a network on three training sets, in another order for each."""
    lines = ["kind,neurons,set,variant,f_1,f_2,f_3,f_5,brier_3,forecast_ms,f_3_low,f_3_high"]
    lines += [f"esn,500,{row},plain,1,1,{PLAIN[row]},0,0.5,0.2,0.6,0.7" for row in (2, 0, 1)]
    lines += [f"esn,500,{row},both,1,1,{BOTH[row]},0,0.8,6,0.7,0.9" for row in range(3)]
    (tmp_path / "smoothing.csv").write_text("\n".join(lines) + "\n")
    return Tables(tmp_path)


def test_gains_are_of_pairs_of_training_sets(tables):
    gain = experiments.gain(tables, "f_3", "both", kind="esn")
    expected = stats.ttest_rel(BOTH, PLAIN).confidence_interval(0.95)
    assert (gain.low, gain.high) == pytest.approx((expected.low, expected.high))
    text = experiments.with_range(tables, "smoothing", "f_3", variant="plain")
    assert text == f"{np.mean(PLAIN):.3f} (0.710–0.760)"
    cells = {(row, head): cell for row, head, cell in experiments.smoothing_scores(tables)}
    assert cells["network, 500 neurons: smoothing and filter", "F, 3 LT"] == "0.853 (0.830–0.870)"
    assert cells["network, 500 neurons: as it is", "forecast [ms]"] == "0.2"
    # variance over sets of the mean, and of one over test series; Welch-Satterthwaite
    of_sets, of_test = np.var(BOTH, ddof=1) / 3, (0.2 / 3.92) ** 2
    degrees = (of_sets + of_test) ** 2 / (of_sets**2 / 2)
    half = stats.t.ppf(0.975, degrees) * np.sqrt(of_sets + of_test)
    interval = f"{np.mean(BOTH) - half:.3f}–{np.mean(BOTH) + half:.3f}"
    assert cells["network, 500 neurons: smoothing and filter", "its 95 % interval"] == interval


@pytest.mark.parametrize("name", ["smoothing", "hidden_modes"])
def test_figures_are_those_of_the_tables_of_benchmarks(name):
    figure = getattr(experiments, f"draw_{name}")(Tables(BENCHMARKS))
    assert_same_picture(render(figure, "png"), KEPT.parent / "images" / f"{name}.png")

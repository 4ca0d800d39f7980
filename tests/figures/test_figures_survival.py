"""The figure of survival: what its axes say where hardly anything leaves the chaotic phase."""

import numpy as np
import pandas as pd

from burstcast.figures.survival import draw as survival


def test_ticks_of_a_narrow_range_can_be_told_apart():
    time = np.linspace(0, 4000, 101)
    share = np.exp(-1e-5 * time)
    data = pd.DataFrame({"forecaster": "data", "time": time, "survival": share})
    network = {"case": "Re1000", "forecaster": "esn", "neurons": 2000, "validation": "RV"}
    curves = pd.DataFrame({**network, "metric": "survival", "time": time})
    rates = pd.DataFrame([{**network, "metric": "escape_rate"}])
    rate = {"escape_rate": [1e-5], "escape_rate_low": [0.9e-5], "escape_rate_high": [1.1e-5]}
    figure = survival(
        data.assign(survival_low=share, survival_high=share),
        curves.assign(p25=share, p50=share, p75=share),
        pd.DataFrame({"forecaster": "data", **rate}),
        rates.assign(p25=1e-5, p50=1e-5, p75=1e-5),
        2000,
    )
    figure.canvas.draw()
    axes = figure.axes[0]
    low, high = axes.get_ylim()
    assert low > 0.95
    ticks = (*axes.yaxis.get_major_ticks(), *axes.yaxis.get_minor_ticks())
    shown = [tick.label1.get_text() for tick in ticks if low <= tick.get_loc() <= high]
    assert len(shown) > 2
    assert len(set(shown)) == len(shown)

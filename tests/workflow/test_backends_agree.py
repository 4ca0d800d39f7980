"""Both backends give the same tables, as far as tables are determined by the data.

Over short times the backends agree to rounding, which their own tests show. Over long ones chaos
magnifies rounding: searches may end at neighbouring hyperparameters, and single forecasts come out
otherwise. Scores must then agree within the intervals that resampling the data gives.
"""

import numpy as np
import pandas as pd
import pytest
from helpers_rebuilds import Project

from burstcast.files.netcdf import read_netcdf

pytestmark = pytest.mark.long

QUICK = "workflow/presets/quick.yaml"
FORECASTER = ["neurons", "validation", "seed"]
SMALL = {
    "campaign": [
        {
            "reynolds": [400],
            "forecasters": {"esn": {"neurons": [300], "validation": ["RV", "SSV"], "seeds": 2}},
        }
    ],
    "statistics": {"forecasters": {"esn": None}},
    "control": {"forecasters": {"esn": None, "equations": None}},
    "figures": {"example_forecaster": "esn-N300-RV-seed0", "fixed_neurons": 300},
}


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """Tables of the same campaign with each backend, and the horizons of its networks."""
    project = Project.create(tmp_path_factory.mktemp("backends") / "project", preset=QUICK)
    made = {}
    for backend in ("compiled", "scipy"):
        directory = f"results/{backend}"
        forecasters = {"esn": {"backend": backend}}
        overlay = {**SMALL, "results": directory, "forecasters": forecasters}
        wanted = [
            f"{directory}/tables/{name}.csv" for name in ("classification_intervals", "horizon")
        ]
        outcome = project.snakemake(*wanted, overlay=overlay)
        assert outcome.status == 0, outcome.text[-3000:]
        made[backend] = {
            "scores": pd.read_csv(project.directory / directory / "tables/classification.csv"),
            "intervals": pd.read_csv(project.directory / wanted[0]),
            "horizons": pd.concat(
                pd.DataFrame(read_netcdf(path))
                .rename_axis("event")
                .reset_index()
                .assign(network=path.parent.name)
                for path in sorted((project.directory / directory).glob("Re400/*/horizon.nc"))
            ),
        }
    return made


def test_scores_agree_within_their_intervals(tables):
    keys = [*FORECASTER, "prediction_time_lt"]
    scores = tables["scipy"]["scores"].melt(
        id_vars=keys, value_vars=["precision", "recall", "f_score"], var_name="metric"
    )
    intervals = tables["compiled"]["intervals"].dropna(subset=["low", "high"])
    both = intervals.merge(scores, on=[*keys, "metric"], suffixes=("", "_scipy"))
    assert len(both) == len(intervals) > 0
    inside = both["value"].between(both["low"], both["high"])
    # intervals of 95 %: were the backends independent samples, more than these would lie outside
    assert inside.mean() > 0.95, both[~inside].to_string()


def test_horizons_agree_within_their_intervals(tables):
    compiled, scipy = (tables[backend]["horizons"] for backend in ("compiled", "scipy"))
    both = compiled.merge(scipy, on=["network", "event"], suffixes=("", "_scipy"))
    assert len(both) == len(compiled) > 0
    generator = np.random.default_rng(1)
    for network, events in both.groupby("network"):
        horizons = events["prediction_horizon_lt"].to_numpy()
        drawn = generator.integers(len(horizons), size=(2000, len(horizons)))
        low, high = np.percentile(horizons[drawn].mean(axis=1), [2.5, 97.5])
        assert low <= events["prediction_horizon_lt_scipy"].mean() <= high, network

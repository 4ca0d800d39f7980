"""Rows of the table of warnings: whose they are, and in which order."""

import numpy as np
import pandas as pd

from burstcast.base.files.netcdf import Variable, write_netcdf
from burstcast.tables.makers.warnings_table import ADVICE, OF_NETWORKS, make

NETWORK = {"neurons": 50, "validation": "RV"}
WHO = [
    {"forecaster": "esn", **NETWORK, "seed": 0},
    {"forecaster": "esn", **NETWORK, "seed": 1},
    {"forecaster": "esn", **NETWORK, "neurons": 90, "seed": 0},
    {"forecaster": "equations", "neurons": None, "validation": None, "seed": None},
]
EXPONENT = {"lyapunov_exponent": 0.9, "lyapunov_exponent_by_growth": 0.9}


def rows_of_warnings(tmp_path, **changed):
    """Warnings of a case without a sign, but for what is changed."""
    states = np.random.default_rng(1).normal(size=(3, 400, 3))
    path = tmp_path / "ensemble.nc"
    write_netcdf(path, {"state": Variable(("series", "time", "component"), states, "1", "")}, {})
    bounds = {f"{name}_{end}": value for name, value in EXPONENT.items() for end in ("low", "high")}
    outcome = {"prediction_time_lt": 1.0, "true_positive": 50, "false_negative": 0}
    scores = [{**keys, **outcome, "f_score": 0.9} for keys in WHO]
    alarm = {**WHO[3], "forecaster": "permanent_alarm", **outcome, "f_score": 0.4}
    moments = {"states": 1, "mean": np.zeros(3), "mean_product": np.zeros((3, 3))}
    counts = {"edge": np.arange(3.0), "count": np.array([500, 500]), "below": 0, "above": 0}
    arguments = {
        "data": {**counts, **moments},
        "calibration_set": {"washout_maximum": np.array([0.0])},
        "events_summary": {"usable_events": 100, "largest_observable": 3.0},
        "dataset": pd.DataFrame([{**EXPONENT, **bounds}]),
        "classification": pd.DataFrame([*scores, alarm]),
        **dict.fromkeys(("hyperparameters", "statistics", "control", "lyapunov_spectrum")),
        **{"event_threshold": 2.0, "training_series": 2, "noise": 0.0, "wanted_events": 100},
        **{"system": "lorenz63", "parameters": {}, "spectral_radius": [0.1, 1.0]},
        **{"input_scaling": [0.1, 10.0], "tikhonov": [1e-9, 1e-3]},
    }
    rows = make(ensemble=str(path), **(arguments | changed))["warnings"]
    assert all(row["finding"] and row["advice"] for row in rows)
    return [(row["forecaster"], row["neurons"], row["warning"]) for row in rows], rows


def test_nothing_is_said_of_a_valid_case(tmp_path):
    assert rows_of_warnings(tmp_path) == ([], [])


def test_networks_of_a_size_and_strategy_share_a_row(tmp_path):
    lost = pd.DataFrame(
        [{**keys, "discarded_fraction": 0.9, "diverged_fraction": 0.0} for keys in WHO]
        + [{**WHO[3], "forecaster": "data", "discarded_fraction": np.nan}]
    )
    warned, rows = rows_of_warnings(tmp_path, statistics=lost)
    assert [row[:2] for row in warned[:2]] == [("esn", 50), ("esn", 90)]
    assert warned[2][0] == "equations"
    assert {name for *_, name in warned} == {"lost_long_runs"}
    advice = [OF_NETWORKS["lost_long_runs"] + ADVICE["lost_long_runs"]] * 2
    assert [row["advice"] for row in rows] == [*advice, ADVICE["lost_long_runs"]]
    searched = {"spectral_radius": 1.0, "input_scaling": 1.0, "tikhonov": 1e-6}
    networks = pd.DataFrame([{**keys, **searched, "solver": "cholesky"} for keys in WHO[:3]])
    networks.loc[2, "solver"] = "eigenvalues"
    warned, _ = rows_of_warnings(tmp_path, hyperparameters=networks)
    edge = [("esn", size, "optimum_on_edge") for size in (50, 90)]
    assert warned == [*edge, ("esn", 90, "ill_conditioned_readout")]
    exponents = pd.DataFrame([{**keys, "number": 1, "lyapunov_exponent": 0.9} for keys in WHO])
    exponents = pd.concat([exponents, exponents.assign(number=2, lyapunov_exponent=-9.0)])
    assert rows_of_warnings(tmp_path, lyapunov_spectrum=exponents)[0] == []
    exponents.loc[exponents["neurons"] == 90, "lyapunov_exponent"] = 0.3
    exponents.loc[exponents["forecaster"] == "equations", "lyapunov_exponent"] = -0.1
    warned = [row[::2] for row in rows_of_warnings(tmp_path, lyapunov_spectrum=exponents)[0]]
    assert warned == [("esn", "own_exponents_differ"), ("equations", "no_chaos_learnt")]


def test_scores_are_compared_with_a_permanent_alarm_and_positives_counted_once(tmp_path):
    outcome = {"true_positive": 3, "false_negative": 4}
    scores = pd.DataFrame(
        {**keys, "prediction_time_lt": time, **outcome, "f_score": 0.9 if time < 2 else 0.3}
        for keys in [*WHO, {**WHO[3], "forecaster": "permanent_alarm"}]
        for time in (1.0, 2.0)
    )
    scores.loc[scores["forecaster"] == "permanent_alarm", "f_score"] = 0.4
    warned, rows = rows_of_warnings(tmp_path, classification=scores)
    names = [name for *_, name in warned]
    assert names == ["few_positives", *["no_better_than_permanent_alarm"] * 3]
    assert warned[0][:2] == (None, None)
    assert "7" in rows[0]["finding"]
    assert all("2" in row["finding"] for row in rows[1:])


def test_invalid_forecasts_and_decisions_without_one_are_told_above_a_hundredth(tmp_path):
    outcome = {"true_positive": 50, "false_negative": 0, "f_score": 0.9}
    scores = pd.DataFrame(
        {**keys, "prediction_time_lt": time, **outcome, "invalid_fraction": share}
        for keys, shares in zip(
            WHO, [(0.0, 0.1), (0.01, 0.0), (0.01, 0.01), (0.0, 0.0)], strict=True
        )
        for time, share in zip((1.0, 2.0), shares, strict=True)
    )
    alarm = pd.DataFrame(
        {**WHO[3], "forecaster": "permanent_alarm", "prediction_time_lt": time, **outcome}
        | {"f_score": 0.4}
        for time in (1.0, 2.0)
    )
    control = pd.DataFrame(
        {**keys, "metric": "fallback_fraction", "value": share}
        for keys, share in zip(WHO, (0.0, 0.25, 0.01, np.nan), strict=True)
    )
    escaped = [{**WHO[2], "metric": "escaped_fraction", "value": 0.02}]
    control = pd.concat([control, pd.DataFrame(escaped)])
    changed = {"classification": pd.concat([scores, alarm]), "control": control}
    warned, rows = rows_of_warnings(tmp_path, **changed)
    assert warned[:2] == [("esn", 50, "invalid_forecasts"), ("esn", 50, "fallback_decisions")]
    assert [name for *_, name in warned[2:]] == ["escaped_flows"]
    assert "in 1 of 1 runs of control, up to 0.02 of the flows" in rows[2]["finding"]
    assert "2 LT 5.00%" in rows[0]["finding"]
    assert "1 LT" not in rows[0]["finding"]
    assert "in 1 of 2 runs of control, up to 25%" in rows[1]["finding"]


def test_signs_of_the_case_come_first_and_name_nobody(tmp_path):
    outside = {"edge": np.arange(3.0), "count": np.array([5, 5]), "below": 2, "above": 1}
    moments = {"states": 1, "mean": np.zeros(3), "mean_product": np.zeros((3, 3))}
    unknown = dict.fromkeys(["lyapunov_exponent", *EXPONENT], np.nan)
    ends = {f"{name}_{end}": np.nan for name in EXPONENT for end in ("low", "high")}
    warned, _ = rows_of_warnings(
        tmp_path,
        data={**outside, **moments},
        events_summary={"usable_events": 1, "largest_observable": 3.0},
        calibration_set={"washout_maximum": np.array([2.0])},
        dataset=pd.DataFrame([{**unknown, **ends}]),
        noise=30.0,
    )
    names = ("few_events", "nothing_to_calibrate_with", "outside_bins", "noise_drowns_components")
    assert warned == [(None, None, name) for name in (*names, "no_exponent")]

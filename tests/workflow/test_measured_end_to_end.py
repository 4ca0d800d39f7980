"""Measured series through the whole workflow.

A simulated ensemble is written to CSV and read as data: everything that does not need equations is
the same, to the last bit.
"""

from dataclasses import replace

import numpy as np
import pytest
from helpers_rebuilds import Project
from pandas.testing import assert_frame_equal

from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.files.tables import read_table
from burstcast.base.random_streams import stream
from burstcast_workflow.harness.storage import read_json

LINEAR = {"linear_inverse": {}}
NETWORK = {"neurons": [30], "validation": ["RV"], "seeds": 1}
FORECASTERS = {"esn": NETWORK, "quadratic_filtered": {}, **LINEAR}
SETTINGS = {
    "event_threshold": 38,
    "density": {"bins": 20, "range": [0, 50]},
    "fixed_point": {"variation": 0.5, "above": 0},
    "test_series": 5,
    "training": {"series": 3, "noise": 0.01},
    "recycle_validation": {"series": 2, "intervals_per_series": 2},
    "lyapunov": {"given_exponent": 0.906, "orthonormalisation_interval": 0.1},
}
SIMULATED = {
    "system": "lorenz63",
    **SETTINGS,
    "lyapunov": {**SETTINGS["lyapunov"], "series": 2},
    "ensemble": {
        **{"series": 9, "time_step": 0.005, "sampling_stride": 4},
        **{"transient": 10, "duration": 20},
    },
}
OF_FILES = {"files": ["lab/run_*.csv"], "observable": "z", "time_step": 0.02}
MEASURED = {**SETTINGS, "data": OF_FILES}
PAST = {"data": {"case": "lorenz", "components": ["x"], "delays": [3, 7]}}
PART = {"data": {"case": "lorenz", "components": ["x", "r = sqrt(x**2 + y**2)"]}}
# measured series have another bias and offset of their inputs by default
INPUTS = {"input_bias": 0.1, "input_offset": "none"}
CAMPAIGN = {
    "forecasters": {"esn": {"backend": "scipy", **INPUTS}, "filter": {"members": 20}},
    "search": {"grid": 2, "bayesian_points": 1},
    "classification": {"longest_prediction_time_lt": 3, "prediction_times_lt": [1, 2]},
    "horizon": {"events": 6, "longest_lead_time_lt": 2},
    "statistics": {
        **{"starting_points": 4, "duration": 10, "fixed_point_interval_lt": 1},
        **{"lyapunov_exponents": 2, "lyapunov_runs": 2, "floor_splits": 2},
    },
    "bootstrap": {"resamples": 20},
    "control": {"forecasters": {"esn": None, "equations": None}},
    "figures": {
        **{"example_case": "lorenz", "fixed_neurons": 30},
        "example_forecaster": "esn-N30-RV-seed0",
    },
}


def campaign(results, cases, forecasters):
    blocks = [{"cases": [case], "forecasters": forecasters[case]} for case in cases]
    return {"results": f"results/{results}", "campaign": blocks, "cases": cases, **CAMPAIGN}


@pytest.fixture(scope="module")
def project(tmp_path_factory, job_server):
    """Both campaigns: simulated with a part of it beside, and the same series from files."""
    cases = {"lorenz": SIMULATED, "part": PART, "past": PAST}
    # of the parts, only what is scored: networks and filters of others are elsewhere
    forecasters = {"part": LINEAR, "past": LINEAR, "lorenz": FORECASTERS}
    directory = tmp_path_factory.mktemp("measured") / "project"
    simulated = campaign("simulated", cases, forecasters)
    project = Project.create(directory, job_server, "simulated.yaml", simulated)
    project.made("forecasters", "tables")
    (directory / "lab").mkdir()
    states = read_netcdf(directory / "results/simulated/lorenz/ensemble.nc")["state"]
    for number, series in enumerate(states, 4):  # run_10 after run_9
        project.write_series(f"lab/run_{number}.csv", "x,y,z", 0.02, series)
    project = replace(project, preset="measured.yaml")
    project.configure(campaign("measured", {"lorenz": MEASURED}, {"lorenz": FORECASTERS}))
    outcome = project.made("forecasters", "tables")
    assert "lorenz: measured series; off: " in outcome.text
    return project


def test_the_ensemble_and_all_that_learns_from_it_are_the_same(project):
    network = "networks/esn-N30-RV-seed0"
    files = [f"{network}/long_term", f"{network}/lyapunov_spectrum", "ensemble"]
    for forecaster in (network, "models/quadratic_filtered", "models/linear_inverse"):
        made = ("forecaster", "forecast", "horizon", "calibration_forecast")
        files += [f"{forecaster}/{name}" for name in made]
    for file in files:
        simulated, measured = (
            read_netcdf(project.directory / f"results/{name}/lorenz/{file}.nc")
            for name in ("simulated", "measured")
        )
        assert set(simulated) == set(measured)
        for name, array in simulated.items():
            np.testing.assert_array_equal(measured[name], array, err_msg=file)


def of_lorenz(path):
    table = read_table(path)
    kept = table["case"] == "lorenz"
    if path.name.startswith(("lyapunov_spectrum", "kaplan_yorke")):  # data: those of equations
        kept &= table["forecaster"] != "data"
    return table[kept].reset_index(drop=True)


def test_tables_are_the_same(project):
    simulated, measured = (
        project.directory / "results" / name / "tables" for name in ("simulated", "measured")
    )
    names = {path.name for path in measured.glob("*.csv")}
    others = {path.name for path in simulated.glob("*.csv")} - names
    assert others == {"data_generation_parameters.csv"}  # of what is simulated
    compared = {name for name in names if "case" in read_table(simulated / name)} - {"dataset.csv"}
    assert {"classification.csv", "horizon.csv", "statistics.csv", "survival.csv"} < compared
    assert {"probability_scores.csv", "lead_times.csv", "hyperparameters.csv"} < compared
    for name in compared:
        # where other rows have nothing, whole numbers are written as others are
        exactly = {"check_dtype": False, "check_exact": True, "obj": name}
        rows, other = of_lorenz(simulated / name), of_lorenz(measured / name)
        if name == "warnings.csv":  # an estimate of the exponent is doubted, a known one is not
            other = other[other["warning"] != "exponents_differ"].reset_index(drop=True)
        assert_frame_equal(rows, other, **exactly)
    rows, other = of_lorenz(simulated / "dataset.csv"), of_lorenz(measured / "dataset.csv")
    by_equations = [name for name in rows if name.startswith("lyapunov_exponent")]
    assert rows.drop(columns=by_equations).equals(other.drop(columns=by_equations, errors="ignore"))
    exponent = read_json(project.directory / "results/measured/lorenz/lyapunov.json")["leading"]
    assert other["lyapunov_exponent"][0] == exponent["mean"]
    assert exponent["low"] < exponent["mean"] < exponent["high"]


def test_a_part_of_the_state(project):
    """The observable is seen as one more component, and scored as what it truly is."""
    results = project.directory / "results/simulated"
    whole, part = (read_netcdf(results / case / "ensemble.nc") for case in ("lorenz", "part"))
    x, y, z = whole["state"].transpose(2, 0, 1)
    expected = np.stack([x, np.sqrt(x * x + y * y), z], axis=2)
    np.testing.assert_array_equal(part["state"], expected)
    np.testing.assert_array_equal(part["observable"], whole["observable"])
    full, other = (read_netcdf(results / case / "evaluation_set.nc") for case in ("lorenz", "part"))
    np.testing.assert_array_equal(full["largest"], other["largest"])
    dataset = read_table(results / "tables/dataset.csv").set_index("case")
    assert dataset.loc["part", "lyapunov_exponent"] == dataset.loc["lorenz", "lyapunov_exponent"]
    table = read_table(results / "tables/classification.csv")
    assert set(table["case"]) == {"lorenz", "part", "past"}
    spectrum = read_table(results / "tables/lyapunov_spectrum.csv")
    with_data = spectrum.loc[spectrum["forecaster"] == "data", "case"]
    assert set(with_data) == {"lorenz"}


def test_the_past_of_a_part(project):
    """Past values are components; they have the noise of their own time, the truth has none."""
    results = project.directory / "results/simulated"
    whole, past = (read_netcdf(results / case / "ensemble.nc") for case in ("lorenz", "past"))
    x, z = whole["state"][..., 0], whole["observable"]
    noise = np.empty((*x.shape, 2))
    for row in range(len(x)):
        # by hand: the first numbers of a series' stream, and so on
        noise[row] = stream(2022, "noise", "past", row).standard_normal((*x.shape[1:], 2))
    training = [values[: SETTINGS["training"]["series"]].std() for values in (x, z)]
    seen_x, seen_z = (
        values + 0.01 * training[i] * noise[..., i] for i, values in enumerate((x, z))
    )
    steps = x.shape[1]
    expected = [seen_x[:, 7:], seen_x[:, 4 : steps - 3], seen_x[:, : steps - 7], seen_z[:, 7:]]
    np.testing.assert_allclose(past["state"], np.stack(expected, axis=2), rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal(past["observable"], z[:, 7:])
    # what follows starting points is the truth, what is seen is not
    points = read_netcdf(results / "past/evaluation_set.nc")
    assert set(points["largest"].ravel()) <= set(z.ravel())
    assert not set(points["observable_now"].ravel()) & set(z.ravel())
    np.testing.assert_array_equal(points["washout"][:, -1, 3], points["observable_now"])
    assert set(points["washout"][..., 1].ravel()) <= set(past["state"][..., 1].ravel())


def test_series_without_an_exponent(tmp_path, job_server):
    """Neighbours that never part leave the exponent empty; as the unit of time it is missed."""
    angle = 0.1 * np.arange(400)
    case = {
        **{"event_threshold": 0.9, "test_series": 5, "training": {"series": 3}},
        **{"recycle_validation": {"series": 2}, "lyapunov": {"given_exponent": 1.0}},
        "data": {"files": ["circle_*.csv"], "observable": "x", "time_step": 0.05},
    }
    config = campaign("circles", {"circles": case}, {"circles": {"persistence": {}}})
    config["figures"] = {"example_case": "circles"}
    config |= {"washout_lt": 1, "statistics": {"forecasters": {"esn": None}, "floor_splits": 2}}
    project = Project.create(tmp_path / "project", job_server, "circles.yaml", config)
    for number in range(8):
        circle = np.stack([np.cos(angle + 0.73 * number), np.sin(angle + 0.73 * number)], axis=1)
        project.write_series(f"circle_{number}.csv", "x,y", 0.05, circle)
    tables = "results/circles/circles/tables"
    outcome = project.made(*(f"{tables}/{name}.csv" for name in ("dataset", "warnings")))
    assert "no networks in the campaign; off: " in outcome.text
    assert "no Lyapunov exponent is estimated: no exponent can be seen" in outcome.text
    exponents = read_json(project.directory / "results/circles/circles/lyapunov.json")
    assert exponents["leading"] == {"mean": None, "low": None, "high": None}
    assert "do not part within 125 steps" in exponents["no_estimate"]
    (dataset,) = read_table(project.directory / f"{tables}/dataset.csv").to_dict("records")
    assert np.isnan(dataset["lyapunov_exponent"])
    assert dataset["steps_per_lyapunov_time"] == 20
    warnings = read_table(project.directory / f"{tables}/warnings.csv")["warning"].tolist()
    assert "no_exponent" in warnings
    assert "exponents_differ" not in warnings
    case["lyapunov"] = {}
    project.configure(config)
    outcome = project.snakemake(f"{tables}/dataset.csv")
    assert outcome.status == 1
    remedy = "a third of a series; give the unit of time (lyapunov.given_exponent, its inverse)"
    assert remedy in outcome.text

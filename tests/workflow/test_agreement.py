"""What must agree: estimator and workflow, and choices whatever the test series."""

import numpy as np
import pytest
import yaml
from helpers_rebuilds import RESULTS, ROOT, Project, digests, jobs_since, rules_of
from numpy.testing import assert_array_equal

from burstcast.base.files.netcdf import read_attributes, read_netcdf
from burstcast.event_forecaster import forecaster
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.forecasters._options import SECTIONS
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast_workflow.campaign.campaign import SIMULATED_INPUTS
from burstcast_workflow.config.forecasters import Forecasters
from burstcast_workflow.harness.canonical import canonical
from burstcast_workflow.harness.storage import read_json

# -- the estimator is the workflow -----------------------------------------------------------------

CASE = "Re400"


def settings_of(config, kind, neurons=40, validation="RV"):
    """The settings of a preset in the words of the estimator."""
    of_case, search = config["case_defaults"], config["search"]
    recycle = config["cases"][CASE]["recycle_validation"]
    esn = config["forecasters"]["esn"]
    options = {**{name: esn[name] for name in ("backend", "readout")}, **SIMULATED_INPUTS}
    if kind != "esn":
        options = {"members": config["forecasters"]["filter"]["members"]}
    shared = ("spectral_radius", "input_scaling", "tikhonov", "grid", "bayesian_points")
    return {
        "kind": kind,
        "observable": MoehlisFaisstEckhardt(reynolds=400.0),
        "event_threshold": of_case["event_threshold"],
        "prediction_times": config["classification"]["prediction_times_lt"],
        "window": config["classification"]["window_lt"],
        "lyapunov_time": 1 / config["cases"][CASE]["lyapunov"]["given_exponent"],
        "sampling_interval": 1.0,
        "sampling_stride": of_case["ensemble"]["sampling_stride"],
        "washout": config["washout_lt"],
        "members": 1,
        "neurons": neurons,
        "validation": validation,
        "validation_interval": search["interval_lt"],
        "validation_series": recycle["series"],
        "intervals_per_series": recycle["intervals_per_series"],
        "noise": of_case["training"]["noise"],
        "random_seed": config["random_seed"],
        "case": CASE,
        **{name: search[name] for name in shared},
        "options": options,
    }


@pytest.mark.parametrize(
    ("directory", "alarm", "kind", "axes"),
    [
        ("networks/esn-N40-RV-seed0", "esn-N40-RV-seed0", "esn", (40, "RV")),
        ("networks/esn-N30-SSV-seed0", "esn-N30-SSV-seed0", "esn", (30, "SSV")),
        # the members of the filter's ensemble vote
        ("models/quadratic_filtered", "quadratic_filtered-committee", "quadratic_filtered", ()),
    ],
)
def test_a_forecaster_is_the_workflows_bit_for_bit(finished, directory, alarm, kind, axes):
    case = finished.results / CASE
    config = read_json(finished.results / ".run.json")["config"]
    states = read_netcdf(case / "ensemble.nc", "state")["state"]
    training = states[: config["case_defaults"]["training"]["series"]]
    model = EventForecaster(**settings_of(config, kind, *axes)).fit(training)
    record = model.members_[0].record()
    stored = read_netcdf(case / directory / "forecaster.nc")
    # the workflow's file has the training range, too, beyond which forecasts are invalid
    limits = {name: stored.pop(name) for name in ("training_low", "training_high")}
    assert (limits["training_low"] < limits["training_high"]).all()
    assert set(stored) == set(record.arrays)
    for name, array in stored.items():
        assert_array_equal(record.arrays[name], array)
    if kind == "esn":
        attributes = read_attributes(case / directory / "forecaster.nc")
        assert all(attributes[name] == value for name, value in record.attributes.items())
        chosen = read_json(case / directory / "hyperparameters.json")
        assert model.hyperparameters_[0].items() <= chosen.items()
    # probabilities, from forecasts of each training series by a readout that has not seen it
    rules = read_json(case / "calibration.json")["alarms"][alarm]
    assert len(model.alarms_) > 1
    for time, made in model.alarms_.items():
        rule = rules[f"{time:g}"]["calibrated"]
        assert made.calibration.values.tolist() == rule["values"]
        assert made.calibration.probabilities.tolist() == rule["probabilities"]
        assert made.threshold == rule["threshold"]
    varied = [np.ptp(made.calibration.probabilities) > 0 for made in model.alarms_.values()]
    assert any(varied) or kind != "esn"


def test_the_options_of_kinds_are_those_of_the_config():
    defaults = canonical({name: vars(section()) for name, section in SECTIONS.items()})
    assert Forecasters().dump() == {**defaults, "variants": {}}


def test_defaults_are_those_of_the_config():
    """Parameters that the config has too, but for those of the case and the paper's networks."""
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    search, probability = config["search"], config["probability"]
    classification = config["classification"]
    networks = config["campaign"][0]["forecasters"]["esn"]
    expected = {
        "members": networks["seeds"],
        "neurons": networks["neurons"][0],
        "tikhonov": tuple(search["tikhonov"]),
        "grid": search["grid"],
        "bayesian_points": search["bayesian_points"],
        "prior_forecasts": probability["prior_forecasts"],
    }
    durations = {
        "washout": config["washout_lt"],
        "window": classification["window_lt"],
        "start_spacing": classification["start_spacing_lt"],
        "validation_interval": search["interval_lt"],
        "calibration_spacing": probability["start_spacing_lt"],
    }
    assert {name: in_lt for name, (in_lt, _) in forecaster.DURATIONS.items()} == durations
    defaults = EventForecaster().get_params()
    assert {name: defaults[name] for name in expected} == expected
    assert probability["bins"] == forecaster.BINS


# -- nothing of the test series enters a choice: with noise in their place all stays ---------------

TRAINING, TEST = 3, 12  # series of the tiny preset
CHOSEN = (
    "scan/*/*",
    "*/*/hyperparameters.json",
    "*/*/search.csv",
    "*/*/forecaster.nc",
    "calibration_set.nc",
    "*/*/calibration_forecast.nc",
    "calibration.json",
)
FURTHER = {"probability": {"calibration_series": 2}}
SIMULATE = "workflow/scripts/data/simulate.py"
OBSERVABLE = "    observable = np.stack("


def put_noise(project: Project, first: int, stop: int) -> None:
    """Let the ensemble have noise of the size of its states in place of some of its series."""
    rows = f"states[{first}:{stop}]"
    noise = f"np.random.default_rng({first}).uniform(-0.3, 0.3, {rows}.shape)"
    project.edit(SIMULATE, OBSERVABLE, f"    {rows} = {noise}\n{OBSERVABLE}")


def chosen(project: Project) -> list[str]:
    """Files of all that is chosen, below the directory of the results."""
    return sorted(
        str(path.relative_to(project.results))
        for pattern in CHOSEN
        for path in project.results.glob(f"Re400/{pattern}")
        if not path.name.startswith(".")
    )


def make(project: Project, names: list[str], overlay: dict | None = None) -> dict[str, str]:
    """Make files, and tell their digests."""
    project.made(*(f"{RESULTS}/{name}" for name in names), overlay=overlay)
    made = digests(project.results)
    return {name: made[name] for name in names}


@pytest.fixture
def with_noise(finished, tmp_path):
    """The tiny preset, with noise in place of its test series once the ensemble is made anew."""
    project = finished.copy(tmp_path / "noise")
    put_noise(project, TRAINING, TRAINING + TEST)
    return project


@pytest.mark.long
def test_what_is_chosen_stays_bit_for_bit(finished, with_noise):
    names, test_set = chosen(finished), "Re400/evaluation_set.nc"
    assert len(names) > 20
    before, logs = digests(finished.results), with_noise.logs()
    after = make(with_noise, [*names, test_set])
    assert {name: after[name] for name in names} == {name: before[name] for name in names}
    # while the test set is another one, and all was made anew
    assert after[test_set] != before[test_set]
    assert rules_of(jobs_since(logs, with_noise.logs())) >= {
        *("simulate", "scan", "search", "train", "fit"),
        *("calibration_set", "calibration_forecast", "calibrate", "evaluation_set"),
    }


@pytest.mark.long
def test_further_calibration_series_are_neither_training_nor_test(finished, with_noise, tmp_path):
    name = "Re400/calibration_set.nc"
    beyond = finished.copy(tmp_path / "beyond")
    put_noise(beyond, TRAINING + TEST, TRAINING + TEST + 2)
    before = make(finished.copy(tmp_path / "true"), [name], FURTHER)
    assert make(with_noise, [name], FURTHER) == before
    # they are those that follow: noise there changes the set
    assert make(beyond, [name], FURTHER) != before
    assert set(read_netcdf(beyond.results / name, "series")["series"]) == {0, 1}

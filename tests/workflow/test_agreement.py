"""What must agree: estimator and workflow, both backends, choices without the test series."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from helpers_rebuilds import RESULTS, Project, digests, jobs_since, rules_of
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

ROOT = Path(__file__).parents[2]
CASE = "Re400"


def settings_of(config, neurons, validation):
    """The settings of a preset in the words of the estimator."""
    of_case = config["case_defaults"]
    reynolds = MoehlisFaisstEckhardt(reynolds=400.0)
    recycle = config["cases"][CASE]["recycle_validation"]
    return {
        "observable": reynolds,
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
        "validation_interval": config["search"]["interval_lt"],
        "validation_series": recycle["series"],
        "intervals_per_series": recycle["intervals_per_series"],
        "tikhonov": config["search"]["tikhonov"],
        "grid": config["search"]["grid"],
        "bayesian_points": config["search"]["bayesian_points"],
        "noise": of_case["training"]["noise"],
        "random_seed": config["random_seed"],
        "case": CASE,
        **{name: config["search"][name] for name in ("spectral_radius", "input_scaling")},
        "options": {
            **{name: config["forecasters"]["esn"][name] for name in ("backend", "readout")},
            **SIMULATED_INPUTS,
        },
    }


@pytest.mark.parametrize(("neurons", "validation"), [(40, "RV"), (30, "SSV")])
def test_a_network_is_the_workflows_bit_for_bit(finished, neurons, validation):
    results = finished.results
    config = read_json(results / ".run.json")["config"]
    training = config["case_defaults"]["training"]["series"]
    states = read_netcdf(results / CASE / "ensemble.nc", "state")["state"]
    model = EventForecaster(**settings_of(config, neurons, validation)).fit(states[:training])

    identifier = f"esn-N{neurons}-{validation}-seed0"
    path = results / CASE / "networks" / identifier / "forecaster.nc"
    (member,) = model.members_
    record = member.record()
    for name, array in read_netcdf(path).items():
        assert_array_equal(record.arrays[name], array)
    attributes = read_attributes(path)
    for name, value in record.attributes.items():
        assert attributes[name] == value
    hyperparameters = read_json(path.parent / "hyperparameters.json")
    assert model.hyperparameters_ == [
        {name: hyperparameters[name] for name in model.hyperparameters_[0]}
    ]
    # probabilities, from forecasts of each training series by a readout that has not seen it
    rules = read_json(results / CASE / "calibration.json")["alarms"][identifier]
    assert len(model.alarms_) > 1
    for time, alarm in model.alarms_.items():
        rule = rules[f"{time:g}"]["calibrated"]
        assert alarm.calibration.values.tolist() == rule["values"]
        assert alarm.calibration.probabilities.tolist() == rule["probabilities"]
        assert alarm.threshold == rule["threshold"]
    assert any(np.ptp(alarm.calibration.probabilities) > 0 for alarm in model.alarms_.values())


def test_a_forecaster_without_a_search_is_the_workflows(finished):
    results = finished.results
    config = read_json(results / ".run.json")["config"]
    states = read_netcdf(results / CASE / "ensemble.nc", "state")["state"]
    settings = settings_of(config, 40, "RV") | {
        "kind": "quadratic_filtered",
        "options": {"members": config["forecasters"]["filter"]["members"]},
    }
    model = EventForecaster(**settings).fit(states[: config["case_defaults"]["training"]["series"]])
    record = model.members_[0].record()
    stored = read_netcdf(results / CASE / "models" / "quadratic_filtered" / "forecaster.nc")
    assert set(stored) == set(record.arrays)
    for name, array in stored.items():
        assert_array_equal(record.arrays[name], array)
    # the members of the filter's ensemble vote
    alarms = read_json(results / CASE / "calibration.json")["alarms"]
    for time, alarm in model.alarms_.items():
        rule = alarms["quadratic_filtered-committee"][f"{time:g}"]["calibrated"]
        assert alarm.calibration.values.tolist() == rule["values"]
        assert alarm.calibration.probabilities.tolist() == rule["probabilities"]


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


# -- both backends, within the intervals that resampling gives -------------------------------------


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
        project.made(*wanted, overlay=overlay)
        made[backend] = {
            "scores": pd.read_csv(project.directory / directory / "tables/classification.csv"),
            "intervals": pd.read_csv(project.directory / wanted[0]),
            "horizons": pd.concat(
                pd.DataFrame(read_netcdf(path))
                .rename_axis("event")
                .reset_index()
                .assign(network=path.parent.name)
                for path in sorted((project.directory / directory).glob("Re400/*/*/horizon.nc"))
            ),
        }
    return made


@pytest.mark.long
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


@pytest.mark.long
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

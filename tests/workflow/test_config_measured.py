"""Cases of measured series in a config: what they start from, and every message."""

import re
from pathlib import Path

import pytest
import yaml

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.cases import is_flow
from burstcast_workflow.config.loading import ConfigError, load
from burstcast_workflow.config.measured_cases import data_files
from burstcast_workflow.config.model import Data
from burstcast_workflow.costs.model import CostModel

ROOT = Path(__file__).parents[2]
DATA = {"files": ["lab/run_*.csv"], "components": ["u", "v"], "observable": "u", "time_step": 0.5}
LAB = {
    "data": DATA,
    "event_threshold": -1.5,
    "density": {"range": [-4, 0]},
    "test_series": 3,
    "training": {"series": 2},
    "recycle_validation": {"series": 1},
}
PART = {"data": {"case": "Re400", "components": ["a1", "s = a2**2 + a3**2"]}}


@pytest.fixture
def config(tmp_path, monkeypatch):
    """One simulated case, one of files, one that is a part of the simulated one."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab").mkdir()
    for number in (10, 9, 1):
        (tmp_path / "lab" / f"run_{number}.csv").write_text("time,u,v\n0,1,2\n")
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    config["cases"] |= {"lab": dict(LAB), "part": dict(PART)}
    networks = {"neurons": [2000], "validation": ["RV"], "seeds": 1}
    config["campaign"] = [
        {"reynolds": [400], "forecasters": {"esn": networks, "equations": {}}},
        {
            "cases": ["lab", "part"],
            "forecasters": {"esn": networks, "quadratic_filtered": {}, "persistence": {}},
        },
    ]
    config["statistics"] |= {"duration": 100, "fixed_point_interval_lt": 1}
    return config


def case_records(loaded):
    """All settings of each case, as plain data."""
    return {name: case.dump() for name, case in Campaign(loaded).cases.items()}


def problem(config):
    with pytest.raises(ConfigError) as caught:
        load(config)
    assert len(caught.value.problems) == 1, caught.value.problems
    return caught.value.problems[0]


def test_records(config):
    records = case_records(load(config))
    lab, part, whole = records["lab"], records["part"], records["Re400"]
    # nothing in units of the shear flow
    assert lab["laminarisation_threshold"] is None
    assert lab["training"] == {"series": 2, "noise": 0, "actuation": None, "trained_on": []}
    assert lab["ensemble"] == {"time_step": 0.125, "sampling_stride": 4, "duration": None}
    assert lab["lyapunov"] == {
        "time_unit": "published",
        "published_exponent": None,
        "orthonormalisation_interval": 2.5,
    }
    assert lab["fixed_point"] == {"variation": 0.04, "above": -4}
    assert lab["parameters"]["components"] == ["u", "v"]
    assert lab["actuation"] is None
    # everything of the same series
    for name in ("event_threshold", "laminarisation_threshold", "training", "test_series"):
        assert part[name] == whole[name]
    assert part["lyapunov"]["published_exponent"] == 0.0163
    assert part["ensemble"] == {"time_step": 0.25, "sampling_stride": 4, "duration": 4000}
    assert part["parameters"] == {
        "components": ["a1", "s"],
        "observable_of": "observable",
        "observable_name": "kinetic energy",
        "observable_symbol": "k",
    }
    assert part["data"]["columns"] == [f"a{number}" for number in range(1, 10)]


def test_past_values_are_components(config):
    config["cases"]["part"] = {"data": {**PART["data"], "delays": [20, 10]}}
    campaign = Campaign(load(config))
    part = campaign.cases["part"].dump()
    names = ["a1", "s", "a1(t-20)", "s(t-20)", "a1(t-10)", "s(t-10)"]
    assert part["parameters"]["components"] == names
    assert campaign.space("part").dimension == 7  # and the observable
    # every series begins later
    assert part["ensemble"] == {"time_step": 0.25, "sampling_stride": 4, "duration": 3980}
    # the noise is there before the past values are taken, and not added again
    assert part["training"]["noise"] == 0.01
    assert campaign.noise_of_data("part") == {"level": 0.01, "random_seed": 2022}
    assert campaign.noise_of_data("lab") is campaign.noise_of_data("Re400") is None
    for case, noise in (("part", 0), ("Re400", 0.01)):
        settings = campaign.settings(["case.training.noise"], {"case": case}, {})
        assert settings == {"case.training.noise": noise}
    # measured series have their own
    config["cases"] |= changed("lab.data.delays", [3])
    assert Campaign(load(config)).noise_of_data("lab") is None


def test_whose_unit_of_time_is_an_estimate(config):
    campaign = Campaign(load(config))
    estimates = {case: campaign.estimates_time_unit(case) for case in campaign.case_names}
    assert estimates == {"Re400": False, "lab": True, "part": False}
    config["cases"] |= changed("lab.lyapunov", {"published_exponent": 0.01})
    assert not Campaign(load(config)).estimates_time_unit("lab")


def test_thresholds_of_another_observable_are_not_inherited(config):
    config["cases"]["part"] = {"data": {**PART["data"], "observable": "a1"}}
    with pytest.raises(ConfigError) as caught:
        load(config)
    text = "\n".join(caught.value.problems)
    assert "case part: event_threshold is missing" in text
    config["cases"]["part"]["event_threshold"] = 0.3
    assert case_records(load(config))["part"]["density"]["range"] is None  # of the data


def test_what_a_campaign_makes_of_them(config):
    campaign = Campaign(load(config))
    assert campaign.simulated_cases == ("Re400",)
    assert campaign.measured_cases == ("lab", "part")
    assert is_flow(campaign.cases["Re400"])
    assert not is_flow(campaign.cases["part"])
    assert campaign.source_case("part") == "Re400"
    assert campaign.source_case("lab") == "lab"
    assert {run.case for run in campaign.strategy_runs} == {"Re400"}
    # only what is about measured series depends on their code
    assert campaign.modules({"case": "part"})["burstcast.systems"] == ["measured"]
    assert campaign.modules({"case": "Re400"})["burstcast.systems"] == ["mfe"]
    costs = CostModel(campaign)
    for case in ("lab", "part"):
        names = {"case": case, "forecaster": "esn-N2000-RV-seed0"}
        assert costs.predicted("training", names).seconds > 0


def test_files_as_people_sort_their_names(config):
    data = Data(files=["lab/run_*.csv"], observable="u")
    assert data_files(data) == [f"lab/run_{number}.csv" for number in (1, 9, 10)]
    data = Data(files=["lab/run_9.csv", "./lab/run_*.csv", "upstream.csv"], observable="u")
    assert data_files(data) == ["lab/run_9.csv", "lab/run_1.csv", "lab/run_10.csv", "upstream.csv"]


def changed(name, value):
    """Cases with one setting of `lab` or `part` changed."""
    case, *path = name.split(".")
    cases = {"lab": LAB, "part": PART}
    found = dict(cases[case])
    place = found
    for key in path[:-1]:
        place[key] = dict(place.get(key, {}))
        place = place[key]
    if value is ...:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return {case: found}


@pytest.mark.parametrize(
    ("name", "value", "part"),
    [
        ("lab.event_threshold", ..., "case lab: event_threshold is missing"),
        ("lab.data.observable", ..., "case lab: data.observable is missing"),
        ("lab.data.time_step", ..., "case lab: data.time_step is missing: the time between"),
        ("lab.data.time_step", 0, "data.time_step is 0; it must be a number above 0"),
        ("lab.data.time_step", "5 months", "time_step is the text '5 months'; it must be a number"),
        ("lab.data.gaps", "fill", "data.gaps is the text 'fill'; it must be cut"),
        ("lab.data.gaps", "cut", "case lab: data.gaps needs data.blocks beside it"),
        ("lab.data.time", "t", "unknown setting cases.lab.data.time"),
        ("lab.data.files", ["lab/run_2.csv"], "data.files: lab/run_2.csv: there is no such file"),
        ("lab.data.files", ["lab/run_1.mat"], "lab/run_1.mat: files of series end in .csv"),
        ("lab.data.components", ["w"], "data.files: lab/run_1.csv: there is no column 'w'"),
        ("lab.data.known", ["w"], "data.known: there is no column 'w'"),
        ("lab.data.files", [], "case lab: data needs files"),
        ("lab.data.case", "Re400", "case lab: data needs files: [...], or else the name"),
        ("lab.data.files", ["lab/x_*"], "case lab: data.files: no file is called lab/x_*"),
        ("lab.data.observable", "u +", "'u +' is no arithmetic expression"),
        ("lab.data.observable", "sin(u)", "sin(u) is not understood"),
        ("lab.data.components", ["u", "u = v"], "data.components has u twice"),
        ("lab.data.step", 1, "unknown setting cases.lab.data.step"),
        ("lab.data.blocks", {"gap": 1}, "case lab: data.blocks.duration is missing"),
        ("lab.data.delays", [2, 0], "cases.lab.data.delays[1] is 0; it must be a whole number"),
        ("lab.data.delays", [2, 2], "cases.lab.data.delays has 2 twice"),
        ("lab.data.observable", "u(t-2)", "u(t - 2) is not understood"),
        ("part.data.delays", [4000], "case part: data.delays reach back by 4000 steps"),
        ("lab.system", "mfe", "case lab: system means nothing for measured series"),
        ("lab.actuation", {"parameters": {}}, "case lab: actuation means nothing"),
        ("lab.training.series", 1, "case lab: training.series is 1, but probabilities"),
        ("part.data.case", "Re600", "case part: data.case is Re600; it must be a case of the"),
        ("part.data.case", "part", "case part: data.case is part; it must be a case of the"),
        ("part.data.case", "lab", "that is simulated: Re400"),
        ("part.data.components", ["a1", "b"], "there is no column 'b'"),
        ("part.data.components", ["a1", "a10"], "no column 'a10' (did you mean 'a1'?)"),
        (
            "lab.encoder",
            {"kind": "pod", "modes": 1},
            "sensors and encoder are for cases of another",
        ),
        ("part.data.time_step", 1, "data.time_step means nothing where the series come from"),
    ],
)
def test_mistakes(config, name, value, part):
    config["cases"] |= changed(name, value)
    assert part in problem(config)


def test_forecasters_that_need_equations(config):
    config["campaign"][1]["forecasters"] |= {"equations": {}, "equations_filtered": {}}
    assert re.search(
        r"cases lab, part: there are no equations of measured series to forecast with "
        r"\(equations, equations_filtered\)",
        problem(config),
    )


def test_control_needs_equations(config):
    block = {"strategy": "reactive", "settings": {"level": [0.05], "decision_interval_lt": [0.5]}}
    config["control"]["strategies"] = [{**block, "cases": ["part"]}]
    assert "control.strategies[0].cases: control needs equations" in problem(config)


def test_long_runs_are_as_long_as_the_series(config):
    config["statistics"]["duration"] = None
    campaign = Campaign(load(config))
    paths = ["statistics.duration"]
    assert campaign.settings(paths, {"case": "lab"}, {}) == {"statistics.duration": None}
    assert campaign.settings(paths, {"case": "Re400"}, {}) == {"statistics.duration": 4000}
    config["cases"] |= changed("lab.data.blocks", {"duration": 50})
    assert case_records(load(config))["lab"]["data"]["blocks"] == {"duration": 50, "gap": 0}


def test_components_are_the_columns_of_the_header(config, tmp_path):
    config["cases"] |= changed("lab.data.components", ...)
    for name in (1, 9, 10):
        (tmp_path / "lab" / f"run_{name}.csv").write_text("time,u,w,v,rain\n0,1,2,3,1\n")
    config["cases"]["lab"]["data"] |= {"known": ["rain"]}
    config["campaign"][1]["forecasters"] = {"persistence": {}}
    lab = case_records(load(config))["lab"]
    assert lab["data"]["components"] == ["u", "w", "v"]
    assert lab["parameters"]["components"] == ["u", "w", "v"]


def test_an_observable_with_a_name(config):
    config["cases"] |= changed("lab.data.observable", "speed = sqrt(u**2 + v**2)")
    parameters = case_records(load(config))["lab"]["parameters"]
    assert parameters["observable_of"] == "sqrt(u**2 + v**2)"
    assert Campaign(load(config)).space("lab").observable_name == "speed"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("1,2\n3.5,4\n", "line 1 has numbers where the names of the columns are expected"),
        ("", "lab/run_9.csv is empty"),
        ("date,u,v\n2020-01-01,1,2\n", "has no column 'time'; its columns are date, u, v: rename"),
        (",u,v\n2020-01-01,1,2\n", "column 1 has no name: pandas writes an index so; call it time"),
    ],
)
def test_what_headers_show_is_told_before_any_job(config, tmp_path, content, message):
    (tmp_path / "lab" / "run_9.csv").write_text(content)
    assert message in problem(config)
    assert "lab/run_9.csv" in problem(config)


def test_what_is_left_out_of_a_case_follows_from_the_data(config):
    config["cases"]["lab"] = {"data": DATA, "event_threshold": -1.5}
    lab = case_records(load(config))["lab"]
    assert lab["recycle_validation"] == {"series": 4, "intervals_per_series": None}
    assert lab["density"] == {"bins": 200, "range": None}
    assert lab["test_series"] is lab["fixed_point"] is None
    costs = CostModel(Campaign(load(config)))
    costs.classes["forecast"] = "forecast"
    network = {"case": "lab", "forecaster": "esn-N2000-RV-seed0"}
    assert costs.predicted("forecast", network).minutes_for(1) >= 0

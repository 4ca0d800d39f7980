"""What a case has: from its entry, what its class or its data say, and the campaign around it."""

import copy
import os
import re
from pathlib import Path

import numpy as np
import pytest
from helpers_configs import (
    DATA,
    MEASURED,
    PRESETS,
    campaign,
    networks,
    paper_with,
    put,
    read,
    records_of,
    tiny_campaign,
)
from snakemake.utils import update_config

from burstcast.systems.lorenz63 import Lorenz63
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.caveats import extrapolations, few_points
from burstcast_workflow.campaign.job_settings import settings_of_job
from burstcast_workflow.campaign.loading import ConfigError, load
from burstcast_workflow.campaign.shown import Shown
from burstcast_workflow.config.case import Data, Measured, Simulated
from burstcast_workflow.config.model import Block, case_name
from burstcast_workflow.figures.registry import figure_names
from burstcast_workflow.harness.canonical import canonical
from burstcast_workflow.tables.registry import table_names

FREE = {"trained_on": [], "actuation": None}


@pytest.fixture
def config():
    return paper_with()


def test_reynolds_numbers_name_their_cases_in_full_and_need_no_entry(config):
    names = [case_name(value) for value in (400, 400.0, 412.5, 1234567)]
    assert names == ["Re400", "Re400", "Re412.5", "Re1234567"]
    block = {"reynolds": [400, 600], "cases": ["mine", "Re400"], "forecasters": {}}
    assert Block.model_validate(block).case_names == ["Re400", "Re600", "mine"]
    put(config, "campaign.1.reynolds", [412.5, 1234567])
    loaded = Campaign(load(config))
    assert loaded.case_names == ("Re400", "Re412.5", "Re1234567")
    for reynolds in (412.5, 1234567):
        case = {"case": case_name(reynolds)}
        record = settings_of_job(loaded, ["case.parameters", "case.test_series"], case)
        assert record["case.parameters"]["reynolds"] == reynolds
        assert record["case.test_series"] == 300


OWN = {"ensemble": {"series": 1000, "initial_state": [0.1] * 9}, "parameters": {"length_x": 1}}
OVERLAYS = {"paper": {}, "own": {"cases": {"Re400": OWN}}}
OVERLAYS |= {name: read(PRESETS[0].with_stem(name)) for name in ("aware", "training_realisations")}


@pytest.mark.parametrize("name", OVERLAYS)
def test_case_of_the_shear_flow_is_case_defaults_and_its_entry(name):
    config = paper_with(OVERLAYS[name])
    for name, record in records_of(load(config)).items():
        if record["system"] != "mfe":
            continue
        # those of other training series have the record of the case they are chosen for
        name = name.partition("-training")[0]
        unsaid = {
            **dict.fromkeys(("files", "data", "sensors", "encoder")),
            "lyapunov": {"given_exponent": None},
            "actuation": {"force": None},
            "training": FREE,
        }
        expected = copy.deepcopy(unsaid)
        for overlay in (config["case_defaults"], config["cases"].get(name, {})):
            update_config(expected, copy.deepcopy(overlay))
        if re.fullmatch(r"Re[0-9.]+", name):
            expected["parameters"]["reynolds"] = float(name.removeprefix("Re"))
        if expected["training"]["actuation"] is not None:
            defaults = {"strength": 1, "tested": False}
            expected["training"]["actuation"] = {**defaults, **expected["training"]["actuation"]}
        assert record == canonical(expected)


# -- what follows from the campaign where the config has null --------------------------------------


@pytest.mark.parametrize("given", [None, 500])
def test_what_the_papers_campaign_shows(config, given):
    config["figures"]["fixed_neurons"] = given
    shown, neurons = load(config)["figures"], given or 2000
    example = {"example_case": "Re400", "example_forecaster": f"esn-N{neurons}-RV-seed0"}
    assert (example | {"fixed_neurons": neurons}).items() <= shown.items()


@pytest.mark.parametrize(
    ("blocks", "example", "controllers"),
    [
        # the size that most cases have, and of those the largest
        ({400: [30, 50], 600: [30]}, ("Re400", "esn-N30-RV-seed0"), {"Re400", "Re600"}),
        ({600: [30, 50]}, ("Re600", "esn-N50-RV-seed0"), {"Re600"}),
        ({800: [25], 600: [30]}, ("Re600", "esn-N30-RV-seed0"), {"Re600"}),
    ],
)
def test_an_overlay_that_changes_the_campaign_needs_no_other_line(blocks, example, controllers):
    changed = campaign(
        blocks=[
            {"reynolds": [reynolds], "forecasters": networks(sizes, ("SSV", "RV"))}
            for reynolds, sizes in blocks.items()
        ]
    )
    network, runs = changed.example, changed.control_runs
    assert (network.case, network.name.identifier) == example
    assert {run.case for run in runs} == controllers
    assert {run.controller.neurons for run in runs} == {network.name.neurons}
    assert {network.name.validation for network in changed.long_term_forecasters} == {"RV"}


def test_times_that_the_campaign_has():
    times = {"classification": {"prediction_times_lt": [1, 4.5]}}
    two = campaign(times, {"control": {"prediction_times_lt": [1]}})
    shown = Shown(two, "Re400")
    assert shown.example_prediction_time_lt == 1
    assert shown.prediction_times_lt == [1, 4.5]


def test_a_campaign_without_networks():
    others = {"quadratic": {}, "equations": {}, "persistence": {}, "analogues": {}}
    plain = campaign(blocks=[{"reynolds": [600, 400], "forecasters": others}])
    assert (plain.example.case, plain.networks) == ("Re400", ())
    figures, tables = set(figure_names(plain)), set(table_names(plain))
    assert {"observable_and_density", "forecast_skill", "reliability"} <= figures
    assert not {"network_schematic", "prediction_examples"} & figures
    assert {"classification", "horizon", "warnings"} <= tables - {"hyperparameters"} == tables


# -- another system --------------------------------------------------------------------------------


def lorenz(config, **entry):
    """The record of a case of the Lorenz system with this entry."""
    config["cases"]["lorenz"] = {"system": "lorenz63", **entry}
    config["campaign"].append({"cases": ["lorenz"], "forecasters": networks([100])})
    return records_of(load(config))["lorenz"]


ENSEMBLE = {
    **{"initial_state": [1, 1, 20], "perturbed_component": 3, "perturbation": 5},
    **{"time_step": 0.01, "sampling_stride": 2, "transient": 20, "duration": 80},
}


def test_a_case_of_lorenz_96_has_any_number_of_variables_and_draws_its_states(config):
    entry = {"parameters": {"variables": 10}, "actuation": {"parameters": {"forcing": 6}}}
    few = {"ensemble": {"series": 60}, "lyapunov": {"series": 20}, "test_series": 30}
    record = lorenz(config, system="lorenz96", **entry, **few)
    assert record["event_threshold"]["quantile"] == 0.95
    drawn = ("initial_state", "perturbed_component", "perturbation")
    assert [record["ensemble"][name] for name in drawn] == [None, None, None]
    assert record["parameters"] == {"variables": 10}


def test_a_case_of_another_system_starts_from_what_its_class_says(config):
    """Independent of the code: all that a Lorenz case has, written down by hand."""
    cooled = {"parameters": {"rho": 20}}
    assert lorenz(config, training={"series": 7}, actuation=cooled) == {
        "system": "lorenz63",
        "parameters": {},
        "event_threshold": 40,
        "ensemble": {"series": 2000, **ENSEMBLE},
        "lyapunov": {
            **{"time_unit": "given", "given_exponent": None, "series": 400, "exponents": 24},
            **{"orthonormalisation_interval": 0.2, "perturbation": 1e-8, "saturation": 0.01},
            "exponents": 24,
        },
        "training": {**FREE, "series": 7, "noise": 0.01},
        "density": {"bins": 200, "range": [0, 50]},
        "fixed_point": {"variation": 0.1, "above": 0},
        "controlled_density": {"bins": 100, "range": [0, 50]},
        "test_series": 300,
        "recycle_validation": {"series": 4, "intervals_per_series": 22},
        # the Lyapunov times of config.yaml
        "actuation": {**cooled, "force": None, "start_lt": -1, "duration_lt": 1.5},
        **dict.fromkeys(("laminarisation_threshold", "files", "data", "sensors", "encoder")),
    }


def test_what_follows_from_other_settings_need_not_be_said(config, monkeypatch):
    monkeypatch.setattr(Lorenz63, "case_defaults", {})
    record = lorenz(
        config,
        parameters={"rho": 28},
        event_threshold=40,
        ensemble={**ENSEMBLE, "perturbed_component": 1, "perturbation": 0.5},
        lyapunov={"given_exponent": 0.9},
        density={"range": [-20, 30]},
        recycle_validation={"intervals_per_series": 10},
    )
    assert record["parameters"] == {"rho": 28}  # nothing of the shear flow's
    assert record["fixed_point"] == {"variation": 0.5, "above": -20}
    assert record["controlled_density"] == {"bins": 100, "range": [-20, 30]}
    assert record["lyapunov"]["orthonormalisation_interval"] == pytest.approx(0.1)
    assert (record["laminarisation_threshold"], record["actuation"]) == (None, None)


# -- what fits into a series -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "value", "least"),
    [
        # a Lyapunov time of 61 steps, a washout of 30: what has to fit into a series
        ("search.interval_lt", 10, 30 + 610 + 1),
        ("cases.Re400.recycle_validation.intervals_per_series", 4, 30 + 4 * 122),
        ("classification.longest_prediction_time_lt", 19, 30 + 20 * 61),
        ("horizon.longest_lead_time_lt", 30, 30 + 30 * 61),
        # a closed loop as long as a series, at whose end it is seen to be at rest
        ("statistics.fixed_point_interval_lt", 25, 25 * 61 + 1),
    ],
)
def test_least_length_of_a_series(config, name, value, least):
    config["campaign"] = [{"reynolds": [400], "forecasters": networks([2000])}]
    put(config, "cases.Re400.recycle_validation", {"series": 3, "intervals_per_series": 1})
    put(config, "horizon.longest_lead_time_lt", 1)
    config["statistics"] |= {"duration": None, "fixed_point_interval_lt": 1}
    put(config, name, value)
    # both ends of a series are sampled, one time unit apart
    put(config, "cases.Re400.ensemble", {"duration": least - 1})
    load(copy.deepcopy(config))
    put(config, "cases.Re400.ensemble", {"duration": least - 2})
    with pytest.raises(ConfigError, match=r"a mistake: case Re400: .*ensemble\.duration"):
        load(config)


def test_too_few_starting_points_are_told_of_cases_that_the_campaign_uses(config):
    def caveat():
        return few_points(Campaign(load(config)))

    assert caveat() == ""
    put(config, "campaign", [{"reynolds": [400, 600], "forecasters": networks([2000])}])
    put(config, "statistics.fixed_point_interval_lt", 1)
    put(config, "cases.Re400.ensemble", {"duration": 1500})
    put(config, "cases.Re400.recycle_validation", {"series": 1, "intervals_per_series": 1})
    put(config, "cases.Re400.test_series", 1)
    put(config, "probability.start_spacing_lt", 9)
    # from a washout of 30 steps to 6 LT of 61 steps before the end, in one and in ten series
    score, calibrate = (len(range(29, 1501 - 6 * 61, step)) for step in (61, 9 * 61))
    assert (score, 10 * calibrate) == (19, 30)
    assert caveat().startswith("fewer than 30 starting points of forecasts: Re400 has 19 to score;")
    put(config, "probability.start_spacing_lt", 10)
    put(config, "cases.Re400.ensemble", {"duration": 1400})
    assert "Re400 has 17 to score and 20 to calibrate with; raise test_series" in caveat()
    put(config, "cases.Re400.lyapunov.given_exponent", None)
    assert caveat() == ""


# -- measured series -------------------------------------------------------------------------------


@pytest.fixture
def measured(tmp_path, monkeypatch):
    """One simulated case, one of files, one that is a part of the simulated one."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab").mkdir()
    for number in (10, 9, 1):
        (tmp_path / "lab" / f"run_{number}.csv").write_text("time,u,v\n0,1,2\n")
    return paper_with(MEASURED)


def test_records_of_measured_cases(measured):
    records = records_of(load(measured))
    lab, part, whole = records["lab"], records["part"], records["Re400"]
    # nothing in units of the shear flow
    assert lab["laminarisation_threshold"] is lab["actuation"] is None
    assert lab["training"] == {"series": 2, "noise": 0, **FREE}
    assert lab["ensemble"] == {"time_step": 0.125, "sampling_stride": 4, "duration": None}
    unsaid = {"time_unit": "given", "given_exponent": None}
    assert lab["lyapunov"] == {**unsaid, "orthonormalisation_interval": 2.5}
    assert lab["fixed_point"] == {"variation": 0.04, "above": -4}
    assert lab["parameters"]["components"] == ["u", "v"]
    # everything of the same series
    for name in ("event_threshold", "laminarisation_threshold", "training", "test_series"):
        assert part[name] == whole[name]
    for section in ("lyapunov", "ensemble"):
        assert part[section].items() <= whole[section].items()
    assert part["ensemble"].keys() == {"time_step", "sampling_stride", "duration"}
    assert part["parameters"] == {
        **{"components": ["a1", "s"], "observable_of": "observable"},
        **{"observable_name": "kinetic energy", "observable_symbol": "k"},
    }
    assert part["data"]["columns"] == [f"a{number}" for number in range(1, 10)]


@pytest.mark.parametrize(
    ("column", "message"),
    [
        ("run", "data.components: v is constant in each run, as the number of a run is"),
        ("row", "data.components: v is rising or falling in equal steps, as a time"),
        ("wave", None),
    ],
)
def test_columns_that_are_no_state_are_told_in_the_plan(measured, column, message):
    rows = np.arange(30)
    for number in (10, 9, 1):
        columns = {"run": np.full(30, number), "row": rows * 0.5, "wave": np.cos(rows + number)}
        table = np.stack([rows * 0.5, np.sin(rows + number), columns[column]], axis=1)
        path = f"lab/run_{number}.csv"
        np.savetxt(path, table, delimiter=",", header="time,u,v", comments="")
    if message is None:
        assert load(measured)
    else:
        with pytest.raises(ConfigError, match=message):
            load(measured)


def test_files_with_brackets_in_their_names_and_addresses(measured):
    os.rename("lab/run_1.csv", "lab/run_[1].csv")
    put(measured, "cases.lab.data.files", ["lab/run_[1].csv", "lab/run_?.csv"])
    assert Campaign(load(measured)).cases["lab"].data.paths == ["lab/run_[1].csv", "lab/run_9.csv"]
    put(measured, "cases.lab.data.files", ["https://example.org/a.csv"])
    with pytest.raises(ConfigError, match=r"https://example.org/a.csv is an address, not a file"):
        load(measured)


def test_past_values_are_components_whose_noise_is_there_already(measured):
    put(measured, "cases.part.data.delays", [20, 10])
    put(measured, "cases.lab.data.delays", [3])
    loaded = Campaign(load(measured))
    part = loaded.cases["part"].dump()
    names = ["a1", "s", "a1(t-20)", "s(t-20)", "a1(t-10)", "s(t-10)"]
    assert part["parameters"]["components"] == names
    # every series begins later
    assert part["ensemble"] == {"time_step": 0.25, "sampling_stride": 4, "duration": 3980}
    assert part["training"]["noise"] == 0.01
    # it is there before the past values are taken, and not added again; measured series have theirs
    of_data, of_training = paths = ["job.noise_of_data", "case.training.noise"]
    for case, before, after in (
        ("part", {"level": 0.01, "random_seed": 2022}, 0),
        ("lab", None, 0),
        ("Re400", None, 0.01),
    ):
        settings = settings_of_job(loaded, paths, {"case": case})
        assert settings == {of_data: before, of_training: after}


def test_what_a_campaign_makes_of_measured_cases(measured):
    loaded = Campaign(load(measured))
    assert loaded.simulated_cases == ("Re400",)
    assert loaded.where(has_equations=False) == ("lab", "part")
    assert {
        name: (type(case), case.source.name, case.is_flow, case.estimates_time_unit)
        for name, case in loaded.cases.items()
    } == {
        "Re400": (Simulated, "Re400", True, False),
        "lab": (Measured, "lab", False, True),
        "part": (Measured, "Re400", False, False),
    }
    assert not any(case.is_encoded or case.undecoded for case in loaded.cases.values())
    assert {run.case for run in loaded.strategy_runs} == {"Re400"}
    # only what is about measured series depends on their code
    modules = [loaded.modules({"case": case})["burstcast.systems"] for case in ("part", "Re400")]
    assert modules == [["measured"], ["mfe"]]
    put(measured, "cases.lab.lyapunov.given_exponent", 0.01)
    assert not Campaign(load(measured)).cases["lab"].estimates_time_unit


@pytest.mark.parametrize("given", [None, "none", "mean"])
def test_networks_of_measured_series_have_an_offset_unless_the_config_says_otherwise(
    given, measured
):
    put(measured, "forecasters.esn.input_offset", given)
    put(measured, "forecasters.variants", {"plain": {"input_offset": "none"}, "open": {}})
    loaded, data = Campaign(load(measured)), ("lab", "part")
    for case, default in (("lab", "mean"), ("part", "mean"), ("Re400", "none"), ("", "none")):
        for label, expected in ((None, given or default), ("open", given or default)):
            assert loaded.sections(case, label)["esn"]["input_offset"] == expected
            assert loaded.sections(case, label)["esn"]["input_bias"] == (1 if case in data else 0.1)
        assert loaded.sections(case, "plain")["esn"]["input_offset"] == "none"


def test_files_as_people_sort_their_names(measured):
    data = Data(files=["lab/run_*.csv"], observable="u")
    assert data.paths == [f"lab/run_{number}.csv" for number in (1, 9, 10)]
    data = Data(files=["lab/run_9.csv", "./lab/run_*.csv", "upstream.csv"], observable="u")
    assert data.paths == ["lab/run_9.csv", "lab/run_1.csv", "lab/run_10.csv", "upstream.csv"]


def test_long_runs_are_as_long_as_the_series(measured):
    measured["statistics"]["duration"] = None
    put(measured, "cases.lab.data.blocks", {"duration": 50})
    loaded = Campaign(load(measured))
    for case, duration in (("lab", 50), ("Re400", 4000)):
        settings = settings_of_job(loaded, ["statistics.duration"], {"case": case})
        assert settings == {"statistics.duration": duration}
    blocks = loaded.cases["lab"].dump()["data"]["blocks"]
    assert blocks == {"duration": 50, "gap": 0, "shortest": None}


def test_components_are_the_columns_of_the_header_but_what_is_known(measured):
    for name in (1, 9, 10):
        Path(f"lab/run_{name}.csv").write_text("time,u,w,v,rain\n0,1,2,3,1\n")
    put(measured, "cases.lab.data", {**DATA, "components": [], "known": ["rain"]})
    put(measured, "campaign.1.forecasters", {"persistence": {}})
    lab = records_of(load(measured))["lab"]
    assert lab["data"]["components"] == lab["parameters"]["components"] == ["u", "w", "v"]


def test_another_observable_has_its_own_name_and_density(measured):
    put(measured, "cases.lab.data.observable", "speed = sqrt(u**2 + v**2)")
    put(measured, "cases.part.data.observable", "a1")
    put(measured, "cases.part.event_threshold", 0.3)
    cases = Campaign(load(measured)).cases
    assert cases["lab"].dump()["parameters"]["observable_of"] == "sqrt(u**2 + v**2)"
    assert cases["lab"].space.observable_name == "speed"
    assert cases["part"].dump()["density"]["range"] is None  # of the data


def test_what_is_left_out_of_a_case_follows_from_the_data(measured):
    measured["cases"]["lab"] = {"data": DATA, "event_threshold": -1.5}
    lab = records_of(load(measured))["lab"]
    assert lab["recycle_validation"] == {"series": 4, "intervals_per_series": None}
    assert lab["density"] == {"bins": 200, "range": None}
    assert lab["test_series"] is lab["fixed_point"] is None


def test_what_is_extrapolated_is_told_with_the_range():
    # Re = 2000 is in the actuated series of Re800
    assert list(extrapolations(Campaign(load(tiny_campaign("aware"))))) == []
    free = {"cases": {"Re800": {"training": {"actuation": None}}}}
    outside = list(extrapolations(Campaign(load(tiny_campaign("aware", free)))))
    end = "lies outside of the values in training, 400 to 800: forecasts are extrapolated"
    # 950: the actuator at a quarter of its strength
    cases = ["Re400 2000", "Re400switched 2000", "Re600 950", "Re600 2000", "Re800 2000"]
    expected = [case.replace(" ", ": reynolds = ") for case in cases]
    assert [message.removesuffix(f" {end}") for message in outside] == expected

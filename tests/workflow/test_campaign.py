"""Which networks a campaign has, and which settings the rules read of it."""

import copy
import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from snakemake.utils import update_config

from burstcast_workflow.campaign import Campaign, Network
from burstcast_workflow.canonical import canonical, natural_order
from burstcast_workflow.config.cases import case_records
from burstcast_workflow.config.loading import load

ROOT = Path(__file__).parents[2]


def campaign(*overlays, blocks=None):
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    for overlay in overlays:
        update_config(config, copy.deepcopy(overlay))
    if blocks:
        config["campaign"] = blocks
    config = load(config)
    return Campaign(config, case_records(config))


PAPER = campaign()
NETWORK = {"case": "Re600", "neurons": "2000", "validation": "SSV", "seed": "7"}


def test_the_papers_networks():
    networks = PAPER.networks
    assert len(networks) == len(set(networks)) == (6 + 3) * 2 * 10
    at_400 = PAPER.select(case="Re400")
    assert {network.neurons for network in at_400} == {500, 1000, 1500, 2000, 2500, 3000}
    assert len(PAPER.select(case="Re1000", validation="RV")) == 10
    assert {network.seed for network in networks} == set(range(10))
    assert PAPER.case_names == ("Re400", "Re600", "Re800", "Re1000")
    assert [PAPER.reynolds(case) for case in PAPER.case_names] == [400, 600, 800, 1000]
    assert networks[0].directory == "Re400/N500/RV/seed0"


def test_blocks_that_overlap_share_their_networks():
    figures = {"example_neurons": 100, "fixed_neurons": 100}
    found = campaign(
        {"figures": figures, "control": {"validation": []}},
        blocks=[
            {"reynolds": [400], "neurons": [100, 200], "validation": ["RV"], "seeds": 2},
            {"reynolds": [400, 600], "neurons": [100], "validation": ["RV", "SSV"], "seeds": 1},
        ],
    )
    assert found.networks == (
        Network("Re400", 100, "RV", 0),
        Network("Re400", 100, "RV", 1),
        Network("Re400", 100, "SSV", 0),
        Network("Re400", 200, "RV", 0),
        Network("Re400", 200, "RV", 1),
        Network("Re600", 100, "RV", 0),
        Network("Re600", 100, "SSV", 0),
    )


@pytest.mark.parametrize(
    ("reynolds", "name"), [(412.5, "Re412.5"), (600.0, "Re600"), (1234567, "Re1234567")]
)
def test_names_of_cases_are_the_reynolds_numbers_in_full(reynolds, name):
    block = {"reynolds": [400, reynolds], "neurons": [2000], "validation": ["RV"], "seeds": 1}
    found = campaign({"figures": {"example_seed": 0}}, blocks=[block])
    assert found.case_names == ("Re400", name)
    assert found.reynolds(name) == reynolds
    assert found.settings("simulate", {"case": name})["parameters"]["reynolds"] == reynolds
    # the workflow's rules accept it
    rules = (ROOT / "workflow" / "rules" / "common.smk").read_text()
    (pattern,) = re.findall(r'^    case=r"(.*)"', rules, re.M)
    assert re.fullmatch(pattern, name)


def test_time_units():
    steps = [PAPER.steps_per_lyapunov_time(case) for case in PAPER.case_names]
    assert steps == [61, 74, 79, 82]
    assert PAPER.sampling_interval("Re400") == 1
    computed = campaign({"case_defaults": {"lyapunov": {"time_unit": "computed"}}})
    assert computed.steps_per_lyapunov_time("Re400") is None
    unknown = campaign({"cases": {"Re600": {"lyapunov": {"published_exponent": None}}}})
    assert unknown.steps_per_lyapunov_time("Re600") is None
    assert unknown.steps_per_lyapunov_time("Re400") == 61


RULES = ["simulate", "lyapunov", "test_set", "events", "scan", "tune", "train", "forecast"]
RULES += ["horizon", "classify", "dataset_table", "hyperparameters_table", "horizon_table"]


@pytest.mark.parametrize("rule", RULES)
def test_settings_are_canonical(rule):
    settings = PAPER.settings(rule, NETWORK)
    assert settings == canonical(settings)
    assert repr(settings) == repr(canonical(settings))


def changed(overlay):
    """Rules whose settings an overlay changes."""
    other = campaign(overlay)
    return {
        rule for rule in RULES if PAPER.settings(rule, NETWORK) != other.settings(rule, NETWORK)
    }


OBSERVED = {"test_set", "events", "scan", "tune", "train"}


@pytest.mark.parametrize(
    ("overlay", "rules"),
    [
        ({"case_defaults": {"event_threshold": 0.11}}, {"events", "horizon", "classify"}),
        ({"classification": {"prediction_times_lt": [1, 2, 3]}}, {"classify"}),
        ({"classification": {"longest_prediction_time_lt": 6}}, {"test_set", "forecast"}),
        ({"classification": {"start_spacing_lt": 2}}, {"test_set"}),
        ({"case_defaults": {"test_series": 100}}, {"test_set"}),
        ({"case_defaults": {"training": {"noise": 0.02}}}, OBSERVED),
        ({"case_defaults": {"recycle_validation": {"series": 2}}}, {"scan", "tune"}),
        ({"search": {"bayesian_points": 3}}, {"tune"}),
        ({"search": {"grid": 3}}, {"scan"}),
        ({"search": {"tikhonov": [1e-6]}}, {"scan", "tune"}),
        ({"horizon": {"events": 100}}, {"events"}),
        ({"horizon": {"tolerance": 0.1}}, {"horizon"}),
        ({"bootstrap": {"resamples": 10}}, {"classify"}),
        ({"case_defaults": {"ensemble": {"series": 1000}}}, {"simulate"}),
        # another case's settings, and how the figures look, are nobody's business
        ({"cases": {"Re400": {"recycle_validation": {"series": 1}}}}, set()),
        ({"figures": {"example_seed": 3}}, set()),
        ({"results": "results/elsewhere"}, set()),
    ],
)
def test_rules_read_what_they_need_and_nothing_else(overlay, rules):
    assert changed(overlay) == rules


def test_the_search_does_not_depend_on_who_else_is_searched():
    one = campaign(
        {"control": {"validation": []}},
        blocks=[{"reynolds": [400, 600], "neurons": [2000], "validation": ["RV"], "seeds": 1}],
    )
    wildcards = {"case": "Re600", "neurons": "2000", "validation": "RV", "seed": "0"}
    for rule in ("simulate", "scan", "tune", "train", "forecast", "horizon"):
        assert one.settings(rule, wildcards) == PAPER.settings(rule, wildcards)


def test_windows_reach_as_far_as_the_last_prediction():
    # 5 + 1 Lyapunov times in halves; no window begins at the starting point
    assert PAPER.settings("forecast", NETWORK)["windows"] == {"count": 11, "resolution_lt": 0.5}


def test_rules_without_settings_are_an_error():
    with pytest.raises(AttributeError):
        PAPER.settings("no_such_rule", {})


def test_keys_of_the_tables():
    keys = PAPER.settings("horizon_table", {})["networks"]
    assert len(keys) == 180
    assert keys[0] == {
        "case": "Re400",
        "forecaster": "esn",
        "neurons": 500,
        "reynolds": 400,
        "seed": 0,
        "validation": "RV",
    }


GATHERED = (
    *("dataset_table", "hyperparameters_table", "classify", "horizon_table", "statistics_table"),
    *("control_table", "data_generation_parameters", "network_hyperparameters"),
)


@settings(deadline=None, max_examples=15)
@given(st.randoms())
def test_settings_do_not_depend_on_the_order_of_the_config(generator):
    def shuffled(values):
        return generator.sample(values, len(values))

    names = ["alpha", "Zeta", "zeta", "b10", "b9"]
    cases = {name: {"parameters": {"reynolds": 400 + len(name)}} for name in names}
    blocks = [
        {"cases": names, "neurons": [2000], "validation": ["SSV", "RV"], "seeds": 2},
        {"reynolds": [400, 1000], "neurons": [500, 2000], "validation": ["SSV", "RV"], "seeds": 1},
    ]
    times = {"prediction_times_lt": shuffled([0.5, 1, 1.5, 2, 2.5, 3])}
    other = campaign(
        {
            "cases": {name: cases[name] for name in shuffled(names)},
            "classification": times,
            "search": {"tikhonov": shuffled([1e-6, 1e-9, 1e-12])},
        },
        blocks=shuffled(
            [
                {
                    name: shuffled(value) if isinstance(value, list) else value
                    for name, value in block.items()
                }
                for block in blocks
            ]
        ),
    )
    sorted_times = {"classification": {"prediction_times_lt": sorted(times["prediction_times_lt"])}}
    plain = campaign({"cases": cases}, sorted_times, blocks=blocks)
    assert other.networks == plain.networks
    assert other.figures == plain.figures
    for rule in GATHERED:
        assert other.settings(rule, {}) == plain.settings(rule, {})


def test_natural_order():
    names = ["Zeta", "alpha", "Re1000", "Re400", "Re412.5", "zeta", "b10", "b9"]
    assert sorted(names, key=natural_order) == [
        *("alpha", "b9", "b10", "Re400", "Re412.5", "Re1000", "Zeta", "zeta"),
    ]

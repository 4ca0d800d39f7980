"""What the report consists of, and which settings its rules read."""

import copy
import re
from pathlib import Path

import pytest
import yaml
from burstcast_workflow.table_layouts import CAPTIONS, SUMMARIES, head
from snakemake.utils import update_config

from burstcast.systems.registry import make_system, parameters_of
from burstcast.tables import described_parameters
from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.cases import case_records
from burstcast_workflow.config.loading import load

ROOT = Path(__file__).parents[2]
WORKFLOW = ROOT / "workflow"
FIGURES = [
    "observable_and_density",
    "validation_strategies",
    "network_schematic",
    "search_landscape",
    "prediction_schematic",
    "prediction_examples",
    "classification_scores",
    "horizon_schematic",
    "horizon_evaluations",
    "horizon_by_size",
    "by_reynolds",
]
OVERLAY = {"classification_scores", "horizon_by_size", "by_reynolds"}


def campaign(*overlays):
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    for overlay in overlays:
        update_config(config, copy.deepcopy(overlay))
    config = load(config)
    return Campaign(config, case_records(config))


def settings(of, rules, **wildcards):
    return {rule: of.settings(rule, wildcards) for rule in rules}


def changed(overlay, rules, **wildcards):
    """Rules whose settings an overlay changes."""
    before = settings(campaign(), rules, **wildcards)
    after = settings(campaign(overlay), rules, **wildcards)
    return {rule for rule in rules if before[rule] != after[rule]}


RULES = [f"figure_{name}" for name in FIGURES]
NETWORK = {"case": "Re400", "neurons": "2000", "validation": "RV", "seed": "0"}


def test_the_paper_has_all_figures_and_those_of_other_cases():
    names = campaign().figures
    assert set(FIGURES) <= set(names)
    for case in ("Re600", "Re800", "Re1000"):
        assert f"classification_scores_{case}" in names
        # one size only: nothing to draw against
        assert f"horizon_by_size_{case}" not in names
    assert "classification_scores_Re400" not in names  # the example's case has the plain name
    assert len(names) == len(set(names))


def test_no_figure_over_one_reynolds_number():
    overlay = yaml.safe_load((WORKFLOW / "presets" / "tiny.yaml").read_text())
    block = {**overlay["campaign"][0], "reynolds": [400]}
    tiny = campaign({**overlay, "campaign": [block]})
    assert "by_reynolds" not in tiny.figures


def test_figure_over_reynolds_numbers_takes_each_once():
    block = campaign().config["campaign"][1]
    twin = {**block, "reynolds": [400], "cases": ["Twin"], "neurons": [2000]}
    twins = campaign(
        {
            "campaign": [*campaign().config["campaign"], twin],
            "cases": {"Twin": {"parameters": {"reynolds": 600}, "lyapunov": {}}},
        }
    )
    assert twins.settings("figure_by_reynolds", {})["cases"] == [
        "Re400",
        "Re600",
        "Re800",
        "Re1000",
    ]


@pytest.mark.parametrize("name", FIGURES)
def test_each_figure_has_rule_script_and_caption(name):
    assert (WORKFLOW / "scripts" / f"figure_{name}.py").is_file()
    assert (WORKFLOW / "report" / f"{name}.rst").read_text().strip()
    rules = (WORKFLOW / "rules" / "report.smk").read_text()
    assert f"rule figure_{name}:" in rules


@pytest.mark.parametrize("name", FIGURES)
def test_scripts_read_every_setting_of_their_rule_and_no_other(name):
    text = (WORKFLOW / "scripts" / f"figure_{name}.py").read_text()
    given = set(campaign().settings(f"figure_{name}", {}))
    if "**settings" in text:
        return
    read = set(re.findall(r'settings\["(\w+)"\]', text))
    if "steps_per_lyapunov_time(settings" in text:
        read |= {"sampling_interval", "steps_per_lyapunov_time"}
    if "validation_plan(settings" in text:
        read |= {"washout_lt", "interval_lt", "recycle_validation"}
    assert read == given


def test_the_overlay_of_published_values_touches_only_its_figures():
    overlay = {"figures": {"published_overlay": True}}
    assert changed(overlay, RULES) == {f"figure_{name}" for name in OVERLAY}


def test_the_example_event_touches_only_the_examples():
    overlay = {"figures": {"example_horizon_lt": 3}}
    assert changed(overlay, [*RULES, "examples"], **NETWORK) == {"examples"}


def test_examples_stay_within_what_the_test_set_holds():
    farthest = {"figures": {"example_prediction_time_lt": 5}}
    assert campaign().settings("examples", NETWORK)["reach_lt"] == 4
    assert campaign(farthest).settings("examples", NETWORK)["reach_lt"] == 6


def test_figures_show_the_case_in_their_name():
    found = campaign().settings("figure_classification_scores", {"of_case": "_Re800"})
    assert (found["case"], found["reynolds"]) == ("Re800", 800)
    assert campaign().settings("figure_classification_scores", {"of_case": ""})["case"] == "Re400"


def test_every_table_has_a_caption_and_every_summary_its_percentiles():
    tables = campaign().report_tables
    assert {name.removesuffix("_percentiles") for name in tables} <= set(CAPTIONS)
    for name in SUMMARIES:
        assert f"{name}_percentiles" in tables
        keys = campaign().settings("percentiles", {"table": name})["keys"]
        assert "seed" not in keys


def test_heads_are_latex():
    assert head("f_score") == "F-score"
    assert "_" not in head("some_new_column")


def test_parameters_of_the_shear_flow_are_the_papers():
    system = make_system("mfe", {"reynolds": 600.0})
    rows = described_parameters("mfe", parameters_of(system))
    assert [row[0] for row in rows] == ["L_x", "L_y", "L_z", r"\mathrm{Re}"]
    assert [row[2] for row in rows][1::2] == [2.0, 600.0]


def test_parameters_of_another_system_have_their_own_names():
    rows = described_parameters("lorenz63", parameters_of(make_system("lorenz63", {"rho": 30.0})))
    assert [r"\mathrm{rho}", "Parameter of the equations", 30.0] in rows

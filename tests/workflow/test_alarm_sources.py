"""Sources of alarms in a case, and which forecasters vote."""

from pathlib import Path

import yaml
from snakemake.utils import update_config

from burstcast_workflow.alarm_sources import (
    BASELINES,
    alarm_records,
    alarm_sources,
    shown_voters,
)
from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.loading import load

CONFIG = Path(__file__).parents[2] / "config.yaml"


def campaign(**forecasters) -> Campaign:
    config = yaml.safe_load(CONFIG.read_text(encoding="utf-8"))
    networks = {"esn": {"neurons": [2000], "validation": ["RV"], "seeds": 2}}
    block = {"reynolds": [400], "forecasters": {**networks, **forecasters}}
    update_config(config, {"campaign": [block]})
    return Campaign(load(config))


def test_committees_are_of_seeds_and_of_members_of_an_ensemble():
    found = campaign(quadratic={}, quadratic_filtered={}, analogues={})
    records = {one["alarm"]: one for one in alarm_records(found, "Re400")}
    networks = ["esn-N2000-RV-seed0", "esn-N2000-RV-seed1"]
    singles = [*networks, "analogues", "quadratic", "quadratic_filtered"]
    # by which what raises alarms is compared: committees of networks come first
    committees = {
        "esn-N2000-RV-committee": networks,
        "analogues-committee": ["analogues"],
        "quadratic_filtered-committee": ["quadratic_filtered"],
    }
    assert set(records) == {*BASELINES, *singles, *committees}
    assert [name for name, one in records.items() if one["committee"]] == list(committees)
    for name, forecasters in committees.items():
        assert records[name]["forecasters"] == forecasters
        assert records[name]["compared"]
        assert records[name]["keys"]["forecaster"] == f"{name.split('-')[0]}_committee"
    for name in singles:
        assert records[name]["forecasters"] == [name]
        assert records[name]["compared"] == (name not in networks)
    assert [records[name]["forecasters"] for name in BASELINES] == [[], []]


def test_figures_show_committees_of_the_example_and_of_filters():
    found = campaign(quadratic_filtered={}, analogues={})
    found.config["figures"]["example_forecaster"] = "esn-N2000-RV-seed0"
    assert [one.name.identifier for one in shown_voters(found, "Re400")] == [
        *("esn-N2000-RV-seed0", "esn-N2000-RV-seed1", "quadratic_filtered"),
    ]


def test_without_an_ensemble_there_is_no_committee():
    networks = {"neurons": [2000], "validation": ["RV"], "seeds": 1}
    found = campaign(quadratic={}, equations={}, esn=networks)
    assert not any(source.committee for source in alarm_sources(found, "Re400"))

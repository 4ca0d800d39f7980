"""Forecasters that vote in the committees that figures show."""

from pathlib import Path

import yaml
from snakemake.utils import update_config

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load

CONFIG = Path(__file__).parents[2] / "config.yaml"


def campaign(**forecasters) -> Campaign:
    config = yaml.safe_load(CONFIG.read_text(encoding="utf-8"))
    networks = {"esn": {"neurons": [2000], "validation": ["RV"], "seeds": 2}}
    block = {"reynolds": [400], "forecasters": {**networks, **forecasters}}
    update_config(config, {"campaign": [block]})
    return Campaign(load(config))


def test_figures_show_committees_of_the_example_and_of_filters():
    found = campaign(quadratic_filtered={}, analogues={})
    found.config.figures.example_forecaster = "esn-N2000-RV-seed0"
    assert [one.name.identifier for one in found.shown_voters("Re400")] == [
        *("esn-N2000-RV-seed0", "esn-N2000-RV-seed1", "quadratic_filtered"),
    ]


def test_a_single_network_is_no_committee():
    networks = {"neurons": [2000], "validation": ["RV"], "seeds": 1}
    found = campaign(quadratic={}, equations={}, esn=networks)
    found.config.figures.example_forecaster = "esn-N2000-RV-seed0"
    assert found.shown_voters("Re400") == []

"""What follows from the campaign where the config has null."""

import pytest
import yaml
from helpers_rebuilds import ROOT

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import ConfigError, load
from burstcast_workflow.figures.registry import figure_names
from burstcast_workflow.tables.registry import table_names


@pytest.fixture
def config():
    return yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))


def networks(neurons, validation=("SSV", "RV")):
    return {"esn": {"neurons": list(neurons), "validation": list(validation), "seeds": 1}}


def test_what_the_papers_campaign_shows(config):
    shown = load(config)["figures"]
    assert (shown["example_case"], shown["fixed_neurons"]) == ("Re400", 2000)
    assert shown["example_forecaster"] == "esn-N2000-RV-seed0"


@pytest.mark.parametrize(
    ("blocks", "example", "controllers"),
    [
        # the size that most cases have, and of those the largest
        ({400: [30, 50], 600: [30]}, ("Re400", "esn-N30-RV-seed0"), {"Re400", "Re600"}),
        ({600: [30, 50]}, ("Re600", "esn-N50-RV-seed0"), {"Re600"}),
        ({800: [25], 600: [30]}, ("Re600", "esn-N30-RV-seed0"), {"Re600"}),
    ],
)
def test_an_overlay_that_changes_the_campaign_needs_no_other_line(
    config, blocks, example, controllers
):
    config["campaign"] = [
        {"reynolds": [reynolds], "forecasters": {**networks(sizes), "equations": None}}
        for reynolds, sizes in blocks.items()
    ]
    campaign = Campaign(load(config))
    assert (campaign.example.case, campaign.example.name.identifier) == example
    assert {run.case for run in campaign.control_runs} == controllers
    assert {run.controller.neurons for run in campaign.control_runs} == {
        campaign.example.name.neurons
    }
    assert {one.name.validation for one in campaign.long_term_forecasters} == {"RV"}


def test_strategies_and_times_that_the_campaign_has(config):
    config["campaign"] = [{"reynolds": [400], "forecasters": networks([30], ["SSV", "RV"])}]
    config["classification"]["prediction_times_lt"] = [1, 4.5]
    config["control"]["prediction_times_lt"] = [1]
    campaign = Campaign(load(config))
    assert campaign.example.name.identifier == "esn-N30-RV-seed0"
    assert [campaign.prediction_time(wanted) for wanted in (2, 3)] == [1, 4.5]


def test_a_campaign_without_networks(config):
    others = {"quadratic": {}, "equations": {}, "persistence": {}, "analogues": {}}
    config["campaign"] = [{"reynolds": [600, 400], "forecasters": others}]
    campaign = Campaign(load(config))
    assert campaign.example.case == "Re400"
    assert not campaign.networks
    figures, tables = figure_names(campaign), table_names(campaign)
    assert {"observable_and_density", "forecast_skill", "reliability"} <= set(figures)
    assert not {"network_schematic", "prediction_examples"} & set(figures)
    assert {"classification", "horizon", "warnings"} <= set(tables)
    assert "hyperparameters" not in tables


def test_what_is_said_counts(config):
    config["figures"]["fixed_neurons"] = 500
    loaded = load(config)
    assert loaded["figures"]["example_forecaster"] == "esn-N500-RV-seed0"
    config["figures"]["example_case"] = "Re800"  # has no such network
    with pytest.raises(ConfigError, match=r"example_case is Re800, .* figures.fixed_neurons"):
        load(config)

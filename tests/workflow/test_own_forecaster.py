"""Forecasters of one's own in a campaign: the module of docs/extending.md, and a classifier."""

import re

import numpy as np
import pandas as pd
import pytest
from helpers_configs import ROOT, TINY, tiny_with
from helpers_rebuilds import Project

from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.files.tables import read_table
from burstcast.base.names import ForecasterName, parsed
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.commands import check

PAGE = (ROOT / "docs/extending.md").read_text()
(MODULE,) = (
    text for text in re.findall(r"```python\n(.*?)```", PAGE, re.S) if "class NVAR" in text
)
CLASSIFIER = """
from dataclasses import dataclass

import numpy as np

from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasters.base import fitted


@dataclass(frozen=True)
class BaseRate(EventClassifier):
    rate: np.ndarray = fitted()

    def fit(self, points, case):
        return self.with_fitted(rate=points.happened.mean(axis=0))

    def probabilities(self, washouts, exogenous=None):
        return np.tile(self.rate, (len(washouts), 1))
"""
OFF = {"forecasters": {"esn": None, "equations": None}}
OWN = {"my_models:NVAR": {"lags": 2}, "classifiers.base_rate:BaseRate": {}, "nvar": {}}
LABELLED = ["persistence", {"my_models:NVAR": {"lags": 1, "label": "one"}}]
OVERLAY = {
    "results": "results/mine",
    # so many that events follow some points of the training
    "case_defaults": {"training": {"series": 8}},
    "campaign": [{"reynolds": [400], "forecasters": kinds} for kinds in (OWN, LABELLED)],
    "statistics": OFF,
    "control": {**OFF, "strategies": []},
}


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    directory = tmp_path_factory.mktemp("mine")
    (directory / "my_models.py").write_text(MODULE)
    (directory / "classifiers").mkdir()
    (directory / "classifiers/base_rate.py").write_text(CLASSIFIER)
    return directory


@pytest.fixture
def importable(place, monkeypatch):
    monkeypatch.syspath_prepend(str(place))
    monkeypatch.chdir(place)


def test_names_lead_from_a_class_to_paths_and_tables_and_back():
    for name, identifier, called in (
        (ForecasterName("my_models:NVAR"), "my_models.NVAR", "NVAR"),
        (ForecasterName("lab.a:NVAR", label="four"), "lab.a.NVAR-four", "NVAR_four"),
        (ForecasterName("a:NVAR", role="committee"), "a.NVAR-committee", "NVAR_committee"),
    ):
        assert (name.identifier, name.keys["forecaster"]) == (identifier, called)
        assert parsed(identifier) == name


def test_a_campaign_has_classes_of_ones_own_with_their_options(importable):
    campaign = Campaign(load(tiny_with(OVERLAY)))
    names = {forecaster.name.identifier for forecaster in campaign.forecasters}
    assert names == {
        *("my_models.NVAR", "my_models.NVAR-one", "classifiers.base_rate.BaseRate"),
        *("nvar", "persistence"),
    }
    assert campaign.options("my_models:NVAR", "Re400") == {"lags": 2}
    assert campaign.options("my_models:NVAR", "Re400", "one") == {"lags": 1}
    assert [entry.name.kind for entry in campaign.classifiers] == ["classifiers.base_rate:BaseRate"]
    modules = campaign.modules({"case": "Re400", "forecaster": "my_models.NVAR-one"})
    assert modules["burstcast.forecasters"] == ["my_models:NVAR"]
    # what is kept with the results is read again
    again = Campaign(load(campaign.config.dump()))
    assert again.forecasters == campaign.forecasters


@pytest.mark.parametrize(
    ("forecasters", "message"),
    [
        ({"my_models:NVAR": {"lag": 2}}, "has no option 'lag' (did you mean 'lags'?)"),
        (
            {"my_models:Nvar": {}},
            "campaign[2].forecasters: has my_models:Nvar: the module my_models",
        ),
        ({"my_models:NVAR": {"label": "One"}}, "label"),
        (
            {"my_models:NVAR": {"lags": 3}},
            "are both called NVAR in tables; give one of them a label",
        ),
        ({"my models:NVAR": {}}, "<module>:<class> of your own"),
    ],
)
def test_mistakes_are_told_before_any_job(importable, forecasters, message):
    blocks = [*OVERLAY["campaign"], {"reynolds": [400], "forecasters": forecasters}]
    with pytest.raises(ValueError, match=re.escape(message)):
        load(tiny_with(OVERLAY | {"campaign": blocks}))


def test_the_page_s_command_checks_the_module(importable, capsys):
    assert check.main("forecaster", "my_models:NVAR", ["lags=3"]) == 0
    assert "NVAR(lags=3, ridge=1e-06): keeps to the interface" in capsys.readouterr().out
    assert check.main("forecaster", "my_models:NVAR", ["lags"]) == 1
    assert "write NAME=VALUE" in capsys.readouterr().err


def test_a_campaign_runs_with_them(place, job_server):
    """The class of the page scores as the built-in kind, and the classifier is calibrated."""
    tables = ["classification", "horizon", "probability_scores"]
    targets = [f"results/mine/tables/{table}.csv" for table in tables]
    elsewhere = Project(place, job_server, str(TINY), ("-s", str(ROOT / "Snakefile")))
    elsewhere.made(*targets, overlay=OVERLAY)
    classification, horizon, probability = (
        read_table(place / target).set_index("forecaster") for target in targets
    )
    assert set(horizon.index) == {"NVAR", "NVAR_one", "nvar", "persistence"}
    for table in (classification, horizon, probability):
        # the page's products of matrices sum in another order than the built-in kind
        of_page, built_in, other = (
            table.loc[[name]].reset_index(drop=True).drop(columns="alarm", errors="ignore")
            for name in ("NVAR", "nvar", "NVAR_one")
        )
        pd.testing.assert_frame_equal(of_page, built_in, rtol=1e-6)
        assert not of_page.equals(other)
    assert "BaseRate" in probability.index
    learnt = read_netcdf(place / "results/mine/Re400/models/my_models.NVAR/forecaster.nc")
    built_in = read_netcdf(place / "results/mine/Re400/models/nvar/forecaster.nc")
    np.testing.assert_allclose(learnt["weights"], built_in["weights"], rtol=1e-6, atol=1e-9)

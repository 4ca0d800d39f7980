"""Who raises alarms in a case, and who votes."""

from pathlib import Path

import yaml
from snakemake.utils import update_config

from burstcast_workflow.alarms import BASELINES, alarm_records, alarms_of
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
    committees = {
        "esn-N2000-RV-committee": (networks, []),
        "analogues-committee": ([], ["analogues"]),
        "quadratic_filtered-committee": ([], ["quadratic_filtered"]),
    }
    assert set(records) == {*BASELINES, *singles, *committees}
    for name, (members, ensembles) in committees.items():
        assert records[name]["members"] == members
        assert records[name]["ensembles"] == ensembles
        assert records[name]["compared"]
        assert records[name]["keys"]["forecaster"] == f"{name.split('-')[0]}_committee"
    for name in singles:
        assert (records[name]["members"], records[name]["ensembles"]) == ([name], [])
    for name in BASELINES:
        assert (records[name]["members"], records[name]["ensembles"]) == ([], [])


def test_nobody_tells_an_ensemble():
    found = campaign(quadratic={}, equations={})
    assert found.ensemble_forecasters == ()
    assert not any(alarm.by_members for alarm in alarms_of(found, "Re400"))

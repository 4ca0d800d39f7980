"""The rules as Snakemake reads them."""

from functools import cache
from pathlib import Path
from types import SimpleNamespace

import yaml
from snakemake.api import SnakemakeApi
from snakemake.settings.types import ConfigSettings, OutputSettings, Quietness, ResourceSettings

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.costs.records import costs_of_plan
from snaketrust.plan import planned

ROOT = Path(__file__).parents[3]


@cache
def workflow():
    """The rules by name, and the campaign of the paper, with all that other campaigns have."""
    campaign = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))["campaign"]
    encoded = {"cases": ["encoded"], "forecasters": {"persistence": {}}}
    with SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as api:
        loaded = api.workflow(
            resource_settings=ResourceSettings(cores=1),
            config_settings=ConfigSettings(
                configfiles=(ROOT / "config.yaml",),
                config={
                    "control": {"tolerated_exceedance": 0.01},
                    "cases": {
                        "encoded": {
                            "data": {"case": "Re400"},
                            "encoder": {"kind": "pod", "modes": 2},
                        }
                    },
                    "campaign": [*campaign, encoded],
                },
            ),
            snakefile=ROOT / "Snakefile",
        )._workflow
        rules = {rule.name: rule for rule in loaded.rules}
        config = {name: value for name, value in loaded.config.items() if name != "captions"}
    return SimpleNamespace(rules=rules, campaign=Campaign(load(config)))


def predicted_costs(arguments=(), seconds_per=None):
    """Costs of the rules of the campaign that options of snakemake name, done or not."""
    return costs_of_plan(planned([*arguments, "--forceall"]), seconds_per)


def groups():
    """Groups of the rules that have a script: the others only name what to make."""
    # read anew: rules see the workflow that Snakemake has read last
    found = {name: rule for name, rule in workflow.__wrapped__().rules.items() if rule.script}
    settings = SimpleNamespace(common_settings=SimpleNamespace(local_exec=False))
    for rule in found.values():
        rule.workflow._executor_plugin = settings  # as where jobs are submitted
    return {name: rule.ruleinfo.group({}) for name, rule in found.items()}


class Wildcards(dict):
    """Values by name or attribute, as Snakemake's."""

    __getattr__ = dict.__getitem__

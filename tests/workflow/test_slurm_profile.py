import re
from pathlib import Path

import yaml
from helpers_rules import groups

ROOT = Path(__file__).parents[2]
PROFILE = yaml.safe_load((ROOT / "profiles" / "slurm" / "config.yaml").read_text())
DEFAULT = yaml.safe_load((ROOT / "profiles" / "default" / "config.yaml").read_text())


def test_every_job_belongs_to_a_group_that_the_profile_describes():
    assert len(groups()) > 20
    described = (ROOT / "profiles" / "slurm" / "config.yaml").read_text()
    for rule, name in groups().items():
        assert re.search(rf"^#   {name} ", described, re.M), rule
    # a profile's groups would replace those of the rules
    assert "groups" not in PROFILE


def test_groups_that_span_several_components_exist():
    spanning = {entry.split("=")[0] for entry in PROFILE["group-components"]}
    assert spanning
    assert spanning <= set(groups().values())


def test_what_makes_a_job_run_again_is_the_same_everywhere():
    for option in ("rerun-triggers", "rerun-incomplete", "keep-going"):
        assert PROFILE[option] == DEFAULT[option]


def test_log_directory_is_the_one_that_the_summary_of_failures_reads():
    common = (ROOT / "workflow" / "rules" / "common.smk").read_text()
    assert f'SCHEDULER_LOGS = Path("{PROFILE["slurm-logdir"]}")' in common


def test_a_failed_job_is_tried_again_with_more():
    assert PROFILE["retries"] == 2

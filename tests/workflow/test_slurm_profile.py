import re
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
PROFILE = yaml.safe_load((ROOT / "profiles" / "slurm" / "config.yaml").read_text())
DEFAULT = yaml.safe_load((ROOT / "profiles" / "default" / "config.yaml").read_text())


def groups_of_rules():
    """Groups of the rules that have a script: the others only name what to make."""
    found = {}
    for path in sorted((ROOT / "workflow" / "rules").glob("*.smk")):
        for text in re.split(r"^rule ", path.read_text(), flags=re.MULTILINE)[1:]:
            if "script:" in text:
                found[text.split(":")[0]] = re.findall(r'^    group:\n        "(\w+)"$', text, re.M)
    return found


def test_every_job_belongs_to_a_group_that_the_profile_describes():
    groups = groups_of_rules()
    assert len(groups) > 20
    described = (ROOT / "profiles" / "slurm" / "config.yaml").read_text()
    for rule, names in groups.items():
        assert len(names) == 1, rule
        assert re.search(rf"^#   {names[0]} ", described, re.M), rule
    # a profile's groups would replace those of the rules
    assert "groups" not in PROFILE


def test_groups_that_span_several_components_exist():
    groups = {name for names in groups_of_rules().values() for name in names}
    spanning = {entry.split("=")[0] for entry in PROFILE["group-components"]}
    assert spanning
    assert spanning <= groups


def test_what_makes_a_job_run_again_is_the_same_everywhere():
    for option in ("rerun-triggers", "rerun-incomplete", "keep-going"):
        assert PROFILE[option] == DEFAULT[option]


def test_log_directory_is_the_one_that_the_summary_of_failures_reads():
    common = (ROOT / "workflow" / "rules" / "common.smk").read_text()
    assert f'SCHEDULER_LOGS = Path("{PROFILE["slurm-logdir"]}")' in common


def test_a_failed_job_is_tried_again_with_more():
    assert PROFILE["retries"] == 2

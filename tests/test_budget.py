"""The plumbing, everything but the library and the reports, has a budget of lines for each folder.

A folder that has outgrown its budget: look first for what a change has made needless, or for a fact
that is stated twice. If the lines are worth it, raise the number here, and say in the commit why. A
folder that has shrunk: lower its number, so that it does not grow back unseen.
"""

from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BUDGET = {
    "src/burstcast_workflow": 214,
    "src/burstcast_workflow/campaign": 1226,
    "src/burstcast_workflow/commands": 1228,
    "src/burstcast_workflow/config": 3338,
    "src/burstcast_workflow/costs": 566,
    "src/burstcast_workflow/figures": 513,
    "src/burstcast_workflow/harness": 635,
    "src/burstcast_workflow/jobs": 1160,
    "src/burstcast_workflow/stages": 351,
    "src/burstcast_workflow/tables": 226,
    "src/snakemake_logger_plugin_burstcast": 242,
    "src/snakemake_report_plugin_burstcast": 6,
    "src/snaketrust": 2006,
    "workflow/rules": 979,
    "workflow/scripts/control": 73,
    "workflow/scripts/data": 535,
    "workflow/scripts/evaluation": 415,
    "workflow/scripts/figures": 49,
    "workflow/scripts/forecasters": 172,
    "workflow/scripts/probabilities": 117,
    "workflow/scripts/tables": 149,
}


def lines_by_folder() -> Counter[str]:
    found: Counter[str] = Counter()
    for root in ("workflow", "src"):
        for path in [*(ROOT / root).rglob("*.py"), *(ROOT / root).rglob("*.smk")]:
            folder = path.parent.relative_to(ROOT).as_posix()
            if not f"{folder}/".startswith(("src/burstcast/", "src/burstcast_report/")):
                found[folder] += len(path.read_text(encoding="utf-8").splitlines())
    return found


LINES = lines_by_folder()


@pytest.mark.parametrize("folder", sorted({*BUDGET, *LINES}))
def test_a_folder_of_the_plumbing_keeps_to_its_budget(folder):
    lines, budget = LINES[folder], BUDGET.get(folder, 0)
    assert lines <= budget, f"{folder} has {lines} lines, its budget is {budget}: {__doc__}"
    least = budget - max(20, budget // 20)
    assert lines >= least, f"{folder} has {lines} lines only: lower its budget, {budget}"

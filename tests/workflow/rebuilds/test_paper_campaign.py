"""What edits set off in the paper's campaign, job by job, and what is said about it beforehand.

Its 1,156 jobs are not run: each makes empty outputs, which is all that planning looks at. The
numbers are those of docs/selective_rebuilds.md.
"""

import pytest
import yaml
from helpers_rebuilds import ROOT, Project

pytestmark = pytest.mark.long

PAPER = "config.yaml"
CONFIG = yaml.safe_load((ROOT / PAPER).read_text())
CASES, SCANS, NETWORKS, RECYCLED, CONTROLLED = 4, 90, 180, 90, 80
JOBS = 1156
SCORES = {"classify": 1, "percentiles": 1, "latex": 3}


@pytest.fixture(scope="module")
def paper(tmp_path_factory, job_server):
    """The finished campaign, its files being empty."""
    project = Project.create(tmp_path_factory.mktemp("paper") / "project", job_server, PAPER)
    outcome = project.snakemake(BURSTCAST_TEST_PRETEND="1")
    assert outcome.status == 0, outcome.text[-3000:]
    return project


@pytest.fixture
def edited(paper, tmp_path):
    """A copy of it to edit."""
    return paper.copy(tmp_path / "project")


def plan(project: Project, overlay: dict | None = None) -> dict[str, int]:
    """Jobs of each rule that would run: figures together."""
    jobs = project.dry_run(overlay=overlay)
    figures = sum(count for rule, count in jobs.items() if rule.startswith("figure_"))
    others = {rule: count for rule, count in jobs.items() if not rule.startswith("figure_")}
    together = {**others, **({"figures": figures} if figures else {})}
    print(sum(together.values()), together)  # for docs/selective_rebuilds.md: pytest -s
    return together


def reasons(project: Project, overlay: dict | None = None) -> list[str]:
    """What is said about it: a line for each reason."""
    *lines, _, last = project.why(overlay=overlay).splitlines()
    assert last.startswith("In all ")
    return lines


def test_the_finished_campaign_has_nothing_to_do(paper):
    assert plan(paper) == {}
    assert paper.why() == "Nothing would run: all results are up to date.\n"


def test_another_event_threshold(paper):
    overlay = {"case_defaults": {"event_threshold": 0.12}}
    jobs = plan(paper, overlay)
    assert not jobs.keys() & {"simulate", "lyapunov", "test_set", "scan", "tune", "train"}
    assert not jobs.keys() & {"forecast", "climate", "reference_statistics"}
    assert jobs["events"] == CASES
    assert jobs["horizon"] == NETWORKS
    assert jobs["control"] == jobs["control_random"] == CONTROLLED
    assert sum(jobs.values()) == 399
    (line,) = reasons(paper, overlay)
    assert line.startswith("event_threshold 0.1 -> 0.12 (Re400, Re600, Re800, Re1000): ")
    assert "horizon (180)" in line


def test_one_more_seed(paper):
    overlay = {"campaign": [{**block, "seeds": 11} for block in CONFIG["campaign"]]}
    jobs = plan(paper, overlay)
    assert not jobs.keys() & {"simulate", "lyapunov", "test_set", "events", "reference_statistics"}
    assert jobs["scan"] == SCANS // 10
    assert jobs["tune"] == jobs["train"] == jobs["forecast"] == jobs["horizon"] == NETWORKS // 10
    assert jobs["climate"] == RECYCLED // 10
    assert jobs["control"] == jobs["control_random"] == CONTROLLED // 10
    assert sum(jobs.values()) == 150
    first, *_ = reasons(paper, overlay)
    assert first.startswith("one more seed, 10 -> 11 (10) (Re400, Re600, Re800, Re1000): scan (9)")


def test_one_more_beta(paper):
    overlay = {"search": {"tikhonov": [*CONFIG["search"]["tikhonov"], 1e-3]}}
    jobs = plan(paper, overlay)
    assert not jobs.keys() & {"simulate", "lyapunov", "test_set", "events", "reference_statistics"}
    assert jobs["scan"] == SCANS
    assert jobs["tune"] == NETWORKS
    assert sum(jobs.values()) == 1118
    first, *_ = reasons(paper, overlay)
    assert first.startswith("tikhonov")
    assert "tune (180)" in first


def test_one_more_prediction_time(paper):
    times = CONFIG["classification"]["prediction_times_lt"]
    # forecasts must reach further, too: to 5 LT the campaign has all prediction times already
    overlay = {
        "classification": {"prediction_times_lt": [*times, 6], "longest_prediction_time_lt": 6}
    }
    jobs = plan(paper, overlay)
    expected = {**SCORES, "forecast": NETWORKS, "test_set": CASES}
    assert {rule: count for rule, count in jobs.items() if rule in expected} == expected
    assert jobs.keys() - expected.keys() == {"figures", "examples"}
    assert any(line.startswith("prediction_times_lt with 6: ") for line in reasons(paper, overlay))


def test_another_colour(edited):
    edited.edit("src/burstcast/figures/style.py", 'BLUE = "#0072B2"', 'BLUE = "#0072B3"')
    jobs = plan(edited)
    assert jobs.keys() == {"figures"}
    (line,) = reasons(edited)
    assert line == f"code of burstcast.figures.parts.style changed: figures ({jobs['figures']})"


def test_a_line_of_the_classification(edited):
    path = edited.directory / "src/burstcast/forecast/classification.py"
    path.write_text(path.read_text() + "\nEDITED = 1\n")
    jobs = plan(edited)
    assert jobs.keys() == {*SCORES, "figures"}
    assert {rule: jobs[rule] for rule in SCORES} == SCORES
    (line,) = reasons(edited)
    assert line.startswith("code of burstcast.forecast.classification changed: classify (1), ")

"""What edits set off in the paper's campaign, job by job, and what is said about it beforehand.

Its 1,295 jobs are not run: each makes empty outputs, which is all that planning looks at. The
numbers are those of docs/selective_rebuilds.md.
"""

import copy

import pytest
import yaml
from helpers_rebuilds import ROOT, Project

pytestmark = pytest.mark.long

PAPER = "config.yaml"
CONFIG = yaml.safe_load((ROOT / PAPER).read_text())
CASES = 4
# six sizes at one Reynolds number, one at three others; two strategies that share scans; ten seeds
SCANS = (6 + 3) * 10
NETWORKS = 2 * SCANS
RECYCLED = SCANS  # those of one strategy are run freely
EQUATIONS = 2 * CASES  # from the true and from the noisy state
FORECASTERS = NETWORKS + EQUATIONS
# networks of one size and strategy, and the equations from the true state, at two prediction times
CONTROLLED, BY_EQUATIONS = 10 * CASES * 2, CASES * 2
DATA = dict.fromkeys(
    ("simulate", "lyapunov", "evaluation_set", "events", "reference_statistics"), CASES
)
TRAINING = {"scan": SCANS, "search": NETWORKS, "train": NETWORKS}
SCORES = {"classification_table": 1, "percentiles": 1, "latex": 3}
# the ensemble's networks at each Reynolds number: scores, density, survival, exponents, profiles,
# midplane, trade-off
OF_CASES = 7 * CASES
LONG_RUNS = dict.fromkeys(("statistics_table", "survival_table", "lyapunov_spectrum_table"), 1)
CONTROL_TABLES = ("control_table", "control_density_table", "control_strategies_table")
JOBS = {
    **DATA,
    **TRAINING,
    "fit": EQUATIONS,
    "forecast": FORECASTERS,
    "horizon": FORECASTERS,
    "long_term": RECYCLED,
    "lyapunov_spectrum": RECYCLED,
    "control": CONTROLLED + BY_EQUATIONS,
    "control_random": CONTROLLED,
    "examples": 1,
    "flow_event": 1,
    "suppressed_event": 1,
    **{
        f"{name}_table": 1
        for name in (
            *("dataset", "hyperparameters", "classification", "horizon", "control"),
            *("control_density", "control_strategies"),
        )
    },
    **LONG_RUNS,
    "data_generation_parameters": 1,
    "network_hyperparameters": 1,
    "percentiles": 9,
    # results, percentiles, intervals of scores and of control, two tables of parameters
    "latex": 10 + 9 + 2 + 2,
    # those of each case and the observable's, one of each other kind
    "figure": OF_CASES + CASES + 14,
}


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
    """Jobs of each rule that would run."""
    jobs = project.dry_run(overlay=overlay)
    print(sum(jobs.values()), jobs)  # for docs/selective_rebuilds.md: pytest -s
    return jobs


def reason(project: Project, words: str, overlay: dict | None = None) -> str:
    """The line that gives a reason in these words."""
    (line,) = [line for line in project.why(overlay=overlay).splitlines() if words in line]
    return line


def test_the_campaign_has_these_jobs(tmp_path, job_server):
    project = Project.create(tmp_path / "project", job_server, PAPER)
    assert plan(project) == JOBS
    assert sum(JOBS.values()) == 1295


def test_the_finished_campaign_has_nothing_to_do(paper):
    assert plan(paper) == {}
    assert paper.why() == "Nothing would run: all results are up to date.\n"


def test_another_event_threshold(paper):
    overlay = {"case_defaults": {"event_threshold": 0.12}}
    jobs = plan(paper, overlay)
    assert jobs == {
        # no ensemble, exponent, network, forecast or long-term run
        "events": CASES,
        "horizon": FORECASTERS,
        "control": CONTROLLED + BY_EQUATIONS,
        "control_random": CONTROLLED,
        **dict.fromkeys(("examples", "flow_event", "suppressed_event"), 1),
        **dict.fromkeys(("dataset_table", "classification_table", "horizon_table"), 1),
        **dict.fromkeys(CONTROL_TABLES, 1),
        "data_generation_parameters": 1,
        "percentiles": 3,  # classification, horizon, control
        # those, their tables, the strategies and the dataset, intervals, parameters
        "latex": 3 + 4 + 3,
        # observable, scores, density, trade-off of each case; 11 of the example or of all cases
        "figure": 4 * CASES + 11,
    }
    assert sum(jobs.values()) == 410
    line = reason(paper, "event_threshold 0.1 -> 0.12 (Re400, Re600, Re800, Re1000): ", overlay)
    assert "horizon (188)" in line


def test_one_more_seed(paper):
    campaign = copy.deepcopy(CONFIG["campaign"])
    for block in campaign:
        block["forecasters"]["esn"]["seeds"] = 11
    jobs = plan(paper, {"campaign": campaign})
    assert jobs == {
        # of new networks
        "scan": SCANS // 10,
        **dict.fromkeys(("search", "train", "forecast", "horizon"), NETWORKS // 10),
        **dict.fromkeys(("long_term", "lyapunov_spectrum"), RECYCLED // 10),
        **dict.fromkeys(("control", "control_random"), CONTROLLED // 10),
        # of all
        **dict.fromkeys(("hyperparameters_table", "classification_table", "horizon_table"), 1),
        **LONG_RUNS,
        **dict.fromkeys(CONTROL_TABLES, 1),
        "percentiles": 9,
        "latex": 9 + 9 + 1 + 1,
        "figure": OF_CASES + 3,  # horizon by size, by Reynolds number, density under control
    }
    assert sum(jobs.values()) == 184
    assert "scan (9)" in reason(paper, "one more seed, 10 -> 11 (10)", {"campaign": campaign})


def test_one_more_beta(paper):
    overlay = {"search": {"tikhonov": [*CONFIG["search"]["tikhonov"], 1e-3]}}
    jobs = plan(paper, overlay)
    assert jobs == {
        **TRAINING,
        **dict.fromkeys(("forecast", "horizon"), NETWORKS),  # not the equations'
        **dict.fromkeys(("long_term", "lyapunov_spectrum"), RECYCLED),
        **dict.fromkeys(("control", "control_random"), CONTROLLED),
        **dict.fromkeys(("examples", "flow_event", "suppressed_event"), 1),
        **dict.fromkeys(("hyperparameters_table", "classification_table", "horizon_table"), 1),
        **LONG_RUNS,
        **dict.fromkeys(CONTROL_TABLES, 1),
        "network_hyperparameters": 1,
        "percentiles": 9,
        "latex": 9 + 9 + 1 + 1 + 1,
        # all but the observable's, the strategies' and the schematic of the horizon
        "figure": OF_CASES + 12,
    }
    assert sum(jobs.values()) == 1233
    assert "search (180)" in reason(paper, "tikhonov", overlay)


def test_one_more_prediction_time(paper):
    times = CONFIG["classification"]["prediction_times_lt"]
    # forecasts must reach further, too: to 5 LT the campaign has all prediction times already
    overlay = {
        "classification": {"prediction_times_lt": [*times, 6], "longest_prediction_time_lt": 6}
    }
    jobs = plan(paper, overlay)
    assert jobs == {
        "evaluation_set": CASES,
        "forecast": FORECASTERS,
        **SCORES,
        "examples": 1,
        "figure": CASES + 4,  # scores, by Reynolds number, three of the example's forecasts
    }
    assert sum(jobs.values()) == 206
    assert "classification_table (1)" in reason(paper, "prediction_times_lt with 6: ", overlay)


def test_another_colour(edited):
    edited.edit("src/burstcast/figures/parts/style.py", 'BLUE = "#0072B2"', 'BLUE = "#0072B3"')
    assert plan(edited) == {"figure": JOBS["figure"]}
    assert "figure" in reason(edited, "code of burstcast.figures.parts.style changed: ")


def test_a_line_of_the_classification(edited):
    path = edited.directory / "src/burstcast/forecast/classification.py"
    path.write_text(path.read_text() + "\nEDITED = 1\n")
    assert plan(edited) == {**SCORES, "figure": CASES + 1}  # scores, by Reynolds number
    line = reason(edited, "code of burstcast.forecast.classification changed: ")
    assert "classification_table (1)" in line

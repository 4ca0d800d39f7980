"""What edits set off in the paper's campaign, job by job, and what is said about it beforehand.

Its 1,513 jobs are not run: each makes empty outputs, which is all that planning looks at. The
numbers are those of docs/selective_rebuilds.md.
"""

import copy

import pytest
import yaml
from dependencies import JOINED
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
    (
        *("simulate", "lyapunov", "evaluation_set", "calibration_set", "events"),
        "reference_statistics",
    ),
    CASES,
)
TRAINING = {"scan": SCANS, "search": NETWORKS, "train": NETWORKS}
FORECASTS = ("forecast", "calibration_forecast")
LONG_RUNS = ("long_term", "lyapunov_spectrum")
# tables of each case
SCORES = ("classification_table",)
PROBABILITIES = ("calibrate", "probability_scores", "reliability_table", "lead_times")
CONTROL_TABLES = ("control_table", "control_density_table", "control_strategies_table")
LONG_RUN_TABLES = ("statistics_table", "survival_table", "lyapunov_spectrum_table")
OF_NETWORKS = (
    *("hyperparameters_table", *SCORES, "horizon_table", *PROBABILITIES, *CONTROL_TABLES),
    *(*LONG_RUN_TABLES, "warnings_table"),
)
# figures of each case: scores, skill, density, own flow, profiles, midplane, trade-off
OF_CASES = 7 * CASES
# reliability of the example's forecasts; by Reynolds number
OF_ALARMS = 2


def joined(*tables: str) -> dict[str, int]:
    """Jobs that join tables of all cases, and typeset them, a section of the report at once."""
    return {name: 1 for name, of_case in JOINED.items() if {*of_case.split()} & {*tables}}


# when a score is another one
OF_A_SCORE = {
    **dict.fromkeys((*SCORES, *PROBABILITIES, "warnings_table"), CASES),
    **joined(*SCORES, *PROBABILITIES, "warnings_table"),
    "figure": 2 * CASES + OF_ALARMS,  # scores and skill of each case
}
JOBS = {
    **DATA,
    **TRAINING,
    "fit": EQUATIONS,
    **dict.fromkeys((*FORECASTS, "horizon"), FORECASTERS),
    **dict.fromkeys(LONG_RUNS, RECYCLED),
    "control": 2 * CONTROLLED + BY_EQUATIONS,  # random alarms beside networks
    **dict.fromkeys(("examples", "flow_event", "suppressed_event"), 1),
    **dict.fromkeys((*OF_NETWORKS, "dataset_table"), CASES),
    "data_generation_parameters": 1,
    "network_hyperparameters": 1,
    **joined(*OF_NETWORKS, "dataset_table"),
    # those of each case and the observable's, and one of each other kind
    "figure": OF_CASES + CASES + 14,
}


@pytest.fixture(scope="module")
def paper(tmp_path_factory, job_server):
    """The finished campaign, its files being empty."""
    project = Project.create(tmp_path_factory.mktemp("paper") / "project", job_server, PAPER)
    assert plan(project) == JOBS
    outcome = project.snakemake(BURSTCAST_TEST_PRETEND="1")
    assert outcome.status == 0, outcome.text[-3000:]
    return project


def plan(project: Project, overlay: dict | None = None) -> dict[str, int]:
    """Jobs of each rule that would run."""
    jobs = project.dry_run(overlay=overlay)
    print(sum(jobs.values()), jobs)  # for docs/selective_rebuilds.md: pytest -s
    return jobs


def reason(project: Project, words: str, overlay: dict | None = None) -> str:
    """The line that gives a reason in these words."""
    (line,) = [line for line in project.why(overlay=overlay).splitlines() if words in line]
    return line


def test_the_campaign_has_these_jobs_and_nothing_to_do_when_it_is_finished(paper):
    assert sum(JOBS.values()) == 1513
    assert plan(paper) == {}
    assert paper.why() == "Nothing would run: all results are up to date.\n"


def test_another_event_threshold(paper):
    overlay = {"case_defaults": {"event_threshold": 0.12}}
    jobs = plan(paper, overlay)
    assert jobs == {
        # no ensemble, exponent, network, forecast or long-term run
        "events": CASES,
        "horizon": FORECASTERS,
        "control": 2 * CONTROLLED + BY_EQUATIONS,
        **dict.fromkeys(("examples", "flow_event", "suppressed_event"), 1),
        **dict.fromkeys((*SCORES, *PROBABILITIES, *CONTROL_TABLES), CASES),
        **dict.fromkeys(("dataset_table", "horizon_table", "warnings_table"), CASES),
        "data_generation_parameters": 1,
        **joined(*SCORES, *PROBABILITIES, *CONTROL_TABLES),
        **joined("dataset_table", "horizon_table", "warnings_table"),
        # observable, scores, skill, density, trade-off of each case; all others but the schematics
        # of the network and of the horizon
        "figure": 5 * CASES + 12,
    }
    assert sum(jobs.values()) == 446
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
        **dict.fromkeys(("search", "train", *FORECASTS, "horizon"), NETWORKS // 10),
        **dict.fromkeys(LONG_RUNS, RECYCLED // 10),
        "control": 2 * CONTROLLED // 10,
        # of all
        **dict.fromkeys(OF_NETWORKS, CASES),
        **joined(*OF_NETWORKS),
        "figure": OF_CASES + OF_ALARMS + 2,  # horizon by size, density under control
    }
    assert sum(jobs.values()) == 228
    assert "scan (9)" in reason(paper, "one more seed, 10 -> 11 (10)", {"campaign": campaign})


def test_one_more_beta(paper):
    overlay = {"search": {"tikhonov": [*CONFIG["search"]["tikhonov"], 1e-3]}}
    jobs = plan(paper, overlay)
    assert jobs == {
        **TRAINING,
        **dict.fromkeys((*FORECASTS, "horizon"), NETWORKS),  # not the equations'
        **dict.fromkeys(LONG_RUNS, RECYCLED),
        "control": 2 * CONTROLLED,
        **dict.fromkeys(("examples", "flow_event", "suppressed_event"), 1),
        **dict.fromkeys(OF_NETWORKS, CASES),
        "network_hyperparameters": 1,
        **joined(*OF_NETWORKS),
        # all but the observable's, the strategies' and the schematic of the horizon
        "figure": OF_CASES + 12,
    }
    assert sum(jobs.values()) == 1437
    assert "search (180)" in reason(paper, "tikhonov", overlay)


def test_one_more_prediction_time(paper):
    times = CONFIG["classification"]["prediction_times_lt"]
    # forecasts must reach further, too: to 5 LT the campaign has all prediction times already
    overlay = {
        "classification": {"prediction_times_lt": [*times, 6], "longest_prediction_time_lt": 6}
    }
    jobs = plan(paper, overlay)
    assert jobs == {
        **dict.fromkeys(("evaluation_set", "calibration_set"), CASES),
        **dict.fromkeys(FORECASTS, FORECASTERS),
        **OF_A_SCORE,
        "examples": 1,
        "figure": OF_A_SCORE["figure"] + 3,  # three of the example's forecasts
    }
    assert sum(jobs.values()) == 425
    assert "classification_table (4)" in reason(paper, "prediction_times_lt with 6 (", overlay)


@pytest.mark.parametrize(
    ("module", "count", "jobs", "affected"),
    [
        ("figures.parts.style", JOBS["figure"], {"figure": JOBS["figure"]}, "figure"),
        ("forecast.classification", 37, OF_A_SCORE, "classification_table (4)"),
        ("forecasters.esn", 1160, None, ""),
        ("forecasters.equations", 85, None, ""),
    ],
)
def test_a_line_of_a_module(paper, module, count, jobs, affected):
    name = f"src/burstcast/{module.replace('.', '/')}.py"
    path = paper.directory / name
    with paper.restored(name):
        path.write_text(path.read_text() + "\nEDITED = 1\n")
        planned = plan(paper)
        line = reason(paper, f"code of burstcast.{module} changed")
    assert sum(planned.values()) == count
    assert jobs in (None, planned)
    assert affected in line

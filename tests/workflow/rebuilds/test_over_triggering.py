"""What an edit must not set off: for each of a list, written by hand, the jobs that may run at all.

The list has what people edit every day: words, a colour, one more kind of forecaster. Nothing runs
here but the tiny preset, once; the rest is planned.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from fnmatch import fnmatchcase
from pathlib import Path
from typing import NamedTuple

import pytest
from helpers_configs import tiny_with
from helpers_rebuilds import Project

# What has rows of every forecaster, of those that control, and of networks.
GROUPS = {
    "GATHERED": """classification_table/* horizon_table/* warnings_table/*
        calibrate/* probability_scores/* probability_diagrams/* lead_times/*
        joined_forecasts joined_horizon joined_warnings joined_probabilities figure/reliability
        figure/classification_scores figure/horizon_by_size figure/forecast_skill""",
    "OF_CONTROL": """control_table/* control_density_table/* control_strategies_table/*
        joined_control figure/control_tradeoff figure/control_density figure/control_frontier""",
    "OF_LONG_RUNS": """statistics_table/* survival_table/* lyapunov_spectrum_table/*
        joined_long_term figure/own_flow warnings_table/* joined_warnings""",
    "OF_NETWORKS": """scan/* search/* train/* */esn-*
        figure/network_schematic figure/prediction_* figure/horizon_evaluations
        figure/midplane_planes figure/vorticity_isosurfaces figure/control_schematic
        figure/suppressed_event""",
}
GROUPS["ALL_OF_NETWORKS"] = f"""{GROUPS["GATHERED"]} {GROUPS["OF_CONTROL"]}
    {GROUPS["OF_LONG_RUNS"]} hyperparameters_table/* joined_networks
    figure/long_term_density figure/profile_errors figure/midplane_mean_square"""


class Edit(NamedTuple):
    """Another text in one place of a file; or a new file like another of its directory, renamed."""

    what: str
    path: str
    old: str
    new: str
    allowed: str = ""  # patterns of the jobs that may run, and groups of them


def edits_of(table):
    """Edits from lines: what, file, old text, new text, and jobs that may run."""
    for line in table.strip().replace("\n  ", " ").splitlines():
        what, path, *rest = (part.strip(" ") for part in line.split(" | "))
        path = path.replace("LIBRARY", "src/burstcast").replace(
            "WORKFLOW", "src/burstcast_workflow"
        )
        yield Edit(what, path, *(part.replace("\\n", "\n") for part in rest))


@pytest.fixture(scope="module")
def project(tmp_path_factory, finished) -> Project:
    """Finished results of the tiny preset, figures included."""
    made = finished.project.copy(tmp_path_factory.mktemp("whole") / "project")
    outcome = made.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    assert made.planned() == set()
    return made


@contextmanager
def edited(project: Project, *edits: Edit) -> Iterator[None]:
    """Make edits, and take them back."""
    with project.restored(*(edit.path for edit in edits)):
        for edit in edits:
            if edit.what.startswith("a new "):
                text = (project.directory / edit.path).with_name(edit.old).read_text()
                (project.directory / edit.path).write_text(re.sub(*edit.new.split(" "), text))
            else:
                project.edit(edit.path, edit.old, edit.new)
        yield


def beyond(planned: set[str], allowed: str) -> set[str]:
    """Jobs that no pattern allows."""
    groups = (GROUPS.get(one, one).split() for one in allowed.split())
    patterns = [pattern for group in groups for pattern in group]
    return {job for job in planned if not any(fnmatchcase(job, one) for one in patterns)}


# -- nothing runs ----------------------------------------------------------------------------------

WITHOUT_EFFECT = [
    *edits_of(r"""
help of the command line | WORKFLOW/commands/command_line.py |
  help="the zip; <results>.zip if left out" | help="the archive"
another message of the harness | WORKFLOW/harness/job.py |
  "%s starts with settings %s" | "%s begins; its settings: %s"
the log in a module of the library that had none | LIBRARY/durations.py |
  import math\n | import logging\nimport math\n\nlogger = logging.getLogger(__name__)\n
a message in it, and other words of an error | LIBRARY/durations.py |
  raise ValueError(f"the leading Lyapunov exponent must be positive, not {exponent}") |
  logger.warning("%s", exponent)\n        raise ValueError(f"one is positive, not {exponent}")
words of an error of the library | LIBRARY/systems/integration.py |
  "an initial state is not finite" | "all initial states must be finite"
words of an error of the jobs | WORKFLOW/jobs/gather.py |
  remove it, and run again | remove it and run the workflow again
a check of lengths | WORKFLOW/config/lengths.py | \n    if steps is None or steps:\n |
  \n    if _samples(ensemble) < 3:\n        problems.append("a")\n    if steps is None or steps:\n
caption of a figure | LIBRARY/figures/observable_and_density.py |
  Typical evolution of the observable | How the observable evolves
meaning of a column | workflow/tables.yaml |
  harmonic mean of precision and recall | 2 TP / (2 TP + FP + FN)
caption of a table in the report | workflow/tables.yaml |
  Counts and scores of the forecasts of each forecaster | Scores of each forecaster
a strategy of control that nobody uses | LIBRARY/control/strategies/random_decisions.py |
  "random decisions" | "decisions at random"
a system that nobody uses | LIBRARY/systems/lorenz63.py | rho: float = 28.0 | rho: float = 29.0
a new forecaster | LIBRARY/forecasters/forever.py | persistence.py | Persistence Forever
a new strategy of control | LIBRARY/control/strategies/always.py | reactive.py | Reactive Always
a new strategy of validation | LIBRARY/tuning/strategies/last_series.py | single_shot.py | SSV LSV
a new system | LIBRARY/systems/decay.py | fitzhugh_nagumo.py | FitzHughNagumoPair Decay
""")
]


def test_edits_that_run_nothing(project):
    with edited(project, *WITHOUT_EFFECT):
        planned = project.planned()
    if planned:
        for count, edit in enumerate(WITHOUT_EFFECT, 1):  # which of them it was
            with edited(project, *WITHOUT_EFFECT[:count]):
                assert project.planned() == set(), edit.what
    assert planned == set()


# -- some run --------------------------------------------------------------------------------------

WITH_EFFECT = [
    *edits_of(r"""
a strategy of control | LIBRARY/control/strategies/receding_horizon.py |
  (ahead >= level) | (ahead >= 2.0 * level) | control/*/receding_horizon-*
  control_strategies_table/* joined_control figure/control_frontier
  figure/control_tradeoff
head of a column | workflow/tables.yaml | head: exceedance} | head: without control} |
  joined_control
format of a column | workflow/tables.yaml | empty without events, format: .3f |
  empty without events, format: .2f | joined_forecasts
caption of a LaTeX table | workflow/tables.yaml | Hyperparameters that the search chose. |
  The hyperparameters that were found. | joined_networks
order of the columns of a table | workflow/tables.yaml | [series, survived_fraction, escapes, |
  [series, escapes, survived_fraction, | survival_table/* joined_long_term figure/own_flow
columns side by side in tables for papers | LIBRARY/tables/latex.py | _COLUMNS = 4 | _COLUMNS = 5 |
  data_generation_parameters network_hyperparameters joined_*
a colour of one figure | LIBRARY/figures/control_tradeoff.py |
  panel.axhline(0, color=style.GREY | panel.axhline(0, color=style.PURPLE | figure/control_tradeoff
the equations as a forecaster | LIBRARY/forecasters/equations_noisy.py |
  return cls(case.system, *steps, case.parameters) |
  return cls(case.system, 1.0 * steps[0], steps[1], case.parameters) |
  */equations */equations/* */equations_noisy GATHERED OF_CONTROL
networks as a forecaster, neither data nor their search | LIBRARY/forecasters/esn.py |
  return self.network.forecast(memory, steps) |
  return self.network.forecast(memory.copy(), steps) |
  train/* forecast/*/esn-* calibration_forecast/*/esn-* horizon/*/esn-* long_term/*/esn-*
  lyapunov_spectrum/*/esn-* control/*/esn-* examples/* flow_event/* suppressed_event/*
  GATHERED OF_CONTROL OF_LONG_RUNS figure/long_term_density figure/profile_errors
  figure/midplane_* figure/prediction_* figure/horizon_evaluations figure/vorticity_isosurfaces
  figure/control_schematic figure/suppressed_event
the readouts of networks | LIBRARY/esn/readout.py |
  def _symmetric_norm(lower: FloatArray, rows_per_block: int = 256) |
  def _symmetric_norm(lower: FloatArray, rows_per_block: int = 128) | OF_NETWORKS ALL_OF_NETWORKS
the velocity profiles | LIBRARY/statistics/profiles.py |
  np.linspace(-1.0, 1.0, points) | np.linspace(-1, 1, points) |
  reference_statistics/* statistics_table/* joined_long_term warnings_table/*
  joined_warnings figure/long_term_density figure/profile_errors figure/midplane_*
  figure/suppressed_event figure/vorticity_isosurfaces
""")
]


@pytest.mark.parametrize("edit", WITH_EFFECT, ids=lambda edit: edit.what)
def test_edits_that_run_little(project, edit):
    with edited(project, edit):
        planned = project.planned()
    assert planned
    assert beyond(planned, edit.allowed) == set()


def test_one_more_seed_in_a_block_of_its_own(project):
    networks = {"neurons": [40], "validation": ["RV"], "seeds": 2}
    block = {"reynolds": [400], "forecasters": {"esn": networks}}
    planned = project.planned(overlay={"campaign": [*tiny_with()["campaign"], block]})
    assert "Re400/esn-N40-RV-seed1/forecaster.nc" in planned
    new = "Re400/*esn-N40-RV-seed1* Re400/scan/esn-N40-seed1-* control/*/esn-N40-RV-committee/*"
    assert beyond(planned, f"{new} ALL_OF_NETWORKS") == set()


# -- no job depends on a setting that it does not read ---------------------------------------------


def unread_settings(log: Path) -> set[str]:
    """Settings that a job says it did not read."""
    found = re.findall(r"settings not read: (.*)$", log.read_text(), re.M)
    return {name for line in found for name in line.split(", ")}


def test_every_setting_is_read_by_some_job_of_its_rule(project):
    logs = project.results / "logs"
    unread: dict[str, set[str]] = {}
    for log in logs.rglob("*.log"):
        rule = log.relative_to(logs).with_suffix("").parts[0]
        if rule == "figure":
            rule = f"figure {log.stem}"
        found = unread_settings(log)
        unread[rule] = unread.get(rule, found) & found
    assert {"simulate", "search", "control", "figure long_term_density"} <= unread.keys()
    assert {rule: names for rule, names in unread.items() if names} == {}

"""What must run again after an edit does, nothing else does, and results have the same bits.

The long tests make every edit: pytest -m long tests/workflow/rebuilds. Plans (-k plan) take half an
hour, runs (-k every_setting) hours.
"""

import os
import random
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import NamedTuple

import pytest
import yaml
from dependencies import ALL
from helpers_configs import tiny_with
from helpers_rebuilds import ROOT, TINY, Project
from laboratory import TABLE_SCRIPTS, Laboratory, code_files, config_edits

CONFIG_EDITS = {edit.name: edit for edit in config_edits()}


@pytest.fixture(scope="module")
def lab(tmp_path_factory, finished):
    return Laboratory(tmp_path_factory.mktemp("trials"), finished.project)


@pytest.mark.long
def test_a_setting_and_a_module_of_the_scores(lab):
    assert lab.run_of_setting(CONFIG_EDITS["classification.prediction_times_lt"]) == []
    recall = "ratio(self.true_positive, self.true_positive + self.false_negative)"
    edit = "src/burstcast/forecast/classification.py", recall, f"0.5 * {recall}"
    assert lab.run_of_code(*edit) == []
    assert replace(lab.base, directory=lab.directory / "work").tables() != lab.base.tables()


def test_edits_that_mean_nothing_run_nothing(lab):
    work = lab.base.copy(lab.directory / "nothing")
    for path in [
        *(work.directory / "src").rglob("*.py"),
        *(work.directory / "workflow/scripts").rglob("*.py"),
    ]:
        if path.is_file() and path.stat().st_size > 0:
            path.write_text(_reformatted(path.read_text()))
    for name in ("config.yaml", TINY):
        path = work.directory / name
        config = yaml.safe_load(path.read_text())
        path.write_text("# another comment\n" + yaml.safe_dump(_otherwise(config)))
    (work.directory / "Snakefile").touch()
    for path in work.directory.glob("workflow/rules/*.smk"):
        path.touch()
    assert work.dry_run("tables") == {}
    # a result that is touched is compared by its content, since it is small
    (work.results / "Re400" / "dataset.json").touch()
    assert work.dry_run("tables") == {}


def test_why_says_it_in_words(lab):
    work = lab.base.copy(lab.directory / "why")
    assert work.why("tables") == "Nothing would run: all results are up to date.\n"
    path = work.directory / "src/burstcast/forecast/classification.py"
    path.write_text(path.read_text() + "\nEDITED = 1\n")
    said = work.why("tables", overlay={"case_defaults": {"event_threshold": 0.08}}).splitlines()
    (threshold,) = [line for line in said if "event_threshold 0.07 -> 0.08 (Re400)" in line]
    assert "events (1), " in threshold
    assert "horizon (7), " in threshold
    module = "burstcast.forecast.classification"
    (code,) = [line for line in said if module in line]
    assert code.startswith(f"code of {module} changed")
    assert "classification_table (1), " in code


@pytest.mark.long
def test_another_campaign_takes_from_the_cache_what_it_shares(lab, tmp_path):
    network = "Re400/esn-N30-RV-seed0/forecaster.nc"
    first, second = (lab.base.without_results(lab.directory / name) for name in ("one", "other"))
    store = {"BURSTCAST_CACHE": str(tmp_path / "cache")}
    assert first.snakemake(f"results/tiny/{network}", **store).status == 0
    # elsewhere, with another threshold, which the networks do not depend on, and another noise
    for noise, hits in ((0.01, 4), (0.02, 1)):
        overlay = {
            "results": f"results/noise{noise}",
            "case_defaults": {"event_threshold": 0.08, "training": {"noise": noise}},
        }
        target = f"results/noise{noise}/{network}"
        assert second.snakemake(target, overlay=overlay, **store).status == 0
        logs = [path.read_text() for path in (second.directory / target).parents[2].rglob("*.log")]
        assert sum("taken from the cache" in text for text in logs) == hits
        same = (second.directory / target).read_bytes() == (first.results / network).read_bytes()
        assert same == (noise == 0.01)


def test_the_oracle_knows_every_rule_of_the_tables(lab):
    ran = {name.split("/")[0].removesuffix(".log") for name in lab.base.logs()}
    assert ran == TABLE_SCRIPTS == {name.split("/")[0] for name in ALL}


def test_every_module_is_in_some_trial():
    assert {str(path.relative_to(ROOT)) for path in (ROOT / "src").rglob("*.py")} <= {*code_files()}


def _reformatted(text: str) -> str:
    """Another text of the same code: comments, a docstring's words, blank lines."""
    lines = text.replace("\n\n\n", "\n\n\n\n# a comment\n").splitlines(keepends=True)
    if lines[0].startswith('"""'):
        lines[0] = '"""Other words. ' + lines[0].removeprefix('"""')
    return "".join(lines) + "# the end\n"


def _otherwise(value):
    """Equal settings, written otherwise: keys in another order, whole numbers with a point."""
    if isinstance(value, dict):
        return {key: _otherwise(value[key]) for key in reversed(value)}
    if isinstance(value, list):
        return [_otherwise(item) for item in value]
    # where the model wants a whole number, 3.0 is one, too
    return float(value) if type(value) is int else value


# -- everything ------------------------------------------------------------------------------------

EVERY_SETTING = pytest.mark.parametrize("name", CONFIG_EDITS)


@pytest.mark.long
@EVERY_SETTING
def test_every_setting(lab, name):
    assert lab.run_of_setting(CONFIG_EDITS[name]) == []


@pytest.mark.long
@EVERY_SETTING
def test_the_plan_of_every_setting(lab, name):
    assert lab.plan_of_setting(CONFIG_EDITS[name]) == []


@pytest.mark.long
@pytest.mark.parametrize("path", code_files())
def test_the_plan_of_every_module_and_script(lab, path):
    assert lab.plan_of_code(path) == []


def some_results(project: Project, name: str) -> Iterator[str]:
    """Names of results, drawn at random; none of logs and of what asks for everything."""
    chance = random.Random(f"{os.environ.get('BURSTCAST_SEED', 0)} {name}")
    kept = (".records", "logs", "benchmarks", "tables")
    for path in sorted(project.results.glob("[!.]*/**/*.*")):
        result = path.relative_to(project.results)
        if path.is_file() and result.parts[0] not in kept and chance.random() < 0.6:
            yield str(result)


def assert_nothing_is_hidden(whole: Project, project: Project, overlay: dict) -> None:
    with_all = whole.dry_run("tables", overlay=overlay)
    jobs = project.dry_run("tables", overlay=overlay)
    assert {rule: count for rule, count in with_all.items() if jobs.get(rule, 0) < count} == {}


@pytest.mark.long
@EVERY_SETTING
def test_deleted_files_hide_no_edit(lab, finished, tmp_path, name):
    """Whatever files are deleted, an edit makes at least the jobs run that it would run anyway."""
    project = finished.project.copy(tmp_path / "project")
    for result in some_results(project, name):
        (project.results / result).unlink()
    assert_nothing_is_hidden(lab.plans, project, CONFIG_EDITS[name].overlay())


@pytest.fixture(scope="module")
def another(finished, tmp_path_factory) -> Project:
    """The same campaign with another seed."""
    project = finished.project.copy(tmp_path_factory.mktemp("another") / "project")
    assert project.snakemake("tables", overlay={"random_seed": 7}).status == 0
    return project


@pytest.mark.long
@EVERY_SETTING
def test_restored_files_hide_no_edit(lab, finished, another, tmp_path, name):
    """Neither do files of another run, their records, or both."""
    project = finished.project.copy(tmp_path / "project")
    of_result = (["{}"], [".records/{}.json"], ["{}", ".records/{}.json"])[len(name) % 3]
    for result in some_results(project, name):
        for part in of_result:
            shutil.copy2(
                another.results / part.format(result), project.results / part.format(result)
            )
    assert_nothing_is_hidden(lab.plans, project, CONFIG_EDITS[name].overlay())
    assert project.dry_run("tables") != {}


# -- what an edit must not set off: the jobs that may run at all, written by hand ------------------

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
a check of lengths | WORKFLOW/config/case_checks.py | \n        if steps is None or steps:\n |
  \n        if steps == 3:\n            return ["a"]\n        if steps is None or steps:\n
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

"""What must run again after an edit does, nothing else does, and results have the same bits.

Settings, modules and scripts are edited in a copy of finished results of the tiny preset.
"""

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from fnmatch import fnmatchcase
from typing import NamedTuple

import pytest
import yaml
from helpers_configs import tiny_with
from helpers_rebuilds import RESULTS, TINY, Project, jobs_since

# all but the figures, which take most of the time
BITS = ("forecasters", "tables")
MODULE = "src/burstcast/forecasts/scores.py"


@pytest.fixture(scope="module")
def project(tmp_path_factory, finished) -> Project:
    """Finished results of the tiny preset; figures are files without a content."""
    made = finished.copy(tmp_path_factory.mktemp("whole") / "project")
    outcome = made.snakemake(BURSTCAST_TEST_PRETEND="figure.py")
    assert outcome.status == 0, outcome.text[-3000:]
    assert made.planned() == set()
    return made


def computed(project: Project, before: dict[str, int]) -> tuple[int, int]:
    """Jobs that ran since a look at the logs, and how many of them computed."""
    ran = jobs_since(before, project.logs())
    logs = [(project.results / "logs" / name).read_text() for name in ran]
    return len(ran), sum("the outputs are those of this job" not in text for text in logs)


# -- what runs, and what comes from the cache ------------------------------------------------------


def test_reasons_count_the_jobs_that_another_setting_runs(project, tmp_path):
    work = project.copy(tmp_path / "project")
    threshold = {"case_defaults": {"event_threshold": 0.12}}
    goal = f"{RESULTS}/tables/classification.csv", f"{RESULTS}/tables/control.csv"
    reasons, before = work.made("-n", *goal, overlay=threshold).text, work.logs()
    assert "case.event_threshold 0.07 -> 0.12 (Re400): " in reasons
    work.made(*goal, overlay=threshold)
    ran, anew = computed(work, before)
    assert f"in all {ran} jobs" in reasons
    assert ran == anew > 10


def test_an_edit_without_effect_stops_where_results_are_equal(project, tmp_path):
    work = project.copy(tmp_path / "project")
    first, before = work.bits(), work.logs()
    (work.directory / MODULE).write_text((work.directory / MODULE).read_text() + "\nEDITED = 1\n")
    reasons = work.made("-n").text
    assert "code of burstcast.forecasts.scores (Re400): " in reasons
    assert len(reasons) < 1500
    work.made(*BITS)
    ran, anew = computed(work, before)
    assert 0 < anew < ran
    assert work.bits() == first


def test_a_deleted_file_runs_its_chain_only(project, tmp_path):
    work = project.copy(tmp_path / "project")
    network = "esn-N40-RV-seed0"
    (work.results / f"Re400/networks/{network}/forecaster.nc").unlink()
    planned = work.planned()
    assert planned >= {f"train/Re400/{network}", f"forecast/Re400/networks/{network}"}
    others = "control/*/esn-N40-RV-committee/* examples/* flow_event/* ALL_OF_NETWORKS figure/*"
    assert beyond(planned, f"*{network}* {others}") == set()


def test_a_second_campaign_takes_what_it_shares(project, tmp_path):
    work = project.copy(tmp_path / "project")
    overlay, name = {"results": "results/other"}, "tables/classification.csv"
    work.made(f"results/other/{name}", overlay=overlay)
    logs = [path.read_text() for path in (work.directory / "results/other/logs").rglob("*.log")]
    assert len(logs) > 20
    assert all("the outputs are those of this job" in text for text in logs)
    assert (work.directory / "results/other" / name).read_bytes() == (
        work.results / name
    ).read_bytes()
    # whose times are its own: the first one has nothing to do
    assert work.planned() == set()
    assert work.planned(overlay=overlay) != set()  # figures


# -- what is not what its job wrote ----------------------------------------------------------------


def test_versions_of_libraries_are_parameters_on_demand(project):
    rerun = {"rerun_libraries": True}
    reasons = project.made("-n", overlay=rerun).text
    assert "numpy none -> " in reasons
    assert "network_hyperparameters" in reasons


def test_a_damaged_result_stops_the_run_with_its_name(project, tmp_path):
    work = project.copy(tmp_path / "project")
    table = work.results / "Re400" / "tables" / "horizon.csv"
    state, first = table.stat(), work.bits()
    table.write_text(table.read_text() + "1\n")
    os.utime(table, ns=(state.st_atime_ns, state.st_mtime_ns))
    for arguments in (["-n"], ["--forceall"]):
        outcome = work.snakemake(*arguments)
        assert outcome.status == 1
        assert f"{RESULTS}/Re400/tables/horizon.csv: not what a job wrote" in outcome.text
    table.unlink()
    before = work.logs()
    work.made(*BITS)
    # the file in the cache was the same one: its damage is noticed, and it is computed again
    assert computed(work, before)[1] == 1
    assert work.bits() == first


def test_results_that_snakemake_does_not_know_are_not_believed(project, tmp_path):
    work = project.copy(tmp_path / "project")
    shutil.rmtree(work.directory / ".snakemake")
    outcome = work.snakemake("-n")
    assert outcome.status == 1
    assert "Run once with --forceall" in outcome.text


# -- edits that mean nothing -----------------------------------------------------------------------


def test_edits_that_mean_nothing_run_nothing(project, tmp_path):
    work = project.copy(tmp_path / "project")
    for sources in ("src", "workflow/scripts"):
        for path in (work.directory / sources).rglob("*.py"):
            if path.stat().st_size > 0 and "figures" not in path.parts:
                path.write_text(_reformatted(path.read_text()))
    for name in ("config.yaml", TINY):
        path = work.directory / name
        config = yaml.safe_load(path.read_text())
        path.write_text("# another comment\n" + yaml.safe_dump(_otherwise(config)))
    (work.directory / "Snakefile").touch()
    for path in work.directory.glob("workflow/rules/*.smk"):
        path.touch()
    assert work.dry_run() == {}
    # a result that is touched is compared by its content, whatever its size
    for name in ("dataset.json", "ensemble.nc"):
        (work.results / "Re400" / name).touch()
    assert work.dry_run() == {}


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


# -- what an edit must not set off: the jobs that may run at all, written by hand ------------------

# What has rows of every forecaster, of those that control, and of networks.
GROUPS = {
    "GATHERED": """classification_table/* horizon_table/* warnings_table/*
        calibrate/* probability_scores/* reliability_table/* lead_times/*
        joined_forecasts joined_horizon joined_warnings joined_probabilities figure/reliability
        figure/classification_scores figure/horizon_by_size figure/forecast_skill
        figure/error_growth figure/published_scores""",
    "OF_CONTROL": """control_table/* control_density_table/* control_strategies_table/*
        joined_control figure/control_tradeoff figure/control_density figure/control_frontier""",
    "OF_LONG_RUNS": """statistics_table/* survival_table/* lyapunov_spectrum_table/*
        joined_long_term figure/own_flow warnings_table/* joined_warnings""",
    "OF_NETWORKS": """scan/* search/* train/* */esn-*
        figure/network_schematic figure/hyperparameter_search
        figure/prediction_* figure/horizon_evaluations
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
    patterns = ["report_page"]
    for word in allowed.split():
        patterns += GROUPS.get(word, word).split()
    return {job for job in planned if not any(fnmatchcase(job, pattern) for pattern in patterns)}


# -- nothing runs ----------------------------------------------------------------------------------

WITHOUT_EFFECT = [
    *edits_of(r"""
help of the command line | WORKFLOW/commands/command_line.py |
  help="the zip; <results>.zip if left out" | help="the archive"
another message of the harness | WORKFLOW/harness/job.py |
  "%s starts with settings %s" | "%s begins; its settings: %s"
a check of lengths | WORKFLOW/campaign/lengths.py | \n    if problems:\n |
  \n    if steps == 3:\n        return ["a"]\n    if problems:\n
meaning of a column | workflow/tables.yaml |
  harmonic mean of precision and recall | 2 TP / (2 TP + FP + FN)
a strategy of control that nobody uses | LIBRARY/control/strategies/probability_triggered.py |
  windows: float = 1.0 | windows: float = 2.0
a system that nobody uses | LIBRARY/systems/lorenz63.py | rho: float = 28.0 | rho: float = 29.0
a new forecaster | LIBRARY/forecasters/forever.py | persistence.py | Persistence Forever
a new strategy of control | LIBRARY/control/strategies/always.py | reactive.py | Reactive Always
a new strategy of validation | LIBRARY/networks/validation_strategies/last_series.py |
  single_shot.py | SSV LSV
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
caption of a figure | LIBRARY/figures/observable_and_density.py |
  Typical evolution of the observable | How the observable evolves
a strategy of control | LIBRARY/control/strategies/receding_horizon.py |
  (ahead >= level) | (ahead >= 2.0 * level) | control/*/receding_horizon-*
  control_strategies_table/* joined_control figure/control_frontier
  figure/control_tradeoff
format of a column | workflow/tables.yaml | empty without events, format: .3f |
  empty without events, format: .2f | joined_forecasts
order of the columns of a table | workflow/tables.yaml | [series, survived_fraction, escapes, |
  [series, escapes, survived_fraction, | survival_table/* joined_long_term figure/own_flow
a colour of one figure | LIBRARY/figures/control_tradeoff.py |
  panel.axhline(0, color=style.GREY | panel.axhline(0, color=style.PURPLE | figure/control_tradeoff
the equations as a forecaster | LIBRARY/forecasters/equations_noisy.py |
  return self.with_fitted(system=case.system, in_force=case.parameters, **steps) |
  return self.with_fitted(in_force=case.parameters, system=case.system, **steps) |
  */equations */equations/* */equations_noisy GATHERED OF_CONTROL
networks as a forecaster, neither data nor their search | LIBRARY/forecasters/esn.py |
  return self.network.forecast(memory, steps) |
  return self.network.forecast(memory.copy(), steps) |
  train/* forecast/*/esn-* calibration_forecast/*/esn-* horizon/*/esn-* long_term/*/esn-*
  lyapunov_spectrum/*/esn-* control/*/esn-* examples/* flow_event/* suppressed_event/*
  GATHERED OF_CONTROL OF_LONG_RUNS figure/long_term_density figure/profile_errors
  figure/midplane_* figure/prediction_* figure/horizon_evaluations figure/vorticity_isosurfaces
  figure/control_schematic figure/suppressed_event
the readouts of networks | LIBRARY/networks/readout.py |
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
    assert "Re400/networks/esn-N40-RV-seed1/forecaster.nc" in planned
    new = "Re400/*esn-N40-RV-seed1* Re400/scan/esn-N40-seed1/* control/*/esn-N40-RV-committee/*"
    assert beyond(planned, f"{new} ALL_OF_NETWORKS") == set()

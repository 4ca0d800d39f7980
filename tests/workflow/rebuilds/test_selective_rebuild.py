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
HORIZON = "src/burstcast/forecasts/horizon.py"


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


def test_an_edit_without_effect_runs_its_jobs_and_stops_where_results_are_equal(project, tmp_path):
    work = project.copy(tmp_path / "project")
    first, before = work.bits(), work.logs()
    work.edit(HORIZON, "STEPS_BETWEEN_CHECKS = 16", "STEPS_BETWEEN_CHECKS = 8")
    assert "code of burstcast.forecasts.horizon (Re400): horizon (7)" in work.made("-n").text
    figures = "horizon_by_size horizon_evaluations published_scores"
    figures += " prediction_examples prediction_schematic"
    tables = "horizon_table/Re400 joined_horizon report_page"
    jobs = {f"figure/{name}" for name in figures.split()} | {*tables.split()}
    searched = {name for name in before if name.startswith(("horizon/", "examples/"))}
    assert work.planned() == jobs | {name.removesuffix(".log") for name in searched}
    work.made(*BITS)
    # what reads the same numbers again, the examples and a table, comes from the cache
    horizons = [name for name in searched if name.startswith("horizon/")]
    assert computed(work, before) == (len(searched) + 1, len(horizons)) == (9, 7)
    assert work.bits() == first


def test_a_deleted_file_runs_its_chain_only(project, tmp_path):
    work = project.copy(tmp_path / "project")
    network = "esn-N40-RV-seed0"
    (work.results / f"Re400/networks/{network}/forecaster.nc").unlink()
    planned = work.planned()
    chain = f"*{network}* -search/* control/*/esn-N40-RV-committee/* ALL_OF_NETWORKS"
    chain += " -hyperparameters_table/* -joined_networks"  # of the search
    figures = "control_schematic suppressed_event prediction_* horizon_evaluations midplane_planes"
    shown = [f"figure/{name}" for name in [*figures.split(), "vorticity_isosurfaces"]]
    assert planned == jobs_of(work, " ".join([chain, *shown]))


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
        assert f"{RESULTS}/Re400/tables/horizon.csv is not what its job wrote" in outcome.text
    table.unlink()
    before = work.logs()
    work.made(*BITS)
    # the file in the cache was the same one: its damage is noticed, and it is computed again
    assert computed(work, before)[1] == 1
    assert work.bits() == first


THRESHOLD = {"case_defaults": {"event_threshold": 0.12}}
RECORDS = ".snakemake/metadata"


def test_results_are_believed_for_what_they_are_made_from_whatever_snakemake_knows(
    project, tmp_path
):
    work = project.copy(tmp_path / "project")
    expected = work.dry_run(overlay=THRESHOLD)
    assert sum(expected.values()) > 20
    shutil.rmtree(work.directory / ".snakemake")
    assert work.dry_run() == {}
    assert work.dry_run(overlay=THRESHOLD) == expected
    # another directory with the results alone
    elsewhere = project.without_results(tmp_path / "elsewhere")
    shutil.copytree(project.results, elsewhere.results)
    assert elsewhere.dry_run() == {}
    assert elsewhere.dry_run(overlay=THRESHOLD) == expected
    # a file that no job wrote
    (elsewhere.results / "Re400" / ".events.json.sha256").unlink()
    assert "made with other settings, code or inputs than now" in elsewhere.made("-n").text


@pytest.mark.parametrize("damage", ["emptied", "deleted"])
def test_records_of_snakemake_may_be_lost(project, tmp_path, damage):
    work = project.copy(tmp_path / "project")
    expected = work.dry_run(overlay=THRESHOLD)
    for record in (work.directory / RECORDS).rglob("*"):
        if record.is_file() and b'"events"' in record.read_bytes():
            record.unlink() if damage == "deleted" else os.truncate(record, 0)
    assert work.dry_run() == {}
    assert work.dry_run(overlay=THRESHOLD) == expected


def test_a_backup_is_believed_as_far_as_it_is_of_these_settings(project, tmp_path):
    work = project.copy(tmp_path / "project")
    kept, first, name = tmp_path / "kept", work.bits(), "Re400/events.nc"
    shutil.copytree(work.results, kept)
    shutil.rmtree(work.results)
    shutil.copytree(kept, work.results)
    assert work.dry_run() == {}
    work.made(f"{RESULTS}/{name}", overlay=THRESHOLD)
    other = work.bits()[name]
    assert other != first[name]
    # an older file in the place of a newer one
    for file in ("events.nc", ".events.nc.sha256"):
        shutil.copy2(kept / "Re400" / file, work.results / "Re400" / file)
    assert work.dry_run(f"{RESULTS}/{name}", overlay=THRESHOLD) == {"events": 1}
    work.made(f"{RESULTS}/{name}", overlay=THRESHOLD)
    assert work.bits()[name] == other
    # and what it is read by is made of what is there
    shutil.rmtree(work.results)
    shutil.copytree(kept, work.results)
    assert work.dry_run(overlay=THRESHOLD) == project.dry_run(overlay=THRESHOLD)
    work.made(f"{RESULTS}/{name}")
    assert work.bits() == first


@pytest.mark.parametrize("act", ["exchanged", "copied over"])
def test_results_belong_to_their_directories(project, tmp_path, act):
    work = project.copy(tmp_path / "project")
    networks = work.results / "Re400" / "networks"
    first, second = networks / "esn-N30-RV-seed0", networks / "esn-N40-RV-seed0"
    if act == "exchanged":
        first.rename(tmp_path / "kept")
        second.rename(first)
        (tmp_path / "kept").rename(second)
    else:
        shutil.copytree(first, second, dirs_exist_ok=True)
    outcome = work.snakemake("-n")
    assert outcome.status == 1
    assert "esn-N40-RV-seed0/forecast.nc is a copy of Re400/networks/esn-N30" in outcome.text


# one file of each kind that no target of the campaign needs, and two that some need
KINDS = """ensemble.nc events.nc evaluation_set.nc lyapunov.json statistics_floor.nc
    networks/esn-N40-RV-seed0/hyperparameters.json networks/esn-N40-RV-seed0/examples.nc
    scan/esn-N40-seed0/RV+SSV.nc models/equations/forecast.nc tables/horizon.csv"""


def files(project: Project) -> list[str]:
    """All results."""
    return sorted(name for name in project.bits() if not name.endswith(".log"))


def made_again(project: Project, name: str) -> bool:
    """Whether a dry run plans the file, once it is away; the dry run changes nothing."""
    path, away = project.results / name, project.directory / "away"
    hidden = {file: file.read_bytes() for file in project.results.rglob(".*") if file.is_file()}
    path.rename(away)
    text = project.made("--verbose", "-n").text
    assert hidden == {file: file.read_bytes() for file in hidden}
    away.rename(path)
    outputs = re.findall(r"^ +output: (.*)$", text, re.M)
    return any(f"{RESULTS}/{name}" in re.split(", | ", line) for line in outputs)


@pytest.mark.parametrize("name", KINDS.split())
def test_each_kind_of_result_is_a_target(project, name):
    """A dry run changes nothing: what is put back is what it was."""
    assert made_again(project, name if name.startswith("Re400") else f"Re400/{name}")
    assert project.planned() == set()


@pytest.mark.long
def test_every_result_is_a_target_and_has_its_bits_again(project, tmp_path):
    work = project.copy(tmp_path / "project")
    assert [name for name in files(work) if not made_again(work, name)] == []
    first = work.bits()
    for name in files(work)[::7]:
        (work.results / name).unlink()
    assert work.snakemake(BURSTCAST_TEST_PRETEND="figure.py").status == 0
    assert work.bits() == first


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


# -- what an edit sets off: the jobs that run, and no others, written by hand ----------------------

# What has rows of every forecaster, of those that control, and of networks.
GROUPS = {
    "GATHERED": """classification_table/* horizon_table/* warnings_table/*
        calibrate/* probability_scores/* reliability_table/* lead_times/*
        joined_forecasts joined_horizon joined_warnings joined_probabilities figure/reliability
        figure/precision_recall
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
    sets_off: str = ""  # patterns of the jobs that run, and groups of them


def edits_of(table):
    """Edits from lines: what, file, old text, new text, and jobs that run."""
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


def jobs_of(project: Project, expected: str) -> set[str]:
    """Jobs of the campaign that patterns name, without those of patterns after a minus sign."""
    every = {name.removesuffix(".log") for name in project.logs()}
    jobs: set[str] = set()
    for word in f"report_page {expected}".split():
        for pattern in GROUPS.get(word, word).split():
            named = {job for job in every if fnmatchcase(job, pattern.removeprefix("-"))}
            assert named, pattern
            jobs = jobs - named if pattern.startswith("-") else jobs | named
    return jobs


# -- nothing runs ----------------------------------------------------------------------------------

WITHOUT_EFFECT = [
    *edits_of(r"""
help of the command line | WORKFLOW/commands/command_line.py |
  help="the zip; <results>.zip if left out" | help="the archive"
another message of the harness | WORKFLOW/harness/running.py |
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
  (observable(states) >= level) | (observable(states) >= 2.0 * level) |
  control/*/receding_horizon-* control_strategies_table/* joined_control figure/control_frontier
  figure/control_tradeoff warnings_table/* joined_warnings
format of a column | workflow/tables.yaml | empty without events, format: .3f |
  empty without events, format: .2f | joined_forecasts
order of the columns of a table | workflow/tables.yaml | [series, survived_fraction, escapes, |
  [series, escapes, survived_fraction, | survival_table/* joined_long_term figure/own_flow
a colour of one figure | LIBRARY/figures/control_tradeoff.py |
  axvline(0, color=style.GREY | axvline(0, color=style.PURPLE | figure/control_tradeoff
the equations as a forecaster | LIBRARY/forecasters/equations_noisy.py |
  return self.with_fitted(system=case.system, in_force=case.parameters, **steps) |
  return self.with_fitted(in_force=case.parameters, system=case.system, **steps) |
  */equations */equations/* */equations_noisy GATHERED OF_CONTROL -figure/error_growth
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
  joined_warnings figure/long_term_density figure/profile_errors figure/midplane_mean_square
""")
]


@pytest.mark.parametrize("edit", WITH_EFFECT, ids=lambda edit: edit.what)
def test_edits_that_run_little(project, edit):
    with edited(project, edit):
        planned = project.planned()
    assert planned == jobs_of(project, edit.sets_off)


def test_one_more_seed_in_a_block_of_its_own(project):
    networks = {"neurons": [40], "validation": ["RV"], "seeds": 2}
    block = {"reynolds": [400], "forecasters": {"esn": networks}}
    planned = project.planned(overlay={"campaign": [*tiny_with()["campaign"], block]})
    files = "forecaster.nc forecast.nc calibration_forecast.nc horizon.nc long_term.nc search.csv"
    files += " hyperparameters.json lyapunov_spectrum.nc"
    new = {f"Re400/networks/esn-N40-RV-seed1/{name}" for name in files.split()}
    new |= {f"Re400/scan/esn-N40-seed1/RV+SSV.{suffix}" for suffix in ("csv", "nc")}
    paper, other = "prediction_triggered-prediction_time1-window1", "receding_horizon-"
    other += "decision_interval0.5-horizon1"
    for controller in (f"esn-N40-RV-seed1/{paper}", f"esn-N40-RV-seed1/{other}"):
        new.add(f"Re400/control/{controller}/flows.nc")
    new.add(f"Re400/control/esn-N40-RV-seed1-random/{paper}/flows.nc")
    others = jobs_of(project, "control/*/esn-N40-RV-committee/* ALL_OF_NETWORKS")
    assert planned == new | others

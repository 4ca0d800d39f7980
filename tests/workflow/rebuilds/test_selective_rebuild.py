"""What must run again after an edit does, nothing else does, and the results have the same bits.

The long tests make every edit: pytest -m long tests/workflow/rebuilds. Plans (-k plan) take half an
hour, runs (-k every_setting) hours.
"""

import os
import random
import shutil
from collections.abc import Iterator
from dataclasses import replace

import pytest
import yaml
from dependencies import ALL
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


def test_an_edit_of_meaning_beside_those_without(lab):
    work = lab.base.copy(lab.directory / "meaning")
    path = work.directory / "src/burstcast/forecast/horizon.py"
    path.write_text(path.read_text() + "\nEDITED = 1\n")
    assert {"horizon", "horizon_table"} <= work.dry_run("tables").keys()


def test_changed_settings_beside_the_outputs_of_other_networks(lab):
    edit = CONFIG_EDITS["campaign.0.forecasters.esn.seeds"]
    work = lab.base.copy(lab.directory / "seeds")
    jobs = work.dry_run("tables", overlay=edit.overlay())
    sizes, strategies = 2, 2
    assert jobs["scan"] == sizes
    assert jobs["train"] == jobs["forecast"] == sizes * strategies
    assert "simulate" not in jobs


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
def test_deleted_files_hide_no_edit(finished, tmp_path, name):
    """Whatever files are deleted, an edit makes at least the jobs run that it would run anyway."""
    project = finished.project.copy(tmp_path / "project")
    for result in some_results(project, name):
        (project.results / result).unlink()
    assert_nothing_is_hidden(finished.project, project, CONFIG_EDITS[name].overlay())


@pytest.fixture(scope="module")
def another(finished, tmp_path_factory) -> Project:
    """The same campaign with another seed."""
    project = finished.project.copy(tmp_path_factory.mktemp("another") / "project")
    assert project.snakemake("tables", overlay={"random_seed": 7}).status == 0
    return project


@pytest.mark.long
@EVERY_SETTING
def test_restored_files_hide_no_edit(finished, another, tmp_path, name):
    """Neither do files of another run, their records, or both."""
    project = finished.project.copy(tmp_path / "project")
    of_result = (["{}"], [".records/{}.json"], ["{}", ".records/{}.json"])[len(name) % 3]
    for result in some_results(project, name):
        for part in of_result:
            shutil.copy2(
                another.results / part.format(result), project.results / part.format(result)
            )
    assert_nothing_is_hidden(finished.project, project, CONFIG_EDITS[name].overlay())
    assert project.dry_run("tables") != {}

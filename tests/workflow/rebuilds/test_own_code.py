"""A copy of the project runs its own code, or none."""

from helpers_rebuilds import HERE


def test_the_environment_of_another_copy_is_refused(finished, tmp_path):
    one, other = (finished.project.without_results(tmp_path / name) for name in ("one", "other"))
    path = f"{one.directory / 'src'}:{HERE / 'server'}"
    outcome = other.snakemake("-n", PYTHONPATH=path)
    assert outcome.status == 1
    assert f"Python imports burstcast from {one.directory / 'src'}, another copy" in outcome.text
    assert "Traceback" not in outcome.text
    assert one.snakemake("-n").status == 0


def test_an_edit_during_a_run_that_is_undone_before_the_next_leaves_nothing(finished, tmp_path):
    project = finished.project.copy(tmp_path / "project")
    tables = project.tables()
    module = project.directory / "src/burstcast/forecast/horizon.py"
    script = project.directory / "workflow/scripts/data/events.py"
    texts = {path: path.read_text() for path in (module, script)}
    # the job of the events edits what the jobs of the horizons import
    edit = f"open({str(module)!r}, 'a').write('EDITED = 1')"
    function = '    """Write the events'
    assert texts[script].count(function) == 1
    script.write_text(texts[script].replace(function, f"    {edit}\n{function}"))
    target = "results/tiny/tables/horizon.csv"
    outcome = project.snakemake(target)
    assert outcome.status == 1
    assert "burstcast.forecast.horizon changed after the workflow was planned" in outcome.text
    for path, text in texts.items():
        path.write_text(text)
    assert project.snakemake("tables").status == 0
    assert project.tables() == tables

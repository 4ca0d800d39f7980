import signal
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated

import pytest
from matplotlib.figure import Figure

from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast_workflow.fingerprint import fingerprint
from burstcast_workflow.harness.code_check import package_root
from burstcast_workflow.harness.figures import Settings, Table, figure, run_figure


class Files(dict):
    """Named files of a job; iterating over them gives the files."""

    def __iter__(self):
        return iter(self.values())


@pytest.fixture
def job(tmp_path, monkeypatch):
    """Job of a figure with an input and a setting, as Snakemake hands it over."""
    handler = signal.getsignal(signal.SIGTERM)
    monkeypatch.chdir(tmp_path)
    for name in ("table.csv", "a.nc", "b.nc"):
        Path(name).touch()
    script = tmp_path / "by_reynolds.py"
    script.write_text("import burstcast.figures.by_reynolds")
    code = fingerprint(script, package_root())
    yield SimpleNamespace(
        rule="figure",
        scriptdir=str(tmp_path),
        log=[str(tmp_path / "logs" / "figure.log")],
        wildcards={"figure": "by_reynolds"},
        input=Files(table="table.csv", others=["a.nc", "b.nc"]),
        output=Files(
            pdf=str(tmp_path / "figures" / "figure.pdf"),
            png=str(tmp_path / "figures" / "figure.png"),
        ),
        params=SimpleNamespace(settings={"case.density.bins": 3}, code=code),
    )
    signal.signal(signal.SIGTERM, handler)


def test_figures_are_written_as_pdf_and_png(tmp_path, job):
    given = {}

    def draw(*, table, others, settings):
        given.update(table=table, others=others, bins=settings["case.density.bins"])
        return nothing_to_show("Nothing happened.")

    run_figure(job, draw)
    assert given == {"table": "table.csv", "others": ["a.nc", "b.nc"], "bins": 3}
    figures = tmp_path / "figures"
    assert (figures / "figure.pdf").read_bytes().startswith(b"%PDF")
    assert (figures / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in figures.iterdir()) == ["figure.pdf", "figure.png"]


def test_inputs_are_read_as_their_types_say(tmp_path, job):
    Path("table.csv").write_text("case,value\nRe400,1.5\n")
    given = {}

    def draw(
        *, table: Table, others: Annotated[int, len], settings: Settings, more: Table | None = None
    ) -> Figure:
        given.update(table=table, others=others, more=more)
        return nothing_to_show("Nothing happened.")

    run_figure(job, draw)
    assert given["table"].to_dict("records") == [{"case": "Re400", "value": 1.5}]
    assert (given["others"], given["more"]) == (2, None)
    # an input that may be left out is read all the same
    job.input["more"] = "table.csv"
    run_figure(job, draw)
    assert given["more"].equals(given["table"])


def test_a_figure_is_drawn_where_snakemake_runs_its_script(job):
    script = "@figure\ndef draw(*, table, others): return nothing_to_show('')"
    names = {"figure": figure, "nothing_to_show": nothing_to_show}
    exec(script, scope := dict(names))
    assert not Path(job.output["png"]).exists()
    assert scope["draw"](table=1, others=2).texts
    exec(script, {**names, "snakemake": job})
    assert Path(job.output["png"]).exists()


def failure(tmp_path, job, draw):
    with pytest.raises(SystemExit):
        run_figure(job, draw)
    assert list((tmp_path / "figures").iterdir()) == []
    return (tmp_path / "logs" / "figure.log").read_text()


def test_nothing_is_written_for_a_figure_that_cannot_be_drawn(tmp_path, job):
    log = failure(tmp_path, job, lambda table, others: nothing_to_show(r"$\nosuchcommand$"))
    assert "nosuchcommand" in log


def test_a_figure_that_leaves_an_input_out_is_an_error(tmp_path, job):
    def draw(*, table, settings):
        return nothing_to_show("")

    assert "TypeError: draw takes no argument others" in failure(tmp_path, job, draw)

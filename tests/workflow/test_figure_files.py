from types import SimpleNamespace

import pytest
from burstcast_workflow.figure_files import write_figure

from burstcast.figures.parts.nothing_to_show import nothing_to_show


def outputs(directory):
    return SimpleNamespace(pdf=str(directory / "figure.pdf"), png=str(directory / "figure.png"))


def test_figures_are_written_as_pdf_and_png(tmp_path):
    write_figure(outputs(tmp_path), nothing_to_show("Nothing happened."))
    assert (tmp_path / "figure.pdf").read_bytes().startswith(b"%PDF")
    assert (tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["figure.pdf", "figure.png"]


def test_nothing_is_written_for_a_figure_that_cannot_be_drawn(tmp_path):
    with pytest.raises(ValueError, match="nosuchcommand"):
        write_figure(outputs(tmp_path), nothing_to_show(r"$\nosuchcommand$"))
    assert list(tmp_path.iterdir()) == []

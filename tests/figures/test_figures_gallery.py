"""What holds for every figure."""

import subprocess
import sys

import matplotlib
import pytest
from helpers_figures import GALLERY, drawn_texts, overlapping_texts

from burstcast.figures.parts.style import DOUBLE_COLUMN, render
from burstcast.figures.registry import available_figures


@pytest.mark.parametrize("name", GALLERY)
def test_figure_is_legible_at_print_size(name):
    figure = GALLERY[name]()
    assert figure.get_figwidth() <= DOUBLE_COLUMN
    texts = drawn_texts(figure)
    assert min(text.size for text in texts) >= 6.0
    assert overlapping_texts(texts) == []
    for text in texts:  # the edge of the figure cuts none
        assert min(*text.frame.min, *(figure.bbox.max - text.frame.max)) >= -1, text.words


@pytest.mark.parametrize("file_format", ["pdf", "png", "svg"])
def test_files_are_the_same_whenever_they_are_made(file_format):
    first, second = (render(GALLERY["midplane_mean_square"](), file_format) for _ in range(2))
    assert first == second
    assert b"Date" not in first
    assert b"matplotlib v" not in first.lower()


def test_a_users_own_settings_change_nothing():
    plain = render(GALLERY["horizon_by_size"](), "pdf")
    with matplotlib.rc_context({"font.size": 20, "axes.grid": True, "lines.linewidth": 5}):
        assert render(GALLERY["horizon_by_size"](), "pdf") == plain


def test_drawing_leaves_the_users_settings_alone():
    before = dict(matplotlib.rcParams)
    render(GALLERY["horizon_schematic"](), "png")
    assert dict(matplotlib.rcParams) == before


def test_unknown_format_is_refused():
    with pytest.raises(ValueError, match="bmp"):
        render(GALLERY["horizon_schematic"](), "bmp")


def test_every_figure_is_in_the_gallery():
    assert set(available_figures()) == set(GALLERY) - {"nothing_to_show"}


def test_no_figure_imports_pyplot():
    names = set(GALLERY) - {"nothing_to_show"}
    modules = [f"burstcast.figures.{name}" for name in sorted(names)]
    program = f"import sys, {', '.join(modules)}; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0

"""The site: what ``docs/site/build.py`` adds to the pages. ``make docs`` builds all of it."""

import ast
import io
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from helpers_rebuilds import Project
from PIL import Image

ROOT = Path(__file__).parents[2]
pytest.importorskip("sphinx", reason="the site needs requirements-docs.lock (make docs)")


@pytest.fixture(scope="module")
def build():
    sys.path.insert(0, str(ROOT / "docs" / "site"))
    import build

    yield build
    sys.path.remove(str(ROOT / "docs" / "site"))


def test_every_public_module_has_its_place(build):
    named = set(re.findall(r"automodule:: (\S+)", "\n".join(build.api_pages().values())))
    public = {
        ".".join(path.relative_to(ROOT / "src").with_suffix("").parts).removesuffix(".__init__")
        for path in (ROOT / "src" / "burstcast").rglob("*.py")
    }
    assert named == {name for name in public if "._" not in name}


def test_a_public_name_without_a_docstring_is_found(build):
    text = '"""Documented."""\nclass A:\n    """Documented."""\n    def b(self): ...\ndef _c(): ...'
    assert list(build._undocumented("m", ast.parse(text))) == ["m.A.b"]
    assert list(build._undocumented("m", ast.parse("def b(): ...\n"))) == ["m", "m.b"]


def test_links_hold_where_their_page_lies(build):
    def relinked(text, page):
        return build._relinked(text, ROOT / "docs" / "method.md", page)

    assert relinked("[a](solver.md#x)", "method.md") == "[a](solver.md#x)"
    assert relinked("[a](../config.yaml)", "method.md") == "[a](repository/config.yaml)"
    assert relinked("[a](figures.md)", "repository/b.md") == "[a](../figures.md)"
    assert relinked("[a](README.md)", "method.md") == "[a](index.md)"
    assert relinked("[a](nowhere.md)", "method.md") == "[a](nowhere.md)"


def test_every_figure_is_in_the_gallery_once(build):
    from burstcast.figures.registry import available_figures

    named = re.findall(r"^#### (\w+)$", build.gallery({}), re.MULTILINE)
    assert sorted(named) == available_figures()


def test_pages_show_the_figures_of_the_kept_tables(build):
    drawn = build.pictures()
    for name in ("forecast_skill", "control_frontier"):
        preset, picture = drawn[name]
        assert preset == "beyond_the_paper"
        kept = ROOT / "docs" / "images" / f"{name}.png"
        now, then = (
            np.asarray(Image.open(file).convert("L"), dtype=float)
            for file in (io.BytesIO(picture), kept)
        )
        assert now.shape == then.shape
        # other libraries may draw edges otherwise
        assert (np.abs(now - then) > 64).mean() < 1e-3


@pytest.mark.long
def test_the_commands_of_the_gallery_make_their_figures(build, tmp_path):
    project = Project.create(tmp_path / "project")
    targets: dict[tuple[str, ...], list[str]] = {}
    for block in re.findall(r"```sh\n(.*?)\n```", build.gallery({})):
        program, *options, target = shlex.split(block)
        assert program == ".venv/bin/snakemake"
        targets.setdefault(tuple(options), []).append(target)
    for options, wanted in targets.items():
        plan = subprocess.run(
            [sys.executable, "-m", "snakemake", "-n", *wanted, *options],
            cwd=project.directory,
            env=project.environment(),
            capture_output=True,
            text=True,
            check=False,
        )
        assert plan.returncode == 0, plan.stderr[-3000:]
        assert re.search(rf"^figure +{len(wanted)}$", plan.stdout, re.MULTILINE)


def test_names_of_settings_break_after_dots(build):
    row = "| `search.grid` | `a.b` |\n| one | `c.d` |"
    assert build.breakable(row) == "| <code>search.<wbr>grid</code> | `a.b` |\n| one | `c.d` |"


def test_a_notebook_becomes_a_page(build):
    cells = [
        {"cell_type": "markdown", "source": ["# Title\n", "Text."]},
        {
            "cell_type": "code",
            "source": ["print(1)"],
            "outputs": [
                {"output_type": "stream", "text": ["1\n"]},
                {"data": {"image/png": "aGk=", "text/plain": "<Figure>"}},
                {"data": {"text/plain": ["(2, 3)"]}},
            ],
        },
    ]
    notebook = {"cells": cells}
    assert build.notebook_pictures("own", notebook) == {"own_0.png": b"hi"}
    assert build.notebook_page("own", notebook).split("\n\n") == [
        "# Title",
        "Text.",
        "Download: [own.ipynb](own.ipynb)",
        "```python\nprint(1)\n```",
        "```text\n1\n```",
        "![output](images/own_0.png)",
        "```text\n(2, 3)\n```",
        "",
    ]

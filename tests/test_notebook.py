"""docs/event_forecast.ipynb: its cells run as they are, and show what running them showed."""

import json
import re
from pathlib import Path

import matplotlib
import numpy as np
import pytest

DOCS = Path(__file__).parents[1] / "docs"
NOTEBOOK = DOCS / "event_forecast.ipynb"


@pytest.fixture(scope="module")
def cells():
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


@pytest.mark.filterwarnings("ignore:FigureCanvasAgg is non-interactive")
def test_the_cells_run(cells, capsys):
    matplotlib.use("agg")
    names: dict[str, object] = {}
    for cell in cells:
        exec("".join(cell["source"]), names)
    said = capsys.readouterr().out
    assert len(names["figure"].axes[0].lines) == 8  # six networks, the truth, the threshold
    # as it was shown, whatever the last digits are on another machine
    shown = "".join(
        "".join(output["text"]) for cell in cells for output in cell["outputs"] if "text" in output
    )
    number = r"[-+]?\d+(?:\.\d+)?"
    assert re.sub(number, "", said).split() == re.sub(number, "", shown).split()
    score = {
        text: [float(found) for found in re.findall(r"f_score ([\d.]+)", text)]
        for text in (said, shown)
    }
    np.testing.assert_allclose(score[said], score[shown], atol=0.1)
    assert score[shown][0] > 0.9
    assert np.array_equal(
        names["again"].predict(names["test"]), names["forecaster"].predict(names["test"])
    )


def test_it_was_executed_from_top_to_bottom(cells):
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    assert all(cell["outputs"] for cell in cells)
    kinds = [output["output_type"] for cell in cells for output in cell["outputs"]]
    assert "error" not in kinds
    assert NOTEBOOK.stat().st_size < 100_000


def test_the_page_says_what_the_notebook_does(cells):
    """The ten lines of docs/notebook.md, on the notebook's series."""
    text = (DOCS / "notebook.md").read_text(encoding="utf-8")
    ten_lines = re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0]
    names: dict[str, object] = {}
    exec("".join(cells[0]["source"]), names)
    names["observed"] = names["test"][:, :200]
    quick = ten_lines.replace("members=6", "members=2, grid=2, bayesian_points=0")
    exec(quick.replace("neurons=100", "neurons=40"), names)
    assert names["probability"].shape == (30,)
    assert {"f_score", "brier_skill"} <= set(names["scores"])

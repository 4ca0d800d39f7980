"""The notebooks in docs: their cells run as they are, and show what running them showed."""

import json
import re
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from helpers_library import code_cells

DOCS = Path(__file__).parents[1] / "docs"
NOTEBOOKS = sorted(DOCS.glob("*.ipynb"))
NUMBER = r"[-+]?\d+(?:\.\d+)?"


def printed(cells):
    """Text that the cells printed when the notebook was saved."""
    texts = [
        "".join(output["text"]) for cell in cells for output in cell["outputs"] if "text" in output
    ]
    return "".join(texts)


@pytest.fixture(scope="module")
def cells():
    return code_cells(DOCS / "event_forecast.ipynb")


@pytest.fixture
def run(capsys):
    """Runs a notebook; the names it defines, the numbers it prints, and those it shows."""

    def run(name):
        matplotlib.use("agg")
        names: dict[str, object] = {}
        cells = code_cells(DOCS / f"{name}.ipynb")
        for cell in cells:
            exec("".join(cell["source"]), names)
        output, shown = capsys.readouterr().out, printed(cells)
        # whatever the last digits are on another machine
        assert re.sub(NUMBER, "", output).split() == re.sub(NUMBER, "", shown).split()
        return names, *(list(map(float, re.findall(NUMBER, text))) for text in (output, shown))

    return run


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:FigureCanvasAgg is non-interactive")
def test_a_scored_forecast(cells, run, capsys):
    names, output, shown = run("event_forecast")
    assert len(names["figure"].axes[0].lines) == 8  # six networks, the truth, the threshold
    np.testing.assert_allclose(output, shown, atol=0.1, rtol=0.1)
    assert names["forecaster"].score(names["test"]) > 0.9
    assert np.array_equal(
        names["again"].predict(names["test"]), names["forecaster"].predict(names["test"])
    )


@pytest.mark.long
def test_a_record_with_gaps(run):
    names, output, shown = run("own_data")
    np.testing.assert_allclose(output, shown, rtol=0.05)
    # nothing is filled in: every sample of the series is in the record, without a gap in time
    series, record = names["series"], names["record"].dropna()
    rows = {tuple(row): time for time, *row in record.to_numpy()}
    times = np.array([[rows[tuple(sample)] for sample in samples] for samples in series])
    np.testing.assert_allclose(np.diff(times), 0.02, atol=1e-9)
    assert names["found"].low < 0.906 < names["found"].high
    # the probability is that of the same samples at once
    whole = names["forecaster"].predict_proba(names["live"][np.newaxis])[0, 1]
    assert names["probability"][-1] == whole


def test_control_by_what_if(run):
    names, output, shown = run("what_if")
    np.testing.assert_allclose(output, shown, rtol=0.2, atol=0.02)
    control = names["run"]
    above = [(values >= 41).mean() for values in (control.free_observable, control.observable)]
    assert above[1] < 0.2 * above[0]
    # before its first actuation a flow is the free one
    first = np.argmax(control.actuated, axis=1)
    for flow, stop in enumerate(first):
        np.testing.assert_array_equal(control.states[flow, :stop], control.free_states[flow, :stop])


def test_return_levels_of_the_shear_flow(run):
    names, output, shown = run("return_levels")
    # the counts of flows that other processors let laminarise elsewhere scatter
    np.testing.assert_allclose(output, shown, rtol=0.3, atol=0.1)
    found, too_low = names["found"], names["too_low"]
    # a thousand Lyapunov times: long runs have 0.4 at 923 LT
    assert found.low[1] < 0.405 < found.high[1]
    assert found.tail.threshold > 0.12
    assert found.level[2] < 0.5 < too_low.level(10000)


@pytest.mark.long
def test_forecast_and_control_of_lorenz_96(run):
    names, output, shown = run("lorenz96")
    np.testing.assert_allclose(output, shown, rtol=0.2, atol=0.02)
    scores = names["run"].scores
    assert scores["exceedance_controlled"].high < 0.1 * scores["exceedance_uncontrolled"].low
    assert scores["control_fraction"].value < 0.1


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_was_executed_from_top_to_bottom(path):
    cells = code_cells(path)
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell["outputs"]]
    assert outputs
    assert "error" not in {output["output_type"] for output in outputs}
    assert "stderr" not in {output.get("name") for output in outputs}
    assert path.stat().st_size < 100_000


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_its_links_lead_somewhere(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            for link in re.findall(r"\]\(([^)#\s]+)", "".join(cell["source"])):
                assert (DOCS / link).exists()


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
    assert {"alarm_f_score", "brier_skill"} <= set(names["scores"])

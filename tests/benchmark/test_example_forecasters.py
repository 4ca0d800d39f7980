"""Forecasters of other libraries run as docs/benchmark.md says, and are scored."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from burstcast_workflow.commands.command_line import main

EXAMPLES = Path(__file__).parents[2] / "examples" / "benchmark"


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """The task of a case of the benchmark; what is scored runs beside it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("cases"))
        assert main(["benchmark", "export", "--case", "Re400"]) == 0
        yield "results/benchmark_shear_flow/Re400/forecast_task.nc"


def run(exported, script, name, *more):
    command = [sys.executable, str(EXAMPLES / script), exported, name, *more]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def scores_of(name, *options):
    assert main(["benchmark", "score", name, *options]) == 0
    found = pd.read_csv(Path(name).with_suffix(".scores.csv")).fillna({"prediction_time_lt": 0})
    return found.set_index(["metric", "prediction_time_lt"])["value"]


@pytest.mark.long  # minutes
def test_a_network_of_reservoirpy_forecasts_events(exported):
    run(exported, "reservoirpy_esn.py", "esn.nc", "100")
    found = scores_of("esn.nc")
    assert found["f_score", 1] > 0.6
    assert found["brier_skill", 1] > 0.2
    assert found["mean_horizon_lt", 0] > 1


@pytest.mark.long  # a minute
def test_trees_of_scikit_learn_know_more_than_climatology(exported):
    said = run(exported, "gradient_boosting.py", "trees.csv")
    (threshold,) = re.findall(r"alarm threshold ([\d.]+)", said)
    found = scores_of("trees.csv", "--alarm-threshold", threshold)
    assert found["brier_skill", 1] > 0
    assert found["roc_area", 1] > 0.7


def test_closed_loops_side_by_side_are_those_of_reservoirpy(monkeypatch):
    """The loop in NumPy against ReservoirPy's own nodes, one trajectory after another."""
    monkeypatch.syspath_prepend(str(EXAMPLES))
    import reservoirpy_esn
    from reservoirpy.nodes import Reservoir, Ridge

    nodes = []
    for kind in (Reservoir, Ridge):

        def noted(*arguments, kind=kind, **options):
            nodes.append(kind(*arguments, **options))
            return nodes[-1]

        monkeypatch.setattr(reservoirpy_esn, kind.__name__, noted)
    time = np.arange(400) * 0.1
    phases = np.array([0.0, 1.0, 2.5])[:, np.newaxis]
    training = np.stack([np.sin(time + phases), np.cos(time + phases)], axis=2)
    network = reservoirpy_esn.Network(training, 30, 0.5, 0.3, 1e-6, 40)
    washouts = training[:, 100:120]
    found = network.forecast(washouts, 15)
    reservoir, readout = nodes
    for row, washout in enumerate(washouts):
        reservoir.reset()
        state = reservoir.run((washout - network.mean) / network.scale)[-1]
        for step in range(15):
            output = readout.run(reservoirpy_esn.with_squares(state[np.newaxis]))[0]
            expected = output * network.scale + network.mean
            np.testing.assert_allclose(found[row, step], expected, atol=1e-9)
            state = reservoir.step(output)
    # it has learnt the circle
    truth = training[:, 120:135]
    assert np.abs(found - truth).max() < 0.05

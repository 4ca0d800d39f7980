"""The examples in docstrings run, and the names that a user meets first have one."""

import doctest
import importlib
import inspect
from pathlib import Path

import pytest

SOURCES = Path(__file__).parents[1] / "src"
MODULES = [
    ".".join(path.relative_to(SOURCES).with_suffix("").parts)
    for path in sorted((SOURCES / "burstcast").rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]
FIRST = [
    "burstcast.control.actuation.actuated_system",
    "burstcast.data.dataset.component_scales",
    "burstcast.data.dataset.add_observation_noise",
    "burstcast.data.delay_coordinates.delay_coordinates",
    "burstcast.base.durations.steps",
    "burstcast.base.durations.steps_per_lyapunov_time",
    "burstcast.networks.dynamics.Dynamics",
    "burstcast.networks.network.EchoStateNetwork",
    "burstcast.networks.reservoir.make_reservoir",
    "burstcast.networks.training.train",
    "burstcast.event_forecaster.closed_loop.control_system",
    "burstcast.event_forecaster.forecaster.EventForecaster",
    "burstcast.data.events.upward_crossings",
    "burstcast.forecasters._square_root_filter.symmetric_members",
    "burstcast.forecasts.scores.ContingencyTable",
    "burstcast.forecasters.registry.make_kind",
    "burstcast.data.laminarisation.is_laminar",
    "burstcast.data.observation.velocity_sensors.VelocitySensors",
    "burstcast.forecasts.scores.brier_skill",
    "burstcast.forecasts.alarms.isotonic",
    "burstcast.base.random_streams.stream",
    "burstcast.statistics.densities.histogram",
    "burstcast.statistics.densities.kantorovich_metric",
    "burstcast.statistics.neighbour_divergence.neighbour_divergence",
    "burstcast.systems.integration.integrate",
    "burstcast.systems.lorenz63.Lorenz63",
    "burstcast.systems.lorenz96.Lorenz96",
    "burstcast.systems.lyapunov.kaplan_yorke_dimension",
    "burstcast.systems.lyapunov.lyapunov_spectrum",
    "burstcast.systems.mfe.MoehlisFaisstEckhardt",
]


@pytest.mark.parametrize("module", MODULES)
def test_the_examples_of_a_module_run(module):
    outcome = doctest.testmod(importlib.import_module(module))
    assert outcome.attempted > 0
    assert outcome.failed == 0


@pytest.mark.parametrize("name", FIRST)
def test_a_user_finds_an_example(name):
    module, _, thing = name.rpartition(".")
    text = inspect.getdoc(getattr(importlib.import_module(module), thing)) or ""
    assert "\nExamples\n--------\n>>> " in text

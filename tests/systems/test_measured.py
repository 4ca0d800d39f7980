"""Measured series: what their observable is made of."""

import json

import numpy as np
import pytest

from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries, derives
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.state_space import component_names, make_measured

STATES = np.random.default_rng(1).normal(size=(3, 4, 5))


def test_the_observable_is_a_component() -> None:
    series = MeasuredSeries(["x", "flow rate [l/s]", "z"], "flow rate [l/s]")
    assert (series.dimension, series.appended) == (3, False)
    found = series.observable(STATES)
    assert np.array_equal(found, STATES[1])
    found[:] = 0.0
    assert STATES[1].any()


def test_the_observable_is_an_expression_of_components() -> None:
    series = MeasuredSeries(["x", "y", "z"], "x**2 + y * z")
    assert (series.dimension, series.appended) == (3, False)
    x, y, z = STATES
    assert np.array_equal(series.observable(STATES), x * x + y * z)
    assert np.array_equal(series.observable(STATES[:, 0, 0]), (x * x + y * z)[0, 0])


def test_anything_else_is_a_component_of_its_own() -> None:
    series = MeasuredSeries(["x", "y"], "x + dissipation")
    assert (series.dimension, series.appended) == (3, True)
    assert series.component_names == ("x", "y", "x + dissipation")
    assert np.array_equal(series.observable(STATES), STATES[2])


def test_what_it_is_called() -> None:
    assert MeasuredSeries(["q"], "q").observable_symbol == "q"
    assert MeasuredSeries(["q_1"], "q_1").observable_symbol == r"\mathrm{q\_1}"
    assert MeasuredSeries(["q"], "-glucose").observable_symbol == r"-\mathrm{glucose}"
    assert MeasuredSeries(["q"], "q**2").observable_symbol == r"\mathrm{observable}"
    assert MeasuredSeries(["q"], "exp(q)", "discharge").observable_symbol == r"\mathrm{discharge}"
    named = MeasuredSeries(["q"], "-q", "depth", "d")
    assert (named.observable_name, named.observable_symbol) == ("depth", "d")


def test_from_what_settings_say() -> None:
    said = {"components": ["x", "y"], "observable_of": "x"}
    made = make_measured(json.loads(json.dumps(said)))
    assert made == MeasuredSeries(("x", "y"), "x")


def test_an_observable_that_means_nothing() -> None:
    with pytest.raises(ValueError, match="is no arithmetic expression"):
        derives(["x"], "flow rate [l/s]")


def test_names_of_the_components_of_systems() -> None:
    assert component_names(Lorenz63()) == ("x", "y", "z")
    assert component_names(MoehlisFaisstEckhardt(400.0))[::8] == ("a1", "a9")
    assert component_names(MeasuredSeries(["b"], "b")) == ("b",)

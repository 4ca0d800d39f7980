"""Lyapunov exponents of forecasters against eigenvalues, the equations' own, and Lorenz's."""

import numpy as np
import pytest

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.reservoir import ReservoirSeed, make_reservoir
from burstcast.esn.training import TrainingSeries, train
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasters.registry import available_kinds, linearises
from burstcast.statistics import lyapunov_spectrum as module
from burstcast.statistics.lyapunov_spectrum import forecaster_spectrum, summarise
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.lyapunov import kaplan_yorke_dimension, lyapunov_spectrum
from helpers_forecasters import MadeUpForecaster

ROTATION = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3))).Q
STEP = 0.02


def spectrum(forecaster, washouts, steps, exponents=3, interval=5, seed=1):
    generator = np.random.default_rng(seed)
    return forecaster_spectrum(forecaster, washouts, steps, interval, exponents, STEP, generator)


def lorenz_series(count, steps, transient=2000):
    """States of the Lorenz equations, ``(series, time, 3)``, two integration steps apart."""
    start = np.random.default_rng(2).normal(0, 8, (3, count)) + np.array([[0.0], [0.0], [25.0]])
    start = integrate(Lorenz63(), start, 0.01, transient, max(transient, 1))[-1]
    return integrate(Lorenz63(), start, 0.01, 2 * steps, 2).transpose(2, 0, 1)


def test_linear_model_has_the_logarithms_of_its_eigenvalues():
    rates = np.array([1.05, 0.9, 0.4])
    model = LinearInverseModel(ROTATION @ np.diag(rates) @ ROTATION.T, np.array([0.1, 0.0, 0.2]))
    found = spectrum(model, np.zeros((2, 4, 3)), 600)
    expected = np.log(rates) / STEP
    np.testing.assert_allclose(found.exponents, [expected, expected], rtol=0, atol=1e-9)
    assert found.duration == pytest.approx(450 * STEP)


def test_only_the_leading_exponents_are_wanted():
    model = LinearInverseModel(ROTATION @ np.diag([1.05, 0.9, 0.4]) @ ROTATION.T, np.zeros(3))
    leading = spectrum(model, np.zeros((1, 4, 3)), 600, exponents=2)
    np.testing.assert_allclose(leading.exponents, [np.log([1.05, 0.9]) / STEP], rtol=0, atol=1e-9)
    more = spectrum(model, np.zeros((1, 4, 3)), 600, exponents=5)
    assert np.isnan(more.exponents[0, 3:]).all()
    assert np.isfinite(more.exponents[0, :3]).all()


def test_what_an_interval_loses_to_rounding_is_not_known():
    model = LinearInverseModel(np.diag([1.05, 0.9, 1e-4]), np.zeros(3))
    found = spectrum(model, np.zeros((2, 4, 3)), 600).exponents
    np.testing.assert_allclose(found[:, 0], np.log(1.05) / STEP)
    assert np.isnan(found[:, 2]).all()


def test_equations_have_the_exponents_of_the_system():
    washouts = lorenz_series(6, 10)
    found = spectrum(EquationsFromTruth(Lorenz63(), 0.01, 2), washouts, 4000)
    start = np.ascontiguousarray(washouts[:, -1].T)
    own = lyapunov_spectrum(Lorenz63(), start, 0.01, 6000, 10, alignment_steps=2000)
    assert found.duration == pytest.approx(own.duration)
    # the perturbations begin otherwise, and are lined up after the alignment
    np.testing.assert_allclose(found.exponents, own.exponents, rtol=0, atol=1e-6)


def lorenz_network():
    # off the attractor, at first, so that there is something to learn about the way back
    series = lorenz_series(12, 4000, transient=0)
    noise = np.random.default_rng(5).normal(size=series.shape)
    observed = series + 1e-3 * series.std(axis=(0, 1)) * noise
    input_range = np.ptp(observed, axis=(0, 1))
    seed = ReservoirSeed(0, 300, 0, 3, 0.1)
    dynamics = Dynamics(make_reservoir(300, 3, 3, 0.1, np.random.default_rng(3)), 0.1, 1.0, "scipy")
    readout = train(dynamics, TrainingSeries(observed, input_range), washout=5, tikhonov=1e-9)
    network = NetworkForecaster(EchoStateNetwork(dynamics, readout, input_range), seed, 10.0)
    return network, observed


def test_network_that_has_learnt_lorenz_has_its_exponents():
    network, observed = lorenz_network()
    found = spectrum(network, observed[:, -50:], 8000, exponents=4).exponents
    mean, error = found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(len(found))
    assert error[0] < 0.015
    assert mean[0] == pytest.approx(0.906, abs=0.04)
    assert mean[1] == pytest.approx(0.0, abs=0.02)
    assert mean[2] == pytest.approx(-14.57, abs=0.5)
    # the next one is the reservoir's own
    assert mean[3] < -20
    assert kaplan_yorke_dimension(mean) == pytest.approx(2.062, abs=0.005)


def test_equations_that_are_learnt_have_the_exponents_of_lorenz():
    series = lorenz_series(6, 2000)
    options = {"window_lt": 0.1, "degree": 2, "noise": 0.0, "significance": 3.0}
    model = QuadraticModel.fit(series, ForecastingCase(Lorenz63(), 0.01, 2, 50, options))
    found = spectrum(model, series[:, -10:], 2000).exponents.mean(axis=0)
    np.testing.assert_allclose(found, [0.906, 0.0, -14.57], rtol=0, atol=0.1)


def test_runs_do_not_depend_on_how_many_run_side_by_side(monkeypatch):
    washouts = lorenz_series(5, 10)
    equations = EquationsFromTruth(Lorenz63(), 0.01, 2)
    together = spectrum(equations, washouts, 60).exponents
    monkeypatch.setattr(module, "RUNS_PER_BATCH", 2)
    np.testing.assert_array_equal(spectrum(equations, washouts, 60).exponents, together)


def test_no_run_has_no_exponents():
    found = spectrum(EquationsFromTruth(Lorenz63(), 0.01, 2), np.zeros((0, 4, 3)), 60)
    assert found.exponents.shape == (0, 3)


def test_too_short_runs_are_refused():
    with pytest.raises(ValueError, match="too few"):
        spectrum(EquationsFromTruth(Lorenz63(), 0.01, 2), np.ones((1, 4, 3)), 4)


def test_kinds_say_whether_they_linearise():
    assert {"esn", "equations", "equations_noisy", "quadratic"} <= set(
        filter(linearises, available_kinds())
    )

    class Other(MadeUpForecaster):
        def start(self, washout, parameters=None):
            return washout[-1]

        def advance(self, memory, steps, parameters=None):
            return np.repeat(memory[np.newaxis], steps, axis=0), memory

    with pytest.raises(NotImplementedError, match="Other does not linearise"):
        spectrum(Other(), np.ones((1, 4, 3)), 60)


# -- summaries -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("exponents", "dimension"),
    [
        ([0.906, 0.0, -14.572], 2 + 0.906 / 14.572),
        ([1.0, 0.5, -0.7, -0.6, -5.0], 4 + 0.2 / 5.0),  # those of Hyperchaos: sum of four is 0.2
        ([0.0, 1.0, -4.0], 2.25),  # in any order
        ([-0.1, -0.2], 0.0),
        ([0.0, -1.0], 1.0),
        ([1.0, -0.5], np.nan),  # more than is known
        ([1.0, -0.5, np.nan], np.nan),
        ([1.0, -2.0, np.nan], 1.5),
        ([np.nan], np.nan),
    ],
)
def test_kaplan_yorke_dimension(exponents, dimension):
    found = kaplan_yorke_dimension(np.array(exponents))
    assert found == pytest.approx(dimension, nan_ok=True)


def test_summary_has_the_dimension_of_the_mean_and_its_spread():
    generator = np.random.default_rng(3)
    exponents = np.array([0.9, 0.0, -14.5]) + generator.normal(size=(200, 3)) * [0.3, 0.05, 0.3]
    found = summarise(exponents, 0.9, 2000, np.random.default_rng(1))
    np.testing.assert_allclose(found.mean, exponents.mean(axis=0))
    assert (found.low < found.mean).all()
    assert found.dimension == kaplan_yorke_dimension(exponents.mean(axis=0))
    # to first order the dimension is linear in the mean exponents
    samples = 2 + (exponents[:, 0] + exponents[:, 1]) / 14.5
    margin = 1.645 * samples.std() / np.sqrt(200)
    assert found.dimension_high - found.dimension_low == pytest.approx(2 * margin, rel=0.1)


def test_summary_of_few_runs():
    one = summarise(np.array([[0.9, 0.0, -14.5]]), 0.95, 10, np.random.default_rng(1))
    assert one.mean.tolist() == [0.9, 0.0, -14.5]
    assert np.isnan([*one.low, *one.high, one.dimension_low]).all()
    none = summarise(np.empty((0, 3)), 0.95, 10, np.random.default_rng(1))
    assert np.isnan([*none.mean, none.dimension]).all()

"""A gated recurrent network and hybrid networks: the interface, and both against other ways."""

import importlib.util
import sys

import numpy as np
import pytest

from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.check import check_forecaster
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from gated_network import WEIGHTS, GatedNetwork, first_weights, trained
from hybrid_network import FilteredHybridNetwork, HybridNetwork

CASE = ForecastingCase(Lorenz63(), 0.01, 2, 55)
SMALL = {"neurons": 60, "parameter": "rho"}
WITH_JAX = pytest.mark.skipif(
    importlib.util.find_spec("jax") is None, reason="examples/neural/requirements.lock"
)


@pytest.fixture(scope="module")
def series():
    start = np.array([[1.0], [1.0], [20.0]]) + np.random.default_rng(0).normal(size=(3, 6))
    states = integrate(Lorenz63(), start, 0.01, 2000, stride=2)[200:]
    return np.ascontiguousarray(states.transpose(2, 0, 1))


@pytest.mark.parametrize(
    "forecaster",
    [
        HybridNetwork(**SMALL),
        FilteredHybridNetwork(**SMALL, members=12),
        pytest.param(
            GatedNetwork(neurons=8, updates=(4, 4), closed=(0, 5), rates=(3e-3, 2e-3), batch=4),
            marks=WITH_JAX,
        ),
    ],
    ids=lambda forecaster: type(forecaster).__name__,
)
def test_they_keep_to_the_interface(forecaster):
    report = check_forecaster(forecaster, np.random.default_rng(0))
    assert report.startswith(f"{forecaster!r}: keeps to the interface")


# -- hybrid ----------------------------------------------------------------------------------------


def forecasts(forecaster, series, steps=55):
    """Forecasts after the first 40 samples, ``(steps, component, series)``, and the truth."""
    batch = np.ascontiguousarray(series.transpose(1, 2, 0))
    ahead, _ = forecaster.advance(forecaster.start(batch[:40]), steps)
    return ahead, batch[40 : 40 + steps]


def test_a_hybrid_without_weights_is_its_model(series):
    hybrid = HybridNetwork(**SMALL, factor=1.2).fit(series[:4], CASE)
    hybrid = hybrid.with_fitted(weights=np.zeros_like(hybrid.weights))
    wrong = ForecastingCase(Lorenz63(rho=1.2 * Lorenz63().rho), 0.01, 2, 55)
    model = EquationsFromObservation().fit(series[:4], wrong)
    ours, theirs = (forecasts(one, series[4:])[0] for one in (hybrid, model))
    np.testing.assert_allclose(ours[:20], theirs[:20], rtol=1e-9)


def test_a_hybrid_makes_up_for_what_its_model_misses(series):
    hybrid = HybridNetwork(**SMALL, factor=1.2)
    errors = []
    for model in (hybrid.fit(series[:4], CASE), hybrid.fit(series[:4], CASE).model):
        ahead, truth = forecasts(model, series[4:], 20)
        errors.append(np.abs(ahead - truth).mean())
    assert errors[0] < 0.05 * errors[1]


def test_hyperparameters_are_those_with_the_best_closed_loops_and_kept(series):
    hybrid = HybridNetwork(**SMALL, spectral_radius=(0.1, 0.3), tikhonov=(1e2, 1e-9))
    chosen = hybrid.fit(series[:4], CASE)
    errors = {}
    for radius in (0.1, 0.3):
        for scaling in hybrid.input_scaling:
            for tikhonov in (1e2, 1e-9):
                options = {"spectral_radius": (radius,), "input_scaling": (scaling,)}
                one = HybridNetwork(**SMALL, **options, tikhonov=(tikhonov,)).fit(series[:4], CASE)
                errors[radius, scaling, tikhonov] = one._error(series[:4], CASE, 27)
    assert tuple(chosen.chosen) == min(errors, key=errors.get)
    again = chosen.tuned().fit(series[:4], CASE)
    np.testing.assert_array_equal(again.weights, chosen.weights)


def test_a_parameter_that_the_equations_have_not_is_named(series):
    with pytest.raises(ValueError, match="Lorenz63 has no parameter 'length_x'"):
        HybridNetwork(neurons=20).fit(series[:2], CASE)


# -- gated network ---------------------------------------------------------------------------------


def arbitrary(neurons=5, dimension=3):
    """A gated network with random weights."""
    weights = first_weights(neurons, dimension, np.random.default_rng(0))
    weights = {name: array.astype(float) for name, array in weights.items()}
    weights["biases"] = np.random.default_rng(1).normal(size=3 * neurons)
    weights["output"] *= 30.0
    network = GatedNetwork(neurons=neurons)
    return network.with_fitted(mean=np.ones(dimension), scale=np.full(dimension, 2.0), **weights)


def test_units_follow_their_definition_one_by_one():
    network, washout = arbitrary(), np.random.default_rng(2).normal(size=(7, 3, 2))
    ahead, _ = network.advance(network.start(washout), 4)

    def sigmoid(value):
        return 1 / (1 + np.exp(-value))

    for column in range(2):
        samples, units, last = (washout[:, :, column] - 1) / 2, np.zeros(5), None
        outputs = []
        for step in range(7 + 3):
            sample = samples[step] if step < 7 else last
            following = np.zeros(5)
            for unit in range(5):
                keep, reset, new = (unit, 5 + unit, 10 + unit)
                driven = network.biases + sample @ network.input_weights
                z = sigmoid(driven[keep] + units @ network.recurrent[:, keep])
                r = sigmoid(driven[reset] + units @ network.recurrent[:, reset])
                n = np.tanh(driven[new] + r * (units @ network.recurrent[:, new]))
                following[unit] = z * units[unit] + (1 - z) * n
            units = following
            last = sample + units @ network.output + network.output_bias
            outputs.append(2 * last + 1)
        np.testing.assert_allclose(ahead[:, :, column], outputs[6:], rtol=1e-10)


def test_stages_without_a_setting_each_are_named():
    with pytest.raises(ValueError, match=r"their lengths are 1, 4 and 4"):
        GatedNetwork(updates=(10,))


def test_without_jax_the_lock_is_named(series, monkeypatch):
    monkeypatch.setitem(sys.modules, "jax", None)
    with pytest.raises(ImportError, match=r"pip install -r examples/neural/requirements\.lock"):
        GatedNetwork().fit(series, CASE)


@WITH_JAX
def test_the_network_kept_is_the_one_with_the_best_closed_loops_held_out(series):
    options = GatedNetwork(
        neurons=12, updates=(60, 40), closed=(0, 10), rates=(3e-3, 2e-3), batch=8, looks=20
    )
    network = options.fit(series, CASE)
    held, reach = series[-2:], 110
    starts = range(0, held.shape[1] - 30 - reach, 30)
    washouts = np.concatenate([held[:, at : at + 30] for at in starts]).transpose(1, 2, 0)
    truth = np.concatenate([held[:, at + 30 : at + 30 + reach] for at in starts])
    ahead, _ = network.advance(network.start(washouts), reach)
    error = np.square((ahead - truth.transpose(1, 2, 0)) / network.scale[:, np.newaxis])
    found = np.log10(error.mean(axis=(0, 1))).mean()
    assert network.held_out_error == pytest.approx(found, abs=2e-3)
    untrained = GatedNetwork(neurons=12, updates=(0,), closed=(0,), rates=(0.0,))
    weights, _ = trained(untrained, series.astype(np.float32), reach)
    assert not np.array_equal(weights["output"], network.output)


@WITH_JAX
def test_the_same_seed_gives_the_same_weights(series):
    options = GatedNetwork(neurons=6, updates=(5,), closed=(10,), rates=(3e-3,), batch=4)
    first, second = (options.fit(series, CASE) for _ in range(2))
    for name in WEIGHTS:
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))

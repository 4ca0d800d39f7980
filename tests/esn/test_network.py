import numpy as np
import pytest

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.readout import MomentsAccumulator, Readout, solve_ridge

WASHOUT = 100


@pytest.fixture(scope="module")
def network(reservoir, signal):
    input_range = np.ptp(signal, axis=(0, 2))
    dynamics = Dynamics(reservoir, 0.4, 0.5)
    accumulator = MomentsAccumulator(reservoir.neurons, reservoir.dimension)
    inputs = signal[:-101] / input_range[:, None]
    for panel in dynamics.state_panels(inputs, breakpoints=[WASHOUT]):
        if panel.start >= WASHOUT:
            targets = signal[panel.start + 1 : panel.stop + 1]
            accumulator.add(
                panel.columns, targets.transpose(1, 0, 2).reshape(reservoir.dimension, -1)
            )
    return EchoStateNetwork(dynamics, solve_ridge(accumulator.moments(), 1e-6), input_range)


def test_trained_network_predicts_unseen_data(network, signal):
    start = signal.shape[0] - 100
    states = network.washout(signal[start - WASHOUT : start])
    outputs, _ = network.forecast(states, 5)
    error = np.sqrt(((outputs - signal[start : start + 5]) ** 2).mean(axis=(0, 2)))
    assert (error < 0.1 * signal.std(axis=(0, 2))).all()


def test_washout_and_forecast_scale_by_the_range(network, signal):
    states = network.washout(signal[:30])
    expected = network.dynamics.open_loop(signal[:30] / network.input_range[:, None])
    np.testing.assert_array_equal(states, expected)
    outputs, later = network.forecast(states, 2)
    first = network.readout.weights[:-1].T @ states + network.readout.weights[-1][:, None]
    np.testing.assert_allclose(outputs[0], first, atol=1e-10)
    # The first prediction, fed back as data, gives the second one.
    fed = network.washout(outputs[:1], states)
    second, _ = network.forecast(fed, 1)
    np.testing.assert_allclose(outputs[1], second[0], atol=1e-10)
    np.testing.assert_allclose(network.washout(outputs[1:], fed), later, atol=1e-10)


def test_diverged_looks_at_each_trajectory(reservoir):
    network = EchoStateNetwork(
        Dynamics(reservoir, 0.5, 1.0),
        Readout(np.zeros((reservoir.neurons + 1, 4)), 1e-6, "cholesky", 1.0),
        np.array([1.0, 2.0, 3.0, 4.0]),
    )
    outputs = np.zeros((6, 4, 7))
    outputs[:] = 10 * network.input_range[:, None]  # at the bound: not diverged
    outputs[3, 0, 1] = 10.1
    outputs[5, 3, 2] = -40.1
    outputs[0, 1, 3] = np.nan
    outputs[2, 2, 4] = -np.inf
    outputs[1, 3, 5] = 39.0
    expected = [False, True, True, True, True, False, False]
    assert network.diverged(outputs, 10.0).tolist() == expected
    assert network.diverged(outputs[:0], 10.0).tolist() == [False] * 7

import numpy as np
import pytest

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.readout import Readout
from burstcast.esn.reservoir import make_reservoir
from burstcast.forecasters.equations import EquationsForecaster
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt

SYSTEM = MoehlisFaisstEckhardt(reynolds=400.0)


@pytest.fixture(scope="module")
def flow():
    """Chaotic trajectories of the shear flow at the networks' interval, (steps, 9, batch)."""
    start = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])[:, np.newaxis]
    perturbed = start + 0.01 * np.random.default_rng(2).random((9, 5))
    return integrate(SYSTEM, perturbed, 0.25, 4 * 260, stride=4)[200:]


def test_the_equations_continue_the_true_flow(flow):
    forecaster = EquationsForecaster(SYSTEM, time_step=0.25, sampling_stride=4)
    memory = forecaster.start(flow[:20])
    outputs, _ = forecaster.advance(memory, 30)
    assert outputs.shape == (30, 9, 5)
    np.testing.assert_array_equal(outputs, flow[20:50])
    assert not forecaster.diverged(outputs).any()


def test_the_equations_see_the_last_observation_alone(flow):
    forecaster = EquationsForecaster(SYSTEM, 0.25, 4)
    noisy = flow[:20] + 0.01
    noisy[-1] = flow[19]
    outputs, _ = forecaster.advance(forecaster.start(noisy), 3)
    np.testing.assert_array_equal(outputs, flow[20:23])


def make_network(generator):
    reservoir = make_reservoir(30, 9, 6, 0.1, generator)
    weights = 0.1 * generator.normal(size=(31, 9))
    readout = Readout(weights, 1e-6, "cholesky", 1e-9)
    return EchoStateNetwork(Dynamics(reservoir, 0.9, 1.0, "scipy"), readout, np.linspace(0.2, 1, 9))


FORECASTERS = {
    "equations": EquationsForecaster(SYSTEM, 0.25, 4),
    "network": NetworkForecaster(make_network(np.random.default_rng(5)), 10.0),
}


@pytest.mark.parametrize("name", FORECASTERS)
def test_forecasts_go_on_where_they_were_left(name, flow):
    forecaster = FORECASTERS[name]
    memory = forecaster.start(flow[:20])
    whole, _ = forecaster.advance(memory, 12)
    parts = []
    for steps in (5, 1, 6):
        part, memory = forecaster.advance(memory, steps)
        parts.append(part)
    np.testing.assert_array_equal(np.concatenate(parts), whole)


@pytest.mark.parametrize("name", FORECASTERS)
def test_forecasts_can_be_picked_out_at_any_step(name, flow):
    forecaster = FORECASTERS[name]
    whole, _ = forecaster.advance(forecaster.start(flow[:20]), 12)
    _, memory = forecaster.advance(forecaster.start(flow[:20]), 4)
    some, _ = forecaster.advance(np.ascontiguousarray(memory[..., [3, 1]]), 8)
    np.testing.assert_array_equal(some, whole[4:, :, [3, 1]])


def test_the_network_is_driven_by_the_washout_and_then_by_itself(flow):
    network = FORECASTERS["network"].network
    reservoir, scale = network.dynamics.reservoir, network.input_range
    recurrent = 0.9 * reservoir.recurrent.toarray()
    dense = np.zeros((30, 10))
    dense[np.arange(30), reservoir.input_column] = reservoir.input_weight
    state, expected = np.zeros(30), []
    for value in flow[:20, :, 2]:
        state = np.tanh(dense @ np.append(value / scale, 0.1) + recurrent @ state)
    for _ in range(6):
        expected.append(np.append(state, 1) @ network.readout.weights)
        state = np.tanh(dense @ np.append(expected[-1] / scale, 0.1) + recurrent @ state)
    forecaster = FORECASTERS["network"]
    outputs, _ = forecaster.advance(forecaster.start(flow[:20]), 6)
    np.testing.assert_allclose(outputs[:, :, 2], expected, rtol=1e-10)


def test_what_counts_as_diverged():
    outputs = np.zeros((4, 9, 6))
    scale = FORECASTERS["network"].network.input_range
    outputs[2, 3, 1] = np.nan
    outputs[2, 3, 2] = -np.inf
    outputs[1, 8, 3] = -10.01 * scale[8]
    outputs[1, 8, 4] = 9.99 * scale[8]
    outputs[3, 0, 5] = 10.01 * scale[0]
    expected = [False, True, True, True, False, True]
    assert FORECASTERS["network"].diverged(outputs).tolist() == expected
    # the equations have no bound but the numbers'
    expected = [False, True, True, False, False, False]
    assert FORECASTERS["equations"].diverged(outputs).tolist() == expected

"""The same network in ReservoirPy and the same regression in scikit-learn."""

import numpy as np
import pytest

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.readout import MomentsAccumulator, solve_ridge

reservoirpy_nodes = pytest.importorskip("reservoirpy.nodes")
linear_model = pytest.importorskip("sklearn.linear_model")


def reservoirpy_reservoir(dynamics):
    reservoir = dynamics.reservoir
    columns = np.zeros((reservoir.neurons, reservoir.dimension + 1))
    columns[np.arange(reservoir.neurons), reservoir.input_column] = reservoir.input_weight
    columns *= dynamics.input_scaling
    return reservoirpy_nodes.Reservoir(
        W=dynamics.spectral_radius * reservoir.recurrent.toarray(),
        Win=columns[:, :-1],
        bias=reservoir.input_bias * columns[:, -1],
        lr=dynamics.leak_rate,
        activation="tanh",
    )


def squared(states):
    """States with every second neuron squared, as ReservoirPy's users do it (a node of theirs)."""
    odd = np.arange(states.shape[-1]) % 2 == 1
    return np.where(odd, states**2, states)


@pytest.mark.parametrize("backend", ["compiled", "scipy"])
@pytest.mark.parametrize(
    ("leak_rate", "readout"), [(1.0, "linear"), (0.5, "linear"), (0.8, "quadratic")]
)
def test_reservoirpy_gives_the_same_states_and_forecast(
    reservoir, signal, backend, leak_rate, readout
):
    dynamics = Dynamics(reservoir, 0.6, 0.7, backend, leak_rate, readout)
    seen = squared if readout == "quadratic" else np.asarray
    input_range = np.ptp(signal, axis=(0, 2))
    series = signal[:300, :, 0]
    node = reservoirpy_reservoir(dynamics)
    expected = node.run(series / input_range)
    panels = dynamics.state_panels((series / input_range)[:, :, None], columns_per_panel=128)
    states = np.concatenate([panel.columns for panel in panels], axis=1)
    np.testing.assert_allclose(states.T, expected, rtol=0, atol=1e-13)

    accumulator = MomentsAccumulator(reservoir.neurons, reservoir.dimension)
    accumulator.add(dynamics.features(states[:, 50:-1]), series[51:].T)
    weights = solve_ridge(accumulator.moments(), 1e-4).weights
    node_readout = reservoirpy_nodes.Ridge(Wout=weights[:-1], bias=weights[-1])
    outputs, _ = dynamics.closed_loop(weights, input_range, states[:, -1:], 20)
    state = expected[-1]
    for step in range(20):
        predicted = node_readout(seen(state))
        np.testing.assert_allclose(outputs[step, :, 0], predicted, rtol=0, atol=1e-9)
        state = node(predicted / input_range)


@pytest.mark.parametrize("tikhonov", [1.0, 1e-6])
def test_scikit_learn_gives_the_same_weights(reservoir, signal, tikhonov):
    dynamics = Dynamics(reservoir, 0.4, 0.5, "scipy")
    (panel,) = dynamics.state_panels(signal[:-1], columns_per_panel=10**6)
    targets = signal[1:].transpose(1, 0, 2).reshape(reservoir.dimension, -1)
    accumulator = MomentsAccumulator(reservoir.neurons, reservoir.dimension)
    accumulator.add(panel.columns, targets)
    weights = solve_ridge(accumulator.moments(), tikhonov).weights
    # The paper regularises the output bias too: it is the weight of one more, constant state.
    rows = np.vstack([panel.columns, np.ones(panel.columns.shape[1])]).T
    model = linear_model.Ridge(alpha=tikhonov, fit_intercept=False, solver="cholesky")
    expected = model.fit(rows, targets.T).coef_.T
    np.testing.assert_allclose(weights, expected, rtol=0, atol=1e-6 * np.abs(expected).max())

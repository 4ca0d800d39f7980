"""The linearised closed loop against finite differences of the closed loop itself."""

import numpy as np
import pytest

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.readout import Readout
from burstcast.esn.reservoir import make_reservoir
from burstcast.esn.tangent import ClosedLoopTangent


@pytest.fixture(
    params=[
        ("compiled", 1.0, "linear"),
        ("scipy", 1.0, "linear"),
        ("compiled", 1.0, "quadratic"),
        ("compiled", 0.4, "linear"),
        ("scipy", 0.6, "quadratic"),
    ],
    ids=lambda param: "-".join(map(str, param)),
)
def network(request):
    """Of no use, but with a bounded flow and every kind of connection."""
    generator = np.random.default_rng(8)
    reservoir = make_reservoir(60, 3, 6, 0.1, generator)
    readout = Readout(generator.normal(0, 0.4, (61, 3)), 1e-6, "cholesky", 1.0)
    dynamics = Dynamics(reservoir, 0.8, 0.7, *request.param)
    return EchoStateNetwork(dynamics, readout, np.array([1.0, 2.5, 0.4]))


def perturbed(shape, seed=9):
    return np.random.default_rng(seed).normal(size=shape)


def test_perturbations_grow_as_finite_differences(network):
    states = np.random.default_rng(1).uniform(-0.9, 0.9, (60, 5))
    tangent = perturbed((60, 4, 5))
    following, grown = ClosedLoopTangent(network).advance(states, tangent, 6)
    np.testing.assert_array_equal(following, network.forecast(states, 6)[1])
    step = 1e-6
    for number in range(4):
        ahead, behind = (
            network.forecast(states + sign * step * tangent[:, number], 6)[1] for sign in (1, -1)
        )
        difference = (ahead - behind) / (2 * step)
        np.testing.assert_allclose(grown[:, number], difference, rtol=0, atol=2e-8)
    # the network's feedback counts, and not only its recurrence
    recurrent = network.dynamics.reservoir.recurrent * network.dynamics.spectral_radius
    after, one = ClosedLoopTangent(network).advance(states, tangent, 1)
    leak = network.dynamics.leak_rate
    reached = states + (after - states) / leak
    alone = (1 - leak) * tangent[:, 0] + leak * (1 - reached**2) * (recurrent @ tangent[:, 0])
    assert np.abs(one[:, 0] - alone).max() > 0.1


def test_perturbations_do_not_depend_on_the_batch(network):
    states = np.random.default_rng(2).uniform(-0.9, 0.9, (60, 19))
    tangent = perturbed((60, 3, 19))
    advance = ClosedLoopTangent(network).advance
    together = advance(states, tangent, 4)
    for index in (0, 7, 18):
        chosen = slice(index, index + 1)
        alone = advance(states[:, chosen].copy(), tangent[:, :, chosen].copy(), 4)
        for one, all_of_them in zip(alone, together, strict=True):
            np.testing.assert_array_equal(one, all_of_them[..., chosen])


def test_nothing_that_is_given_is_changed(network):
    states, tangent = np.full((60, 2), 0.1), perturbed((60, 2, 2))
    before = tangent.copy()
    ClosedLoopTangent(network).advance(states, tangent, 2)
    np.testing.assert_array_equal(tangent, before)
    assert (states == 0.1).all()

"""Open and closed loops, their linearisation, and the compiled step."""

import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse

from burstcast.networks import backend_compiled
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.readout import Readout
from burstcast.networks.reservoir import Reservoir, make_reservoir
from burstcast.networks.tangent import ClosedLoopTangent
from helpers_library import textbook_step

BACKENDS = ["compiled", "scipy"]
RANGE = np.array([2.0, 0.5, 1.0, 3.0])


KINDS = [(1.0, "linear"), (0.3, "linear"), (1.0, "quadratic"), (0.6, "quadratic")]


def random_readout(reservoir, generator):
    # Small enough for the closed loop to be a contraction: differences of rounding stay small.
    shape = (reservoir.neurons + 1, reservoir.dimension)
    return generator.normal(size=shape) / reservoir.neurons


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("leak_rate", "readout"), [KINDS[0], (0.7, "quadratic")])
def test_trajectories_depend_on_nothing_else(reservoir, backend, leak_rate, readout):
    """Not on their batch, on pauses, nor on how arrays lie in memory; and they change none."""
    generator = np.random.default_rng(3)
    dynamics = Dynamics(reservoir, 0.95, 0.6, backend, leak_rate, readout)
    weights = 30 * random_readout(reservoir, generator)  # chaotic: a changed bit would grow
    states = generator.uniform(-1, 1, size=(reservoir.neurons, 100))
    inputs, input_range = generator.normal(size=(20, reservoir.dimension, 100)), RANGE.copy()
    for array in (inputs, states, weights, input_range):
        array.flags.writeable = False
    outputs, final = dynamics.closed_loop(weights, input_range, states, 60)
    driven = dynamics.open_loop(inputs, states)
    stretches = [np.arange(*ends) for ends in ((0, 1), (57, 58), (30, 34), (40, 47), (11, 44))]
    for batch in (*stretches, generator.permutation(100), slice(None, None, 2)):
        part, last = dynamics.closed_loop(weights, RANGE, states[:, batch], 60)
        np.testing.assert_array_equal(part, outputs[:, :, batch])
        np.testing.assert_array_equal(last, final[:, batch])
        alone = dynamics.open_loop(inputs[:, :, batch], states[:, batch])
        np.testing.assert_array_equal(alone, driven[:, batch])
    first, between = dynamics.closed_loop(weights.copy(), RANGE, np.asfortranarray(states), 8)
    second, last = dynamics.closed_loop(weights, RANGE, between, 52)
    np.testing.assert_array_equal(np.concatenate([first, second]), outputs)
    np.testing.assert_array_equal(last, final)
    # no steps, and no trajectories
    nothing, same = dynamics.closed_loop(weights, RANGE, states, 0)
    assert nothing.shape == (0, 4, 100)
    np.testing.assert_array_equal(same, states)
    np.testing.assert_array_equal(dynamics.open_loop(inputs[:0], states), states)
    nothing, none = dynamics.closed_loop(weights, RANGE, states[:, :0], 5)
    assert (nothing.shape, none.shape) == ((5, 4, 0), (reservoir.neurons, 0))


@pytest.mark.parametrize("backend", BACKENDS)
def test_panels_hold_the_states_and_end_at_breakpoints(reservoir, signal, backend):
    dynamics = Dynamics(reservoir, 0.5, 1.0, backend)
    inputs = signal[:101]
    start = np.full((reservoir.neurons, 5), 0.1)
    panels = list(
        dynamics.state_panels(inputs, start, breakpoints=[70, 33, 33, 0], columns_per_panel=102)
    )
    ends = [0, 20, 33, 53, 70, 90, 101]
    assert [(panel.start, panel.stop) for panel in panels] == [*pairwise(ends)]
    for panel in panels:
        last = dynamics.open_loop(inputs[: panel.stop], start)
        np.testing.assert_array_equal(panel.states[:, -1], last)
        assert panel.columns.flags.c_contiguous
        assert np.shares_memory(panel.columns, panel.states)
        np.testing.assert_array_equal(panel.columns[:, 7], panel.states[:, 1, 2])


def test_tanh_is_accurate_to_a_few_units_in_the_last_place():
    # One neuron per sign and no recurrent weights: the state is tanh(input).
    reservoir = Reservoir(
        input_column=np.zeros(2, dtype=np.int32),
        input_weight=np.array([1.0, -1.0]),
        recurrent=scipy.sparse.csr_array((2, 2)),
        dimension=1,
        input_bias=0.0,
    )
    inputs = np.concatenate(
        [np.geomspace(1e-300, 1e3, 30001), np.linspace(0, 25, 50001), [0.0, 20.0, 1e300]]
    )
    states = Dynamics(reservoir, 1.0, 1.0, "compiled").open_loop(inputs[None, None, :])
    exact = np.tanh(inputs.astype(np.longdouble))
    error = np.abs(states[0] - exact) / np.spacing(exact.astype(float))
    assert error.max() < 8
    assert error.mean() < 1
    assert np.abs(states).max() <= 1 + np.finfo(float).eps
    np.testing.assert_array_equal(states[1], -states[0])


def test_the_compiler_is_loaded_by_the_first_network_that_runs_compiled():
    script = (
        "import sys, numpy as np\n"
        "from burstcast.networks.reservoir import make_reservoir\n"
        "from burstcast.networks.dynamics import Dynamics\n"
        "reservoir = make_reservoir(30, 2, 5, 0.1, np.random.default_rng(0))\n"
        "for backend in ('scipy', 'compiled'):\n"
        "    Dynamics(reservoir, 0.5, 1.0, backend).open_loop(np.zeros((2, 2, 1)))\n"
        "    print(*({'llvmlite'} & set(sys.modules)))\n"
    )
    output = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert output.stdout.splitlines() == ["", "llvmlite"]


def test_a_missing_compiler_says_what_to_do(reservoir, monkeypatch):
    monkeypatch.setitem(sys.modules, "llvmlite.binding", None)
    backend_compiled._function.cache_clear()
    with pytest.raises(RuntimeError, match='backend "scipy"'):
        Dynamics(reservoir, 0.5, 1.0, "compiled").open_loop(np.zeros((1, 4, 1)))


def test_bad_arguments_raise(reservoir):
    dynamics = Dynamics(reservoir, 0.0, 0.0, "scipy")  # neither memory nor inputs is no mistake
    neurons = reservoir.neurons
    inputs, states = np.zeros((3, 4, 2)), np.zeros((neurons, 2))
    weights = np.zeros((neurons + 1, 4))
    bad_input, bad_state, bad_weight = inputs.copy(), states.copy(), weights.copy()
    bad_input[1, 2, 0], bad_state[3, 1], bad_weight[0, 0] = np.inf, np.nan, np.nan
    opened, closed = dynamics.open_loop, dynamics.closed_loop
    leak, rates = "leak_rate must be above 0 and 1 at most", (0.0, -0.1, 1.1, np.nan)
    for call, reason in [
        *(
            (lambda rate=rate: Dynamics(reservoir, 0.5, 1.0, leak_rate=rate), leak)
            for rate in rates
        ),
        (lambda: Dynamics(reservoir, -0.1, 1.0), "spectral_radius"),
        (lambda: Dynamics(reservoir, 0.5, np.nan), "input_scaling"),
        (lambda: Dynamics(reservoir, 0.5, 1.0, "fortran"), "backend"),
        (lambda: Dynamics(reservoir, 0.5, 1.0, readout="cubic"), "'quadratic', not 'cubic'"),
        (lambda: opened(inputs[:, :3]), "inputs must have shape"),
        (lambda: opened(bad_input), "inputs of the network are not finite"),
        (lambda: opened(inputs, bad_state), "states are not finite"),
        (lambda: opened(inputs, states[:-1]), "states must have shape"),
        (lambda: opened(inputs, states[:, :1]), "do not fit"),
        (lambda: dynamics.state_panels(inputs, breakpoints=[4]), "breakpoints"),
        (lambda: closed(weights[:-1], RANGE, states, 3), "readout weights"),
        (lambda: closed(bad_weight, RANGE, states, 3), "weights are not finite"),
        (lambda: closed(weights, RANGE[:3], states, 3), "input range"),
        (lambda: closed(weights, 0 * RANGE, states, 3), "positive"),
        (lambda: closed(weights, RANGE, bad_state, 3), "states are not finite"),
        (lambda: closed(weights, RANGE, states, -1), "-1 steps"),
    ]:
        with pytest.raises(ValueError, match=reason):
            call()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("leak_rate", "readout"), KINDS)
@pytest.mark.parametrize(("neurons", "dimension"), [(60, 1), (61, 2), (71, 3)])
def test_loops_are_the_textbook_equations(backend, leak_rate, readout, neurons, dimension):
    """Of any number of neurons: blocks of the readout end anywhere."""
    generator = np.random.default_rng(6)
    reservoir = make_reservoir(neurons, dimension, 5, 0.1, generator)
    dynamics = Dynamics(reservoir, 0.9, 0.8, backend, leak_rate, readout)
    scale = 20 if readout == "quadratic" else 1
    weights, input_range = scale * random_readout(reservoir, generator), RANGE[:dimension]
    states = generator.uniform(-1, 1, size=(neurons, 18))
    inputs = generator.normal(size=(9, dimension, 18))
    driven, from_zero = dynamics.open_loop(inputs, states), dynamics.open_loop(inputs)
    outputs, final = dynamics.closed_loop(weights, input_range, states, 12)
    for trajectory in (0, 17):
        state, zero = states[:, trajectory], np.zeros(neurons)
        for current in inputs[:, :, trajectory]:
            state = textbook_step(dynamics, current, state)
            zero = textbook_step(dynamics, current, zero)
        np.testing.assert_allclose(driven[:, trajectory], state, rtol=0, atol=1e-14)
        np.testing.assert_allclose(from_zero[:, trajectory], zero, rtol=0, atol=1e-14)
        state = states[:, trajectory]
        for step in range(12):
            seen = [
                x * x if readout == "quadratic" and neuron % 2 else x
                for neuron, x in enumerate(state)
            ]
            np.testing.assert_array_equal(dynamics.features(state), seen)
            predicted = np.append(seen, 1) @ weights
            np.testing.assert_allclose(outputs[step, :, trajectory], predicted, atol=scale * 1e-13)
            state = textbook_step(dynamics, predicted / input_range, state)
        np.testing.assert_allclose(final[:, trajectory], state, rtol=0, atol=scale * 1e-13)


# -- the linearised closed loop --------------------------------------------------------------------


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
    after, rate = ClosedLoopTangent(network).advance(states, tangent, 1)
    leak = network.dynamics.leak_rate
    reached = states + (after - states) / leak
    alone = (1 - leak) * tangent[:, 0] + leak * (1 - reached**2) * (recurrent @ tangent[:, 0])
    assert np.abs(rate[:, 0] - alone).max() > 0.1


def test_perturbations_depend_on_no_batch_and_change_nothing_that_is_given(network):
    states = np.random.default_rng(2).uniform(-0.9, 0.9, (60, 19))
    tangent = perturbed((60, 3, 19))
    states.flags.writeable = tangent.flags.writeable = False
    advance = ClosedLoopTangent(network).advance
    together = advance(states, tangent, 4)
    for index in (0, 7, 18):
        chosen = slice(index, index + 1)
        alone = advance(states[:, chosen].copy(), tangent[:, :, chosen].copy(), 4)
        for rate, all_of_them in zip(alone, together, strict=True):
            np.testing.assert_array_equal(rate, all_of_them[..., chosen])

import subprocess
import sys

import numpy as np
import pytest
import scipy.sparse

from burstcast.esn import backend_compiled
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.reservoir import Reservoir, make_reservoir

BACKENDS = ["compiled", "scipy"]
RANGE = np.array([2.0, 0.5, 1.0, 3.0])


def textbook_step(dynamics, current, state):
    """One step of one trajectory with dense matrices."""
    reservoir = dynamics.reservoir
    input_matrix = np.zeros((reservoir.neurons, reservoir.dimension + 1))
    input_matrix[np.arange(reservoir.neurons), reservoir.input_column] = reservoir.input_weight
    fed = np.append(current, reservoir.input_bias)
    return np.tanh(
        dynamics.input_scaling * input_matrix @ fed
        + dynamics.spectral_radius * reservoir.recurrent.toarray() @ state
    )


def random_readout(reservoir, generator):
    # Small enough for the closed loop to be a contraction: differences of rounding stay small.
    shape = (reservoir.neurons + 1, reservoir.dimension)
    return generator.normal(size=shape) / reservoir.neurons


@pytest.mark.parametrize("backend", BACKENDS)
def test_open_loop_is_the_textbook_equation(reservoir, backend):
    generator = np.random.default_rng(0)
    dynamics = Dynamics(reservoir, 0.7, 1.3, backend)
    inputs = generator.normal(size=(12, reservoir.dimension, 3))
    states = generator.uniform(-1, 1, size=(reservoir.neurons, 3))
    final = dynamics.open_loop(inputs, states)
    from_zero = dynamics.open_loop(inputs)
    for series in range(3):
        state, zero = states[:, series], np.zeros(reservoir.neurons)
        for current in inputs[:, :, series]:
            state = textbook_step(dynamics, current, state)
            zero = textbook_step(dynamics, current, zero)
        np.testing.assert_allclose(final[:, series], state, rtol=0, atol=1e-14)
        np.testing.assert_allclose(from_zero[:, series], zero, rtol=0, atol=1e-14)


@pytest.mark.parametrize("backend", BACKENDS)
def test_without_an_input_bias_the_reservoir_is_an_odd_function_of_its_inputs(backend):
    """Even terms of the readout's map, such as products, come from the bias alone."""
    generator = np.random.default_rng(5)
    inputs = generator.normal(size=(12, 3, 2))
    odd, biased = (
        Dynamics(make_reservoir(61, 3, 5, bias, np.random.default_rng(0)), 0.7, 1.3, backend)
        for bias in (0.0, 0.1)
    )
    np.testing.assert_allclose(odd.open_loop(-inputs), -odd.open_loop(inputs), rtol=0, atol=1e-14)
    assert np.abs(biased.open_loop(-inputs) + biased.open_loop(inputs)).max() > 0.01


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_closed_loop_is_the_textbook_equation(backend, dimension):
    generator = np.random.default_rng(1)
    reservoir = make_reservoir(61, dimension, 5, 0.1, generator)
    dynamics = Dynamics(reservoir, 0.9, 0.8, backend)
    weights = random_readout(reservoir, generator)
    input_range = RANGE[:dimension]
    states = generator.uniform(-1, 1, size=(reservoir.neurons, 2))
    outputs, final = dynamics.closed_loop(weights, input_range, states, 15)
    for trajectory in range(2):
        state = states[:, trajectory]
        for step in range(15):
            predicted = np.append(state, 1) @ weights
            np.testing.assert_allclose(outputs[step, :, trajectory], predicted, atol=1e-13)
            state = textbook_step(dynamics, predicted / input_range, state)
        np.testing.assert_allclose(final[:, trajectory], state, rtol=0, atol=1e-13)


def test_compiled_and_scipy_agree_to_rounding(reservoir):
    generator = np.random.default_rng(2)
    weights = 5 * random_readout(reservoir, generator)
    states = generator.uniform(-1, 1, size=(reservoir.neurons, 19))
    results = [
        Dynamics(reservoir, 0.9, 1.0, backend).closed_loop(weights, RANGE, states, 30)
        for backend in BACKENDS
    ]
    for compiled, plain in zip(*results, strict=True):
        np.testing.assert_allclose(compiled, plain, rtol=0, atol=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_trajectory_has_the_same_bits_in_any_batch(reservoir, backend):
    generator = np.random.default_rng(3)
    dynamics = Dynamics(reservoir, 0.95, 0.6, backend)
    weights = 30 * random_readout(reservoir, generator)  # chaotic: a changed bit would grow
    states = generator.uniform(-1, 1, size=(reservoir.neurons, 100))
    inputs = generator.normal(size=(20, reservoir.dimension, 100))
    outputs, final = dynamics.closed_loop(weights, RANGE, states, 60)
    driven = dynamics.open_loop(inputs, states)
    batches = [
        np.array([0]),
        np.array([57]),
        np.arange(30, 34),
        np.arange(40, 47),
        np.arange(11, 44),
        generator.permutation(100),
    ]
    for batch in batches:
        part, last = dynamics.closed_loop(weights, RANGE, states[:, batch], 60)
        np.testing.assert_array_equal(part, outputs[:, :, batch])
        np.testing.assert_array_equal(last, final[:, batch])
        np.testing.assert_array_equal(
            dynamics.open_loop(inputs[:, :, batch], states[:, batch]), driven[:, batch]
        )


@pytest.mark.parametrize("backend", BACKENDS)
def test_forecast_continues_from_its_states(reservoir, backend):
    generator = np.random.default_rng(4)
    dynamics = Dynamics(reservoir, 0.9, 1.0, backend)
    weights = 10 * random_readout(reservoir, generator)
    states = generator.uniform(-1, 1, size=(reservoir.neurons, 18))
    kept = states.copy()
    whole, final = dynamics.closed_loop(weights, RANGE, states, 25)
    first, between = dynamics.closed_loop(weights, RANGE, states, 8)
    second, last = dynamics.closed_loop(weights, RANGE, between, 17)
    np.testing.assert_array_equal(np.concatenate([first, second]), whole)
    np.testing.assert_array_equal(last, final)
    np.testing.assert_array_equal(states, kept)


@pytest.mark.parametrize("backend", BACKENDS)
def test_no_steps_and_no_trajectories(reservoir, backend):
    dynamics = Dynamics(reservoir, 0.9, 1.0, backend)
    weights = random_readout(reservoir, np.random.default_rng(0))
    states = np.full((reservoir.neurons, 3), 0.25)
    outputs, final = dynamics.closed_loop(weights, RANGE, states, 0)
    assert outputs.shape == (0, 4, 3)
    np.testing.assert_array_equal(final, states)
    np.testing.assert_array_equal(dynamics.open_loop(np.empty((0, 4, 3)), states), states)
    outputs, final = dynamics.closed_loop(weights, RANGE, states[:, :0], 5)
    assert outputs.shape == (5, 4, 0)
    assert final.shape == (reservoir.neurons, 0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_panels_hold_the_states_and_end_at_breakpoints(reservoir, signal, backend):
    dynamics = Dynamics(reservoir, 0.5, 1.0, backend)
    inputs = signal[:101]
    start = np.full((reservoir.neurons, 5), 0.1)
    panels = list(
        dynamics.state_panels(inputs, start, breakpoints=[70, 33, 33, 0], columns_per_panel=102)
    )
    assert [(panel.start, panel.stop) for panel in panels] == [
        (0, 20),
        (20, 33),
        (33, 53),
        (53, 70),
        (70, 90),
        (90, 101),
    ]
    for panel in panels:
        last = dynamics.open_loop(inputs[: panel.stop], start)
        np.testing.assert_array_equal(panel.states[:, -1], last)
        assert panel.columns.flags.c_contiguous
        assert np.shares_memory(panel.columns, panel.states)
        np.testing.assert_array_equal(panel.columns[:, 7], panel.states[:, 1, 2])
    states = start
    for step, current in enumerate(inputs):
        states = dynamics.open_loop(current[None], states)
        panel = next(panel for panel in panels if panel.start <= step < panel.stop)
        np.testing.assert_array_equal(panel.states[:, step - panel.start], states)


@pytest.mark.parametrize("backend", BACKENDS)
def test_read_only_and_strided_arrays_are_welcome(reservoir, backend):
    generator = np.random.default_rng(5)
    dynamics = Dynamics(reservoir, 0.9, 1.0, backend)
    inputs = generator.normal(size=(3, 4, 17))
    states = generator.uniform(-1, 1, size=(reservoir.neurons, 17))
    weights = random_readout(reservoir, generator)
    arrays = [inputs, states, weights, RANGE.copy()]
    for array in arrays:
        array.flags.writeable = False
    np.testing.assert_array_equal(
        dynamics.open_loop(inputs[:, :, ::2], states[:, ::2]),
        dynamics.open_loop(inputs, states)[:, ::2],
    )
    read_only, _ = dynamics.closed_loop(weights, arrays[3], states, 3)
    plain, _ = dynamics.closed_loop(weights.copy(), RANGE, np.asfortranarray(states), 3)
    np.testing.assert_array_equal(read_only, plain)


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
        "from burstcast.esn.reservoir import make_reservoir\n"
        "from burstcast.esn.dynamics import Dynamics\n"
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
    backend_compiled._drive_of.cache_clear()
    with pytest.raises(RuntimeError, match='backend "scipy"'):
        Dynamics(reservoir, 0.5, 1.0, "compiled").open_loop(np.zeros((1, 4, 1)))


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"spectral_radius": -0.1}, "spectral_radius"),
        ({"input_scaling": np.nan}, "input_scaling"),
        ({"backend": "fortran"}, "backend"),
    ],
)
def test_impossible_hyperparameters_raise(reservoir, changed, reason):
    arguments = {"spectral_radius": 0.5, "input_scaling": 1.0, "backend": "scipy", **changed}
    with pytest.raises(ValueError, match=reason):
        Dynamics(reservoir, **arguments)


def test_a_network_may_have_neither_memory_nor_inputs(reservoir):
    assert Dynamics(reservoir, 0.0, 0.0).spectral_radius == 0.0


def test_bad_arguments_raise(reservoir):
    dynamics = Dynamics(reservoir, 0.5, 1.0, "scipy")
    neurons = reservoir.neurons
    inputs, states = np.zeros((3, 4, 2)), np.zeros((neurons, 2))
    weights = np.zeros((neurons + 1, 4))
    bad_input, bad_state, bad_weight = inputs.copy(), states.copy(), weights.copy()
    bad_input[1, 2, 0] = np.inf
    bad_state[3, 1] = np.nan
    bad_weight[0, 0] = np.nan
    calls = [
        (lambda: dynamics.open_loop(inputs[:, :3]), "inputs must have shape"),
        (lambda: dynamics.open_loop(bad_input), "inputs of the network are not finite"),
        (lambda: dynamics.open_loop(inputs, bad_state), "states are not finite"),
        (lambda: dynamics.open_loop(inputs, states[:-1]), "states must have shape"),
        (lambda: dynamics.open_loop(inputs, states[:, :1]), "do not fit"),
        (lambda: dynamics.state_panels(inputs, breakpoints=[4]), "breakpoints"),
        (lambda: dynamics.closed_loop(weights[:-1], RANGE, states, 3), "readout weights"),
        (lambda: dynamics.closed_loop(bad_weight, RANGE, states, 3), "weights are not finite"),
        (lambda: dynamics.closed_loop(weights, RANGE[:3], states, 3), "input range"),
        (lambda: dynamics.closed_loop(weights, 0 * RANGE, states, 3), "positive"),
        (lambda: dynamics.closed_loop(weights, RANGE, bad_state, 3), "states are not finite"),
        (lambda: dynamics.closed_loop(weights, RANGE, states, -1), "-1 steps"),
    ]
    for call, reason in calls:
        with pytest.raises(ValueError, match=reason):
            call()


KINDS = [(0.3, "linear"), (1.0, "quadratic"), (0.6, "quadratic")]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("leak_rate", "readout"), KINDS)
@pytest.mark.parametrize("neurons", [60, 61, 71])  # blocks of the readout end anywhere
def test_leaking_neurons_and_squares_are_plain_loops(backend, leak_rate, readout, neurons):
    generator = np.random.default_rng(6)
    reservoir = make_reservoir(neurons, 3, 5, 0.1, generator)
    dynamics = Dynamics(reservoir, 0.9, 0.8, backend, leak_rate, readout)
    weights, input_range = 20 * random_readout(reservoir, generator), RANGE[:3]
    states = generator.uniform(-1, 1, size=(neurons, 18))
    inputs = generator.normal(size=(9, 3, 18))
    driven = dynamics.open_loop(inputs, states)
    outputs, final = dynamics.closed_loop(weights, input_range, states, 7)
    for trajectory in (0, 17):
        state = states[:, trajectory]
        for current in inputs[:, :, trajectory]:
            reached = textbook_step(dynamics, current, state)
            state = [
                (1 - leak_rate) * x + leak_rate * y for x, y in zip(state, reached, strict=True)
            ]
        np.testing.assert_allclose(driven[:, trajectory], state, rtol=0, atol=1e-14)
        state = states[:, trajectory]
        for step in range(7):
            seen = [
                x * x if readout == "quadratic" and neuron % 2 else x
                for neuron, x in enumerate(state)
            ]
            np.testing.assert_array_equal(dynamics.features(np.asarray(state)), seen)
            predicted = np.append(seen, 1) @ weights
            np.testing.assert_allclose(outputs[step, :, trajectory], predicted, atol=1e-11)
            reached = textbook_step(dynamics, predicted / input_range, state)
            state = [
                (1 - leak_rate) * x + leak_rate * y for x, y in zip(state, reached, strict=True)
            ]
        np.testing.assert_allclose(final[:, trajectory], state, rtol=0, atol=1e-11)


@pytest.mark.parametrize("backend", BACKENDS)
def test_leaking_trajectories_have_the_same_bits_in_any_batch(reservoir, backend):
    generator = np.random.default_rng(7)
    dynamics = Dynamics(reservoir, 0.95, 0.6, backend, 0.7, "quadratic")
    weights = 30 * random_readout(reservoir, generator)
    states = generator.uniform(-1, 1, size=(reservoir.neurons, 40))
    together = dynamics.closed_loop(weights, RANGE, states, 60)
    for batch in (np.array([17]), generator.permutation(40)):
        alone = dynamics.closed_loop(weights, RANGE, states[:, batch], 60)
        for one, all_of_them in zip(alone, together, strict=True):
            np.testing.assert_array_equal(one, all_of_them[..., batch])


@pytest.mark.parametrize("leak_rate", [0.0, -0.1, 1.1, np.nan])
def test_impossible_leak_rates_are_refused(reservoir, leak_rate):
    with pytest.raises(ValueError, match="leak_rate must be above 0 and 1 at most"):
        Dynamics(reservoir, 0.5, 1.0, leak_rate=leak_rate)


def test_unknown_readouts_are_refused(reservoir):
    with pytest.raises(ValueError, match="'linear' or 'quadratic', not 'cubic'"):
        Dynamics(reservoir, 0.5, 1.0, readout="cubic")

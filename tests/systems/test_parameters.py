"""Parameters and their schedules; observables of measured series; arithmetic expressions."""

import json
import re

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from burstcast.base.expressions import Expression
from burstcast.control.actuation import ActuatorShare, actuated_system
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.parameters import Parameters, SystemParameters, integrate_scheduled
from burstcast.systems.state_space import component_names, make_measured

MFE = MoehlisFaisstEckhardt(400.0)
REYNOLDS = SystemParameters.of(MFE, ["reynolds"])
PUSH = [0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]


def states(batch, seed=3):
    return 0.1 * np.random.default_rng(seed).standard_normal((9, batch))


def telegraph(steps, batch, values, seed=5):
    """Every trajectory changes its value at steps of its own."""
    generator = np.random.default_rng(seed)
    which = np.cumsum(generator.random((steps, batch)) < 0.2, axis=0) % len(values)
    return np.asarray(values)[which][:, np.newaxis, :]


LORENZ = SystemParameters.of(Lorenz63(), ["rho", "sigma"])


@pytest.mark.parametrize(
    ("parameters", "schedule"),
    [
        (REYNOLDS, telegraph(20, 9, (400.0, 500.0, 2000.0))),
        (REYNOLDS, telegraph(20, 30, tuple(range(300, 330)))),  # more values than are compiled
        (REYNOLDS, REYNOLDS.constant(20, 3, [650.0])),
        (ActuatorShare.of(MFE, {}, PUSH), telegraph(20, 4, (0.0, 1.0, -1.0, 0.4))),
        (LORENZ, np.repeat([[28.0, 10.0], [25.0, 10.0], [25.0, 8.0]], 4, axis=0)[..., np.newaxis]),
    ],
)
def test_integrate_scheduled_is_plain_integration_of_each_trajectory_bit_for_bit(
    parameters, schedule
):
    assert LORENZ.defaults == (28.0, 10.0)
    start = states(schedule.shape[2])[: parameters.system(parameters.defaults).dimension]
    result = integrate_scheduled(parameters, schedule, start, 0.02, 4)
    for flow, state in enumerate(start.T):
        expected = [state[:, np.newaxis]]
        for values in schedule[..., flow]:
            system = parameters.system(values.tolist())
            expected.append(integrate(system, expected[-1], 0.02, 4, 4)[-1])
        assert np.array_equal(result[..., [flow]], expected)


def test_the_share_of_an_actuator():
    share = ActuatorShare.of(MFE, {"reynolds": 2000.0}, PUSH)
    assert share.names == ("share",)
    assert share.defaults == (0.0,)
    assert share.system([0.0]) is MFE
    assert share.system([0.25]) is share.system([0.25])
    state = states(4)
    for strength in (0.25, 1.0):
        expected = actuated_system(MFE, {"reynolds": 2000.0}, PUSH, strength)
        assert np.array_equal(
            share.system([strength]).right_hand_side(state), expected.right_hand_side(state)
        )


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: SystemParameters.of(MFE, ["reynold"]), "did you mean 'reynolds'"),
        (lambda: SystemParameters.of(MFE, []), "a value for each name"),
        (lambda: Parameters(("flow",), (1.0, 2.0)), "a value for each name"),
        (lambda: Parameters(("flow",), (1.0,)).system([1.0]), "no equations are known"),
        (lambda: ActuatorShare.of(MFE, {}), "changes a parameter"),
        (lambda: REYNOLDS.check(np.ones((4, 1, 2)), 5, 2), r"shape \(5, 1, 2\)"),
        (lambda: REYNOLDS.check(np.full((4, 1, 2), np.nan), 4, 2), "must be finite"),
        (
            lambda: integrate_scheduled(REYNOLDS, np.ones((4, 2, 3)), states(3), 0.25),
            r"shape \(4, 1, 3\)",
        ),
        (lambda: MeasuredSeries(["x"], "flow rate [l/s]").appended, "is no arithmetic expression"),
    ],
)
def test_what_does_not_fit_is_refused(made, message):
    with pytest.raises(ValueError, match=message):
        made()


# -- measured series -------------------------------------------------------------------------------

STATES = np.random.default_rng(1).normal(size=(3, 4, 5))


def test_the_observable_is_a_component_or_an_expression_of_components_or_one_of_its_own():
    series = MeasuredSeries(["x", "flow rate [l/s]", "z"], "flow rate [l/s]")
    assert (series.dimension, series.appended) == (3, False)
    result = series.observable(STATES)
    assert np.array_equal(result, STATES[1])
    result[:] = 0.0
    assert STATES[1].any()
    series = MeasuredSeries(["x", "y", "z"], "x**2 + y * z")
    assert (series.dimension, series.appended) == (3, False)
    x, y, z = STATES
    assert np.array_equal(series.observable(STATES), x * x + y * z)
    assert np.array_equal(series.observable(STATES[:, 0, 0]), (x * x + y * z)[0, 0])
    series = MeasuredSeries(["x", "y"], "x + dissipation")
    assert (series.dimension, series.appended) == (3, True)
    assert series.component_names == ("x", "y", "x + dissipation")
    assert np.array_equal(series.observable(STATES), STATES[2])


def test_what_it_is_called():
    assert MeasuredSeries(["q"], "q").observable_symbol == "q"
    assert MeasuredSeries(["q_1"], "q_1").observable_symbol == r"\mathrm{q\_1}"
    assert MeasuredSeries(["q"], "-glucose").observable_symbol == r"-\mathrm{glucose}"
    assert MeasuredSeries(["q"], "q**2").observable_symbol == r"\mathrm{observable}"
    assert MeasuredSeries(["q"], "exp(q)", "discharge").observable_symbol == r"\mathrm{discharge}"
    named = MeasuredSeries(["q"], "-q", "depth", "d")
    assert (named.observable_name, named.observable_symbol) == ("depth", "d")


def test_from_what_settings_say():
    description = {"components": ["x", "y"], "observable_of": "x"}
    made = make_measured(json.loads(json.dumps(description)))
    assert made == MeasuredSeries(("x", "y"), "x")


def test_names_of_the_components_of_systems():
    assert component_names(Lorenz63()) == ("x", "y", "z")
    assert component_names(MoehlisFaisstEckhardt(400.0))[::8] == ("a1", "a9")
    assert component_names(MeasuredSeries(["b"], "b")) == ("b",)


# -- expressions -----------------------------------------------------------------------------------

LEAVES = st.sampled_from(["u", "v", "w_2", "1", "0.5", "3e-1"])


def joined(parts):
    binary = st.tuples(parts, st.sampled_from(["+", "-", "*", "/"]), parts).map(
        lambda result: f"({result[0]} {result[1]} {result[2]})"
    )
    power = st.tuples(parts, st.sampled_from(["2", "3"])).map(lambda x: f"({x[0]})**{x[1]}")
    called = st.tuples(st.sampled_from(["sqrt", "abs", "exp", "log"]), parts).map(
        lambda result: f"{result[0]}({result[1]})"
    )
    return binary | power | called | parts.map(lambda part: f"(-{part})")


TEXTS = st.recursive(LEAVES, joined, max_leaves=8).map(lambda text: f"u + {text}")


class Quantity(np.ndarray):
    """Doubles whose whole powers are products, as documented: numpy's have other last bits."""

    def __pow__(self, exponent):
        return self * self if exponent == 2 else self * self * self


@given(TEXTS)
@example("u + (1 / (1 - 1))")
@example("u + (-((u / w_2))**3)")  # a difference of 1e-4, in which a last bit of a term is 1e-12
def test_values_are_those_of_python_and_each_index_by_itself(text):
    generator = np.random.default_rng(3)
    values = {name: generator.uniform(0.5, 1.5, 37) for name in ("u", "v", "w_2")}
    functions = {"sqrt": np.sqrt, "abs": np.abs, "exp": np.exp, "log": np.log}
    # Python's own numbers raise an error when they are divided by zero
    numbers = re.sub(r"\b(3e-1|0\.5|1)\b", r"double(\1)", text)
    scope = {name: value.view(Quantity) for name, value in values.items()} | functions
    scope["double"] = lambda number: np.array(number, float).view(Quantity)
    with np.errstate(all="ignore"):
        expected = eval(numbers, {"__builtins__": {}}, scope)
        result = Expression(text)(values)
    # the same operations in the same order: no difference cancels what terms do not share
    np.testing.assert_array_equal(result, expected.view(np.ndarray))
    for part in (slice(0, 1), slice(5, 12), slice(None, None, 3)):
        alone = Expression(text)({name: value[part] for name, value in values.items()})
        np.testing.assert_array_equal(alone, result[part])


def test_names_are_in_the_order_of_their_first_use_and_results_arrays_of_their_own():
    assert Expression("b * (a + b) - sqrt(c)").names == ("b", "a", "c")
    assert np.isnan(Expression("sqrt(u)")({"u": np.array([-1.0])})).all()
    values = {"u": np.ones(3)}
    result = Expression("u")(values)
    result[:] = 0.0
    assert values["u"].all()


def test_whole_powers_are_products_and_kinetic_energies_sums_to_the_last_bit():
    u = np.random.default_rng(6).normal(size=3000)
    product = u.copy()
    for exponent in range(2, 16):
        product = product * u
        assert np.array_equal(Expression(f"u**{exponent}")({"u": u}), product)
    for exponent in (0, 0.5, 16):
        result = Expression(f"abs(u)**{exponent}")({"u": u})
        np.testing.assert_allclose(result, np.abs(u) ** exponent, rtol=1e-14)
    states = np.random.default_rng(5).normal(size=(9, 40, 3))
    text = "0.5 * (" + " + ".join(f"a{i}**2" for i in range(1, 10)) + ")"
    result = Expression(text)({f"a{i}": states[i - 1] for i in range(1, 10)})
    assert np.array_equal(result, MoehlisFaisstEckhardt(400.0).observable(states))


NOT_UNDERSTOOD = """u[0] | u.real | u if v else w | u < v | u // v | u % v | u and v | u + 'text' |
u + True | u * 1j | sin(u) | sqrt(u, v) | sqrt(*u) | (lambda: u)() | __import__('os').system('x')"""


REFUSED = [(text.strip(), "is not understood") for text in NOT_UNDERSTOOD.split("|")]
REFUSED += [(text, "is no arithmetic expression") for text in ("", "u +", "u = 3")]
REFUSED += [(text, "beyond all doubles") for text in (f"u + 1{'0' * 400}", "u + 1e400")]
REFUSED += [("3 + 4", "names no quantity"), ("sqrt + u", "sqrt is a function")]
REFUSED += [("u + 'text'", "'text' is not understood")]


@pytest.mark.parametrize(("text", "part"), REFUSED)
def test_nothing_else_is_understood(text, part):
    with pytest.raises(ValueError, match=part):
        Expression(text)

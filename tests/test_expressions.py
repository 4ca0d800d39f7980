"""Arithmetic expressions against Python's own evaluation, and what they must refuse."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.systems.expressions import Expression
from burstcast.systems.mfe import MoehlisFaisstEckhardt

LEAVES = st.sampled_from(["u", "v", "w_2", "1", "0.5", "3e-1"])


def joined(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    binary = st.tuples(parts, st.sampled_from(["+", "-", "*", "/"]), parts).map(
        lambda found: f"({found[0]} {found[1]} {found[2]})"
    )
    power = st.tuples(parts, st.sampled_from(["2", "3"])).map(lambda x: f"({x[0]})**{x[1]}")
    called = st.tuples(st.sampled_from(["sqrt", "abs", "exp", "log"]), parts).map(
        lambda found: f"{found[0]}({found[1]})"
    )
    return binary | power | called | parts.map(lambda part: f"(-{part})")


TEXTS = st.recursive(LEAVES, joined, max_leaves=8).map(lambda text: f"u + {text}")


@given(TEXTS)
def test_values_are_those_of_python(text: str) -> None:
    generator = np.random.default_rng(3)
    values = {name: generator.uniform(0.5, 1.5, (2, 5)) for name in ("u", "v", "w_2")}
    functions = {"sqrt": np.sqrt, "abs": np.abs, "exp": np.exp, "log": np.log}
    with np.errstate(all="ignore"):
        expected = eval(text, {"__builtins__": {}}, {**values, **functions})
        found = Expression(text)(values)
    np.testing.assert_allclose(found, expected, rtol=1e-12, equal_nan=True)


@given(TEXTS)
def test_each_index_by_itself(text: str) -> None:
    generator = np.random.default_rng(4)
    values = {name: generator.uniform(0.5, 1.5, 37) for name in ("u", "v", "w_2")}
    whole = Expression(text)(values)
    for part in (slice(0, 1), slice(5, 12), slice(None, None, 3)):
        alone = Expression(text)({name: value[part] for name, value in values.items()})
        np.testing.assert_array_equal(alone, whole[part])


def test_names_in_the_order_of_their_first_use() -> None:
    assert Expression("b * (a + b) - sqrt(c)").names == ("b", "a", "c")


def test_kinetic_energy_to_the_last_bit() -> None:
    states = np.random.default_rng(5).normal(size=(9, 40, 3))
    text = "0.5 * (" + " + ".join(f"a{i}**2" for i in range(1, 10)) + ")"
    found = Expression(text)({f"a{i}": states[i - 1] for i in range(1, 10)})
    assert np.array_equal(found, MoehlisFaisstEckhardt(400.0).observable(states))


def test_whole_powers_are_products_to_the_last_bit() -> None:
    u = np.random.default_rng(6).normal(size=3000)
    product = u.copy()
    for exponent in range(2, 16):
        product = product * u
        assert np.array_equal(Expression(f"u**{exponent}")({"u": u}), product)
    for exponent in (0, 0.5, 16):
        found = Expression(f"abs(u)**{exponent}")({"u": u})
        np.testing.assert_allclose(found, np.abs(u) ** exponent, rtol=1e-14)


def test_no_value_is_nan() -> None:
    assert np.isnan(Expression("sqrt(u)")({"u": np.array([-1.0])})).all()


def test_the_result_is_an_array_of_its_own() -> None:
    values = {"u": np.ones(3)}
    found = Expression("u")(values)
    found[:] = 0.0
    assert values["u"].all()


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("", "is no arithmetic expression"),
        ("u +", "is no arithmetic expression"),
        ("u = 3", "is no arithmetic expression"),
        ("3 + 4", "names no quantity"),
        ("__import__('os').system('true')", "is not understood"),
        ("u.real", "u.real is not understood"),
        ("u[0]", "is not understood"),
        ("u if v else w", "is not understood"),
        ("u < v", "is not understood"),
        ("u // v", "is not understood"),
        ("u % v", "is not understood"),
        ("u and v", "is not understood"),
        ("u + 'text'", "'text' is not understood"),
        ("u + True", "True is not understood"),
        ("u * 1j", "1j is not understood"),
        ("sin(u)", r"sin\(u\) is not understood"),
        ("sqrt(u, v)", "is not understood"),
        ("sqrt(*u)", "is not understood"),
        ("sqrt + u", "sqrt is a function"),
        ("(lambda: u)()", "is not understood"),
    ],
)
def test_nothing_else_is_understood(text: str, part: str) -> None:
    with pytest.raises(ValueError, match=part):
        Expression(text)

import ast
from pathlib import Path

import numpy as np
import pytest

import burstcast
from burstcast.laminarisation import first_laminar_step, is_laminar

LIBRARY = Path(burstcast.__file__).parent


def test_a_value_above_the_threshold_is_laminar_and_the_threshold_itself_is_not():
    above = np.nextafter(0.48, 1)
    values = np.array([[0.1, 0.48, above], [np.nan, np.inf, 0.2]])
    expected = [[False, False, True], [False, True, False]]
    np.testing.assert_array_equal(is_laminar(values, 0.48), expected)
    assert not is_laminar(values, None).any()


@pytest.mark.parametrize("axis", [0, 1, -1])
def test_the_first_laminar_step_is_that_of_a_plain_loop(axis):
    observable = np.random.default_rng(1).uniform(size=(40, 40))
    observable[:3], observable[:, :3] = 0.1, 0.1
    series = np.moveaxis(observable, axis, 0).T
    steps = [next((i for i, k in enumerate(one) if k > 0.97), -1) for one in series]
    assert -1 in steps
    assert max(steps) > 3
    assert first_laminar_step(observable, 0.97, axis=axis).tolist() == steps
    assert (first_laminar_step(observable, None, axis=axis) == -1).all()


def test_the_criterion_is_written_once():
    order = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)
    compared = [
        ast.unparse(node)
        for path in LIBRARY.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Compare) and isinstance(node.ops[0], order)
    ]
    assert len(compared) > 100
    assert [text for text in compared if "laminarisation_threshold" in text] == []

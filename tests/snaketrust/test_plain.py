"""Parameters in plain form, and files by the rule's names for them."""

import math
from pathlib import Path

import numpy as np
import pytest
from snakemake.iocontainers import Namedlist

from snaketrust.plain import groups, named, plain


def listed(*items):
    """A list of Snakemake's of values, names with a value, and names with a list."""
    found = Namedlist()
    for item in items:
        name, value = item if isinstance(item, tuple) else (None, item)
        start, several = len(found), isinstance(value, list)
        found.extend(value if several else [value])
        if name:
            found._set_name(name, start, end=len(found) if several else None)
    return found


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ((1, [2.0, (3,)]), [1, [2, [3]]]),
        ({"b": 1, "a": np.float64(0.5)}, {"a": 0.5, "b": 1}),
        ({2: np.bool_(True), "x": None}, {"x": None, 2: True}),
        (np.int8(3), 3),
        (-0.0, 0),
    ],
)
def test_what_means_the_same_is_the_same(value, expected):
    assert repr(plain(value)) == repr(expected)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({1, 2}, "set"),
        (Path("x"), "Path"),
        (np.zeros(2), "ndarray"),
        (math.nan, "params is nan"),
        ({"a": [math.inf]}, r"params.a\[0\] is inf"),
        ({1.5: 0}, "the key 1.5"),
        (b"bytes", "bytes"),
        (1j, "complex"),
    ],
)
def test_what_cannot_be_compared_is_refused_by_its_place(value, words):
    with pytest.raises((TypeError, ValueError), match=words):
        plain(value, "params")


def test_parameters_without_names_are_told_by_their_places():
    assert named(listed(1, ("low", 2))) == {"0": 1, "low": 2}


def test_files_are_told_by_names_and_places():
    """Outputs ``a=[x, y], a1=z`` are none of ``a=[x], a1=[y, z]``."""
    x, y, z = "xyz"
    assert groups(listed(("a", [x, y]), ("a1", z)), [x, y, z]) == {"a": [0, 1], "a1": 2}
    assert groups(listed(("a", [x]), ("a1", [y, z])), [x, y, z]) == {"a": [0], "a1": [1, 2]}
    assert groups(listed(x, ("a", y), ("b", x)), [x, y, x]) == {"": [0], "a": 1, "b": 0}

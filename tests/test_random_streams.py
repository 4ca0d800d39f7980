import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast import random_streams

NAMES = st.lists(st.one_of(st.text(max_size=6), st.integers(-5, 10**20)), min_size=1, max_size=4)


def first_numbers(*names, root_seed=2022):
    return random_streams.stream(root_seed, *names).random(4).tolist()


@given(NAMES, NAMES)
def test_streams_are_the_same_only_if_their_names_are(left, right):
    same_names = [(type(name), name) for name in left] == [(type(name), name) for name in right]
    assert (first_numbers(*left) == first_numbers(*right)) == same_names


@pytest.mark.parametrize(
    ("left", "right"),
    [
        (("a", "b"), ("ab",)),
        (("a", "b"), ("a\x1fb",)),
        (("a", "b"), ("a'\x1f'b",)),
        (("1",), (1,)),
        (("reservoir", 11, 1), ("reservoir", 1, 11)),
        (("a",), ("a", "")),
    ],
)
def test_names_that_look_alike(left, right):
    assert first_numbers(*left) != first_numbers(*right)


def test_root_seeds_make_other_streams():
    assert first_numbers("noise", 1, root_seed=1) != first_numbers("noise", 1, root_seed=2)


def test_numpy_integers_are_integers():
    assert first_numbers("noise", np.int64(3)) == first_numbers("noise", 3)


def test_streams_stay_what_they_are():
    # results of finished campaigns hang on these numbers
    assert random_streams.stream(2022, "noise", "Re400", 3).integers(0, 10**9, 3).tolist() == STORED


STORED = [810069763, 687754866, 766571384]


def test_streams_are_uncorrelated():
    draws = np.array([random_streams.stream(1, "noise", row).normal(size=4000) for row in range(8)])
    correlation = np.corrcoef(draws)
    for one, other in itertools.combinations(range(8), 2):
        assert abs(correlation[one, other]) < 5 / np.sqrt(4000)


def test_the_seed_of_a_stream_is_its_generators():
    sequence = random_streams.seed_sequence(5, "optimiser", 1)
    expected = np.random.Generator(np.random.PCG64(sequence)).random()
    assert random_streams.stream(5, "optimiser", 1).random() == expected


def test_what_is_no_name_is_refused():
    with pytest.raises(ValueError, match="root seed"):
        random_streams.stream(-1, "noise")
    with pytest.raises(ValueError, match="needs a name"):
        random_streams.stream(1)
    with pytest.raises(TypeError):
        random_streams.stream(1, 0.5)  # type: ignore[arg-type]

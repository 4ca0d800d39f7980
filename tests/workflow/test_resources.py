"""Memory and time that jobs ask a scheduler for."""

import pytest
from snakemake.iocontainers import Wildcards

from burstcast_workflow.stages.resources import beyond_memory, memory_mib, minutes, resources_of


def asked(work, attempt=1, **wildcards):
    resources = resources_of(work)
    names = Wildcards(fromdict=wildcards)
    return tuple(resources[name](names, attempt) for name in ("mem_mb", "runtime"))


def test_training_asks_for_the_square_of_the_neurons_and_everything_else_for_a_constant():
    network = {"case": "Re400", "forecaster": "esn-N3000-RV-seed3"}
    assert asked("usual", **network) == asked("usual", case="Re400") == (500, 10)
    assert asked("short") == (500, 2)
    mib, time = asked("training", **network)
    # sixteen matrices of 3000 x 3000 numbers
    assert mib - 500 == pytest.approx(16 * 3000**2 * 8 / 2**20, abs=1)
    assert time == 100
    assert asked("training", case="Re400", reservoir="esn-N3000-seed3") == (mib, time)
    # a kind without neurons
    assert asked("training", case="Re400", forecaster="equations") == (500, 10)
    assert minutes("training", 6000) - 10 == 4 * (minutes("training", 3000) - 10)
    assert memory_mib("training", 500) < 600


def test_each_retry_asks_for_twice_as_much():
    network = {"case": "Re400", "forecaster": "esn-N1000-RV-seed3"}
    first, second, third = (asked("training", attempt, **network) for attempt in (1, 2, 3))
    assert second == tuple(2 * amount for amount in first)
    assert third == tuple(4 * amount for amount in first)


def test_a_network_whose_gram_matrix_does_not_fit_is_refused():
    assert beyond_memory([500, 10_000], 1000) == ""
    text = beyond_memory([500, 20_000, 40_000], 8192)
    assert text.startswith("a network of 40000 neurons cannot be trained on this machine")
    assert "11.9 GiB" in text
    assert "8.0 GiB of memory" in text
    assert beyond_memory([]) == ""

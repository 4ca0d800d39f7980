"""Random edits of random workflows of other projects, compared with runs from scratch.

``SNAKETRUST_SEED`` and ``SNAKETRUST_WORKFLOWS`` choose which and how many.
"""

import os

import pytest
from random_workflows import trial

SEED = int(os.environ.get("SNAKETRUST_SEED", "0"))
WORKFLOWS = int(os.environ.get("SNAKETRUST_WORKFLOWS", "20"))
EDITS = 10


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(seed, marks=[pytest.mark.long] if seed > SEED else [])
        for seed in range(SEED, SEED + WORKFLOWS)
    ],
)
def test_random_edits_give_the_results_of_a_run_from_scratch_and_settle(seed, tmp_path):
    done = []
    for told, problem in trial(seed, EDITS, tmp_path / "trial"):
        done.append(told)
        assert not problem, (seed, done, problem)
    assert len(done) == EDITS

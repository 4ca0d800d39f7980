"""Lifetimes as files tell them."""

import numpy as np
import pytest

from burstcast.netcdf import Variable
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.lifetimes import lifetimes_of_training

KEPT = np.array([1, 2, 5, 6, 9])
LIFETIMES = np.array([3, 50, 50, 7, 9, 50, 50, 20, 30, 50, 11])


@pytest.fixture
def ensemble(tmp_path):
    """Writes an ensemble of eleven series, of which some are kept, in an order."""

    def write(kept):
        path = tmp_path / "ensemble.nc"
        write_netcdf(
            path,
            {
                "series": Variable(("series",), kept, "1", "number"),
                "lifetime": Variable(("generated",), LIFETIMES, "1", "lifetime"),
                "time": Variable(("time",), np.arange(51.0), "1", "time"),
            },
            {},
        )
        return str(path)

    return write


def test_those_of_training_end_with_its_last_series(ensemble):
    found = lifetimes_of_training(ensemble(KEPT), 3)
    assert found.steps.tolist() == [3, 50, 50, 7, 9, 50]
    assert found.escaped.tolist() == [True, False, False, True, True, False]
    assert found.length == 50


def test_nothing_of_later_series_enters(ensemble, monkeypatch):
    before = lifetimes_of_training(ensemble(KEPT), 3)
    monkeypatch.setitem(globals(), "LIFETIMES", np.where(np.arange(11) > 5, 1, LIFETIMES))
    after = lifetimes_of_training(ensemble(KEPT), 3)
    np.testing.assert_array_equal(before.steps, after.steps)


def test_other_series_of_the_ensemble_may_be_the_first(ensemble):
    # trained on the fourth and the fifth
    found = lifetimes_of_training(ensemble(KEPT[[3, 4, 2, 0, 1]]), 2)
    assert found.steps.tolist() == [50, 20, 30, 50]
    assert found.escaped.tolist() == [False, True, True, False]

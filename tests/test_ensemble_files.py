"""What the file of an ensemble says."""

import numpy as np

from burstcast.data.ensemble_files import ensemble_variables


def test_times_and_shares_of_an_ensemble() -> None:
    states = np.random.default_rng(1).normal(size=(3, 5, 2))
    lifetimes = np.array([4, 2, 4, 4])
    variables, summary = ensemble_variables(
        states, states[:, :, 0], "u", np.array([0, 2, 3]), lifetimes, 0.5
    )
    np.testing.assert_array_equal(variables["time"].data, [0.0, 0.5, 1.0, 1.5, 2.0])
    assert variables["state"].data is states
    assert summary == {
        "series_generated": 4,
        "series_kept": 3,
        "laminarised_fraction": 0.25,
        "mean_observable": states[:, :, 0].mean(),
    }

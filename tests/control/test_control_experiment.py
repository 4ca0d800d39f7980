"""What an experiment with control is given."""

import numpy as np

from burstcast.control.experiment import controlled_series, noise_of_flows
from burstcast.data import dataset

SCALES = dataset.Scales(np.array([1.0, 10.0]), np.ones(2))


def test_the_flows_begin_with_the_series_after_the_training() -> None:
    assert controlled_series(kept=40, training=10, wanted=20) == range(10, 30)
    assert controlled_series(kept=25, training=10, wanted=20) == range(10, 25)


def test_the_noise_of_a_flow_is_that_of_its_series_and_not_the_one_of_the_data() -> None:
    noise = noise_of_flows(range(10, 14), 6, 0.01, SCALES, 2022, "Re400")
    assert noise.shape == (4, 6, 2)
    one = noise_of_flows(range(12, 13), 6, 0.01, SCALES, 2022, "Re400")
    np.testing.assert_array_equal(one[0], noise[2])
    silence = np.zeros((4, 6, 2))
    observed = dataset.observed_series(silence, 10, 0.01, SCALES, 2022, "Re400")
    assert (noise != observed).all()

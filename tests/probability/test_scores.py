"""All scores of probabilities by name, with their resamples."""

import numpy as np
from helpers_probability import informative_sample

from burstcast.probability.outcomes import outcomes_by_series
from burstcast.probability.scores import probability_scores, resampled_scores
from burstcast.statistics.resampling import bootstrap_weights


def test_each_resample_is_scored_as_if_its_series_were_the_data():
    probability, happened, series = informative_sample()
    probability, number = np.round(probability, 2), int(series.max()) + 1
    scored = np.ones(len(series), dtype=bool)
    outcomes = outcomes_by_series(probability, happened, scored, series, number)
    weights = bootstrap_weights(number, 3, np.random.default_rng(5))
    found = resampled_scores(outcomes, weights, 0.4, 10)
    whole = probability_scores(outcomes.total(), 0.4, 10)
    for name, score in found.items():
        np.testing.assert_array_equal(score.value, whole[name])
    for row, drawn in enumerate(weights):
        points = np.concatenate(
            [np.flatnonzero(series == one) for one in np.repeat(np.arange(number), drawn)]
        )
        again = outcomes_by_series(
            probability[points], happened[points], scored[points], series[points], number
        )
        expected = probability_scores(again.total(), 0.4, 10)
        for name, score in found.items():
            np.testing.assert_allclose(score.samples[row], expected[name], err_msg=name)

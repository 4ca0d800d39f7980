"""Economic value against the expense of each single decision, and where it is known."""

import numpy as np
import pytest
from helpers_probability import count_by_series, samples
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from burstcast.probability.alarms import counts_at, false_alarm_rate
from burstcast.probability.economic_value import economic_value

RATIOS = st.floats(0.01, 0.99)


@settings(deadline=None)
@given(samples(), RATIOS)
def test_value_is_counted_decision_by_decision(sample, ratio):
    probability, happened, _ = sample
    assume(happened.any() and not happened.all())

    def expense(protected):
        return np.mean(
            [ratio if acted else hit for acted, hit in zip(protected, happened, strict=True)]
        )

    always, never = np.ones(len(happened), dtype=bool), np.zeros(len(happened), dtype=bool)
    climatology = min(expense(always), expense(never))
    saved = climatology - expense(probability >= ratio)
    expected = saved / (climatology - expense(happened))
    found = economic_value(count_by_series(*sample).total(), ratio)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)


@settings(deadline=None)
@given(samples())
def test_at_the_base_rate_value_is_the_peirce_skill_score(sample):
    happened = sample[1]
    assume(happened.any() and not happened.all())
    whole, rate = count_by_series(*sample).total(), float(happened.mean())
    counts = counts_at(whole, rate)
    expected = counts.recall - false_alarm_rate(counts)
    np.testing.assert_allclose(economic_value(whole, rate), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("ratio", [0.05, 0.3, 0.9])
def test_perfect_forecasts_and_climatology(ratio):
    happened = np.arange(40) % 5 == 0
    series = np.zeros(40, dtype=np.int64)
    perfect = count_by_series(happened.astype(float), happened, series).total()
    assert economic_value(perfect, ratio) == pytest.approx(1)
    climatology = count_by_series(np.full(40, 0.2), happened, series).total()
    assert economic_value(climatology, ratio) == pytest.approx(0, abs=1e-12)
    quiet = count_by_series(np.full(4, 0.2), np.zeros(4, dtype=bool), series[:4]).total()
    assert np.isnan(economic_value(quiet, ratio))

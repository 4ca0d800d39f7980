"""Forecasts and outcomes to score."""

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from burstcast.probability.outcomes import outcomes_by_series

SERIES = 6


def count_by_series(probability, happened, series, number=SERIES):
    """Outcomes by series, all points scored."""
    return outcomes_by_series(probability, happened, np.ones(len(series), bool), series, number)


@st.composite
def samples(draw, values=None, most=60):
    """Probabilities, outcomes and the series of each forecast."""
    count = draw(st.integers(1, most))
    values = st.floats(0, 1, width=16) if values is None else values
    return (
        draw(npst.arrays(np.float64, count, elements=values)),
        draw(npst.arrays(bool, count)),
        draw(npst.arrays(np.int64, count, elements=st.integers(0, SERIES - 1))),
    )


def informative_sample():
    """A thousand probabilities that are informative and not reliable, of forty series."""
    generator = np.random.default_rng(8)
    probability = np.round(generator.beta(0.4, 1.5, 1000), 2)
    happened = generator.random(1000) < 0.7 * probability + 0.05
    return probability, happened, generator.integers(0, 40, 1000)

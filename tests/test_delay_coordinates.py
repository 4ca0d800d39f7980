"""Delay coordinates: what they are, and what they are good for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.delay_coordinates import delay_coordinates, delayed_name
from burstcast.forecasters._options import options_of_kind
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries


@given(
    samples=st.integers(8, 30),
    delays=st.lists(st.integers(1, 7), max_size=4, unique=True),
    seed=st.integers(0, 99),
)
def test_value_by_value(samples: int, delays: list[int], seed: int) -> None:
    series = np.random.default_rng(seed).normal(size=(3, samples, 2))
    found = delay_coordinates(series, delays)
    longest = max(delays, default=0)
    assert found.shape == (3, samples - longest, 2 * (1 + len(delays)))
    for row in range(3):
        for step in range(samples - longest):
            now = step + longest
            expected = [series[row, now - back, i] for back in [0, *delays] for i in range(2)]
            assert found[row, step].tolist() == expected


def test_mistakes() -> None:
    series = np.zeros((2, 5, 1))
    with pytest.raises(ValueError, match=r"whole numbers above 0, not \[2, 0\]"):
        delay_coordinates(series, [2, 0])
    with pytest.raises(ValueError, match="reach back by 5 steps, but a series has 5 samples"):
        delay_coordinates(series, [5])
    assert delay_coordinates(series, [4]).shape == (2, 1, 2)


def error_of_analogues(x: np.ndarray, delays: list[int]) -> float:
    """Median error of x, half a Lyapunov time ahead, in series that were not learnt from."""
    series, lead, longest = delay_coordinates(x, delays), 27, max(delays, default=0)
    space = MeasuredSeries(["x", *(delayed_name("x", delay) for delay in delays)], "x")
    case = ForecastingCase(space, 0.005, 4, 55, options_of_kind("analogues"))
    forecaster = Analogues.fit(series[:8], case)
    now = np.arange(100, 900, 20)  # of the whole series
    seen = series[8:, now - longest].reshape(-1, series.shape[2])
    forecast, _ = forecaster.advance(forecaster.start(seen.T[np.newaxis]), lead)
    return float(np.median(np.abs(forecast[-1, 0] - x[8:, now + lead, 0].ravel())))


def test_the_past_of_one_component_tells_of_the_others() -> None:
    """Analogues have no memory: x of Lorenz's system alone does not tell where it goes."""
    start = np.array([[1.0, 1.0, 20.0]] * 12).T
    start += np.random.default_rng(3).uniform(-5, 5, start.shape)
    states = integrate(Lorenz63(), start, 0.01, 3000, stride=2)[500:].transpose(2, 0, 1)
    x = states[..., :1]
    alone, with_past = error_of_analogues(x, []), error_of_analogues(x, [4, 8])
    assert with_past < 0.25 * alone
    assert with_past < 0.1 * x.std()

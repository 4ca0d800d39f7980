"""Series of the shear flow at Re = 400 for short experiments, and scores of forecasts of them.

Training and test series, noise and starting points are those of a small campaign. Of the starting
points that no event follows, one in four is taken, with four times the weight. Intervals are of
resampled test series.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base import random_streams
from burstcast.control.arenas import LAMINAR_STATE
from burstcast.data.dataset import (
    add_observation_noise,
    component_scales,
    generate_ensemble,
    initial_states,
)
from burstcast.data.starting_points import SeriesPoints, segments, starting_points
from burstcast.forecasts.windows import (
    WindowForecasts,
    crosses,
    share_of_votes,
    summarise,
    window_boundaries,
)
from burstcast.systems.mfe import MoehlisFaisstEckhardt

SEED, STEPS_PER_LT, THRESHOLD, NOISE, WASHOUT = 87, 61, 0.1, 0.01, 30
TIMES = (1, 2, 3, 5)
SYSTEM = MoehlisFaisstEckhardt(400.0)
BOUNDARIES = window_boundaries(0.5, 11, STEPS_PER_LT)


def true_series(count: int, system: MoehlisFaisstEckhardt = SYSTEM) -> np.ndarray:
    """Series that do not laminarise, of ``count`` that are integrated."""
    generator = random_streams.stream(SEED, "initial states of experiments")
    kept = generate_ensemble(
        system,
        initial_states(LAMINAR_STATE, 3, 0.01, count, generator),
        time_step=0.25,
        sampling_stride=4,
        transient_steps=800,
        kept_steps=16000,
        laminarisation_threshold=0.48,
    )
    return np.concatenate([batch.states for batch in kept])


def with_noise(states: np.ndarray, training: slice) -> np.ndarray:
    """Series as they are observed; the noise is relative to the training series."""
    scales = component_scales(states[training])
    return add_observation_noise(states, 0, NOISE, scales, SEED, "noise of experiments")


@dataclass
class Starts:
    """Starting points 1 LT apart in some series, with quiet washouts.

    ``observable``: True one, ``(series, time)``; ``seen``: as it is observed. Points have 3 LT of
    observations before them, so that washouts of all lengths end at the same points.
    """

    observable: np.ndarray
    seen: np.ndarray
    steps_per_lyapunov_time: int = STEPS_PER_LT
    threshold: float = THRESHOLD
    washout: int = WASHOUT

    def __post_init__(self) -> None:
        count, length = self.observable.shape
        unit = self.steps_per_lyapunov_time
        self.boundaries = window_boundaries(0.5, 11, unit)
        points = starting_points(count, length, unit, 3 * unit, self.boundaries[-1])
        before = segments(self.seen[..., np.newaxis], points, self.washout - 1, 0)[..., 0]
        quiet = before.max(axis=1) < self.threshold
        points = SeriesPoints(points.series[quiet], points.step[quiet])
        ahead = segments(self.observable[..., np.newaxis], points, 0, self.boundaries[-1])
        ahead = ahead[:, 1:, 0]
        followed = (ahead >= self.threshold).any(axis=1)
        drawn = random_streams.stream(SEED, "points without events").random(len(followed)) < 0.25
        taken = followed | drawn
        self.points = SeriesPoints(points.series[taken], points.step[taken])
        self.weights = np.where(followed, 1.0, 4.0)[taken]
        truth = summarise(ahead[taken].T, self.boundaries)
        self.truth = np.array([crosses(truth, 2 * time - 1, 2, self.threshold) for time in TIMES])

    def washouts(self, observed: np.ndarray, steps: int) -> np.ndarray:
        """Observed washouts, ``(points, steps, component)``."""
        return segments(observed, self.points, steps - 1, 0)

    def scores(self, forecasts: WindowForecasts, resamples: int = 1000) -> dict[str, float]:
        """F of the majority of the members, its interval at 3 LT, and Brier skill of votes."""
        votes = np.array(
            [share_of_votes(forecasts.members, 2 * time - 1, 2, self.threshold) for time in TIMES]
        )
        alarms, number = votes >= 0.5, self.points.series.max() + 1

        def by_series(values: np.ndarray) -> np.ndarray:
            weighted = values * self.weights
            return np.array([np.bincount(self.points.series, row, number) for row in weighted])

        hits, raised, events = map(by_series, (alarms & self.truth, alarms, self.truth))
        drawn = random_streams.stream(SEED, "resampled series").multinomial(
            number, np.full(number, 1 / number), resamples
        )

        def f_score(times: np.ndarray) -> np.ndarray:
            return 2 * times @ hits.T / np.maximum(times @ (raised + events).T, 1e-9)

        values, many = f_score(np.ones(number)), f_score(drawn)
        low, high = np.percentile(many[:, TIMES.index(3)], [2.5, 97.5])
        error = by_series(np.square(votes - self.truth)).sum(axis=1) / self.weights.sum()
        rate = events.sum(axis=1) / self.weights.sum()
        skill = 1 - error / (rate * (1 - rate))
        scores = {f"f_{time}": value for time, value in zip(TIMES, values, strict=True)}
        scores |= {"f_3_low": low, "f_3_high": high}
        return scores | {f"brier_{time}": value for time, value in zip(TIMES, skill, strict=True)}

"""How often the intervals of `EventForecaster.scores` hold the truth, as a table in Markdown.

::

    python benchmarks/score_intervals.py [REPETITIONS]

Lorenz 63, events of z at 40, windows one Lyapunov time ahead. A forecaster is fitted once: nearest
analogues on noisy series, which are middling, and learnt maps (`nvar`) on series without noise,
which are nearly perfect. Each repetition scores it on new series of one of four shapes, the last
two of which are cut into blocks of time; the truth is its score on many further series. Cells are
repetitions in per cent whose interval holds the truth: first that of the library, then that of a
percentile bootstrap over the same blocks.
"""

import argparse
import warnings
from typing import Any

import numpy as np

from burstcast import EventForecaster
from burstcast.base import random_streams
from burstcast.base.arrays import FloatArray
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.base.threads import single_threaded
from burstcast.data.starting_points import SeriesPoints
from burstcast.event_forecaster.score_intervals import EventOutcomes, blocks_of
from burstcast.forecasts.scores import Outcomes, outcomes_by_series, resampled_scores
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63

SAMPLING_INTERVAL, LYAPUNOV_TIME = 0.02, 1.104
BINS, REACH = 10, 110
"""Bins of the scores of reliability; samples to the end of the window."""
FORECASTERS = {"middling": ("analogues", 0.01), "nearly perfect": ("nvar", 0.0)}
"""Kinds and noise of the forecasters."""
SHAPES = {"20 series": (20, 1200), "40 short": (40, 500), "4 long": (4, 6000), "1 long": (1, 20000)}
"""Number of test series, and their samples."""
SCORES = (
    *("alarm_f_score", "alarm_precision", "alarm_recall", "brier_skill", "roc_area"),
    *("average_precision", "base_rate", "calibration_error", "reliability"),
)
TRUTH = 4000
"""Series that the truth is of."""


def series(shape: tuple[int, int], noise: float, seed: int) -> FloatArray:
    """Series ``(series, samples, 3)`` with Gaussian noise, in standard deviations."""
    count, samples = shape
    generator = np.random.default_rng(seed)
    start = np.array([[1.0], [1.0], [20.0]]) + generator.normal(size=(3, count))
    states = integrate(Lorenz63(), start, 0.01, 1000 + 2 * samples, stride=2)
    states = states[500 : 500 + samples].transpose(2, 0, 1)
    disturbed = states + noise * states.std(axis=(0, 1)) * generator.normal(size=states.shape)
    return np.asarray(disturbed)


def fitted(kind: str, noise: float) -> EventForecaster:
    """Forecaster of twelve series."""
    forecaster = EventForecaster(
        2,
        kind=kind,
        event_threshold=40.0,
        lyapunov_time=LYAPUNOV_TIME,
        sampling_interval=SAMPLING_INTERVAL,
        prediction_times=(1,),
    )
    return forecaster.fit(series((12, 1200), noise, 1))


def by_block(found: EventOutcomes) -> Outcomes:
    """Outcomes by the blocks that intervals resample."""
    steps = np.rint(found.time / SAMPLING_INTERVAL).astype(np.int64)
    blocks = blocks_of(SeriesPoints(found.series, steps), REACH)
    scored = np.ones(len(blocks), dtype=np.bool_)
    count = int(blocks.max()) + 1
    return outcomes_by_series(found.probability, found.happened, scored, blocks, count)


def percentiles(outcomes: Outcomes, threshold: float, seed: int) -> dict[str, tuple[float, float]]:
    """Intervals by a percentile bootstrap over blocks."""
    generator = random_streams.stream(seed, "percentiles")
    weights = bootstrap_weights(len(outcomes.points), 1000, generator)
    scores = resampled_scores(outcomes, weights, threshold, BINS)
    return {name: percentile_interval(score.samples, 0.95) for name, score in scores.items()}


def coverage(name: str, repetitions: int) -> dict[str, dict[str, Any]]:
    """Share of repetitions whose interval holds the truth: by score, by shape, of both intervals.

    ``truth`` is there, too. Shares are NaN for scores without an interval.
    """
    kind, noise = FORECASTERS[name]
    forecaster = fitted(kind, noise)
    threshold = forecaster.rule(1.0).threshold
    truth = forecaster.scores(series((TRUTH, 1200), noise, 2), 1.0)
    cells: dict[str, dict[str, Any]] = {score: {"truth": truth[score]} for score in SCORES}
    for number, (title, shape) in enumerate(SHAPES.items()):
        held = np.zeros((len(SCORES), 2))
        for repetition in range(repetitions):
            tested = series(shape, noise, 1000 * (number + 1) + repetition)
            ours = forecaster.scores(tested, 1.0, interval=True)
            outcomes = by_block(forecaster.outcomes(tested, 1.0))
            theirs = percentiles(outcomes, threshold, repetition)
            for row, score in enumerate(SCORES):
                for column, (low, high) in enumerate((ours[score][1:], theirs[score])):
                    inside = low <= truth[score] <= high
                    held[row, column] += np.nan if np.isnan(low) else inside
        for score, shares in zip(SCORES, held / repetitions, strict=True):
            cells[score][title] = shares
    return cells


def main() -> None:
    """Print a table for each forecaster."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("repetitions", nargs="?", type=int, default=200)
    repetitions = parser.parse_args().repetitions
    warnings.simplefilter("ignore")
    with single_threaded():
        for name, (kind, _) in FORECASTERS.items():
            print(f"| {name}: `{kind}` | truth | {' | '.join(SHAPES)} |")
            print("|---" * (2 + len(SHAPES)) + "|", flush=True)
            for score, cells in coverage(name, repetitions).items():
                shares = [
                    f"{'-' if np.isnan(ours) else f'{100 * ours:.0f}'}, {100 * theirs:.0f}"
                    for ours, theirs in (cells[title] for title in SHAPES)
                ]
                print(f"| {score} | {cells['truth']:.4f} | {' | '.join(shares)} |")
            print(flush=True)


if __name__ == "__main__":
    main()

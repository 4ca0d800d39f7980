"""What an experiment with control is given: its flows, and the noise that its monitors see.

Source: section "Control of extreme events" of the paper.
"""

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.dataset import Scales, observe


def controlled_series(kept: int, training: int, wanted: int) -> range:
    """Choose the series whose first steps the flows begin with: those that follow the training's.

    Parameters
    ----------
    kept
        Series of the ensemble.
    training
        How many of them, from the first, are trained on.
    wanted
        How many flows to control.

    Returns
    -------
    Rows of the series; fewer than wanted where there are no more.
    """
    return range(training, training + min(wanted, kept - training))


def observation_noise(
    series: range, steps: int, noise: float, scales: Scales, root_seed: int, case: str
) -> FloatArray:
    """Observation noise of each flow at each step, with and without control.

    It is as large as that of the training series, but another: what is observed under control is
    not what was observed of the same series without it.

    Parameters
    ----------
    series
        Rows of the flows' series in the ensemble: each has its own noise.
    steps
        Steps of each flow.
    noise, scales, root_seed
        As in `burstcast.dataset.observe`.
    case
        Name of the case; the random stream is called after it.

    Returns
    -------
    ``(flows, steps, dimension)``.
    """
    silence = np.zeros((len(series), steps, len(scales.standard_deviation)))
    return observe(silence, series.start, noise, scales, root_seed, "control noise", case)

"""Tikhonov parameters that are too small to matter."""

import numpy as np


def negligible_ridge(neurons: int, samples: int) -> float:
    """Tikhonov parameter that is lost in rounding: a smaller one gives the same readout.

    States of the reservoir lie between -1 and 1, so that the largest eigenvalue of the matrix that
    the parameter is added to is ``neurons * samples`` at most; this is its rounding error.
    """
    return float(np.finfo(np.float64).eps) * neurons * samples

"""Tikhonov parameters that are too small to matter."""

import numpy as np


def negligible_ridge(neurons: int, samples: int) -> float:
    """Tikhonov parameter that is lost in rounding: a smaller one gives the same readout.

    It is the rounding error of ``neurons * samples``, which bounds the Gram matrix's eigenvalues.
    """
    return float(np.finfo(np.float64).eps) * neurons * samples

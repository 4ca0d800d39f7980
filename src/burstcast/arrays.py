"""Types of arrays, by what their entries are; shapes are told where an array is used."""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int64]
"""Counts and indices."""
Int32Array = npt.NDArray[np.int32]
"""Indices of sparse matrices, as scipy stores them."""
ByteArray = npt.NDArray[np.uint8]
"""Small numbers that choose between a few things."""

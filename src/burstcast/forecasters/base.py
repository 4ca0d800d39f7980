"""Who forecasts: the interface of anything that continues an observed washout.

Scoring, prediction horizon and control know only this interface. A forecaster's memory is an array
whose last axis is the batch, so that forecasts can be picked out and put aside at any step.
"""

import abc

import numpy as np

from burstcast.arrays import BoolArray, FloatArray


class Forecaster(abc.ABC):
    """Continues many observed series at once."""

    @abc.abstractmethod
    def start(self, washout: FloatArray) -> FloatArray:
        """Memory after an observed washout.

        Parameters
        ----------
        washout
            Observed states up to and including the starting point, ``(steps, dimension, batch)``.

        Returns
        -------
        Memory, ``(..., batch)``.
        """

    @abc.abstractmethod
    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Forecast the next steps.

        Returns
        -------
        Forecast states ``(steps, dimension, batch)``, the first one step after the starting point
        or after the last forecast state, and the memory from which the forecast goes on.
        """

    def diverged(self, outputs: FloatArray) -> BoolArray:
        """Tell which forecasts ``(steps, dimension, batch)`` have left the finite numbers."""
        return np.asarray(~np.isfinite(outputs).all(axis=(0, 1)))

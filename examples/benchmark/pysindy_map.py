"""A sparse map from a sample to the next one, by PySINDy, for a case of the benchmark.

::

    python pysindy_map.py CASE.nc FORECASTS.nc

The map is a polynomial of the components and of their values some samples before. Of many
components, it has the leading principal ones. Terms and threshold are chosen on two training
series that the map has not seen.
"""

import sys
import warnings

import numpy as np
from closed_loop import enter
from pysindy import STLSQ, DiscreteSINDy, PolynomialLibrary

MOST = 20
"""Principal components of a sample that the map knows."""
BOUND = 6.0
"""Bound of the variables of the map, in standard deviations: forecasts that diverge stay there."""
GRID = {
    "terms": ((1, (1,)), (2, ()), (3, ()), (2, (1,)), (2, (2, 4))),
    "threshold": (0.0, 1e-3, 1e-2),
}
"""Degree of the polynomial with delays in samples; coefficients that are smaller are left out."""


class Model:
    """A learnt map, with all forecasts side by side."""

    def __init__(self, training, washout, terms, threshold):
        samples = training.reshape(-1, training.shape[2])
        self.mean, self.scale = samples.mean(axis=0), samples.std(axis=0)
        _, _, axes = np.linalg.svd((samples - self.mean) / self.scale, full_matrices=False)
        kept = min(len(axes), MOST)
        self.axes = axes[:kept] if kept < len(axes) else np.eye(kept)
        degree, self.delays = terms
        self.reach = max(self.delays, default=0)
        series = [self.delayed(one) for one in self.reduced(training)]
        known = np.concatenate(series)
        self.spread = known.std(axis=0)
        optimizer = STLSQ(threshold=threshold, alpha=1e-6)
        self.map = DiscreteSINDy(optimizer, PolynomialLibrary(degree))
        before = [one[:-1] / self.spread for one in series]
        after = [one[1:] / self.spread for one in series]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of terms that are all left out
            self.map.fit(before, 1, x_next=after)

    def reduced(self, states):
        """Principal components of states ``(..., component)``."""
        return (states - self.mean) / self.scale @ self.axes.T

    def delayed(self, series):
        """Samples ``(time, component)`` beside those some samples before."""
        steps = len(series) - self.reach
        parts = [series[self.reach - delay :][:steps] for delay in (0, *self.delays)]
        return np.concatenate(parts, axis=1)

    def forecast(self, washouts, steps):
        """Forecasts after washouts, both ``(points, steps, component)``."""
        past = list(self.reduced(washouts).transpose(1, 0, 2))
        count = len(self.axes)
        found = np.empty((len(washouts), steps, washouts.shape[2]))
        for step in range(steps):
            now = np.concatenate([past[-1 - delay] for delay in (0, *self.delays)], axis=1)
            after = np.clip(self.map.predict(now / self.spread), -BOUND, BOUND)[:, :count]
            past.append(np.asarray(after) * self.spread[:count])
            found[:, step] = past[-1] @ self.axes * self.scale + self.mean
        return found


if __name__ == "__main__":
    enter(Model, GRID, *sys.argv[1:])

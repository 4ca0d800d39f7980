"""A sparse polynomial map from a sample to the next one, by PySINDy, as a forecaster of a campaign.

The map is a polynomial of the components and of their values some samples before. Terms and
threshold are chosen on two training series that the map has not seen.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from held_out import with_chosen_options, with_options
from pysindy import STLSQ, DiscreteSINDy, PolynomialLibrary
from sklearn.preprocessing import PolynomialFeatures

from burstcast.forecasters.base import Forecaster, fitted

CHOSEN = ("terms", "threshold")


@dataclass(frozen=True)
class PySINDy(Forecaster):
    """Next sample = sparse polynomial of the last one, and of some before it."""

    #: degree of the polynomial, with delays in samples after a space: "2 2,4"
    terms: tuple[str, ...] = ("1 1", "2", "3", "2 1", "2 2,4")
    threshold: tuple[float, ...] = (0.0, 1e-3, 1e-2)  #: smaller coefficients are left out
    bound: float = 6.0  #: of forecasts, in standard deviations: diverging ones stay there

    mean: np.ndarray = fitted()
    scale: np.ndarray = fitted()
    spread: np.ndarray = fitted()  #: standard deviations of the variables of the map
    coefficients: np.ndarray = fitted()  #: ``(variables, monomials)``
    chosen_terms: str = fitted()
    chosen_threshold: float = fitted()

    def fit(self, training, case):
        """Choose terms and threshold, and learn the map from all series."""
        tuned = with_chosen_options(self, CHOSEN, training, case, washout_lt=0.5)
        (terms,), (threshold,) = tuned.terms, tuned.threshold
        degree, delays = _read(terms)
        samples = training.reshape(-1, training.shape[2])
        mean, scale = samples.mean(axis=0), samples.std(axis=0)
        series = [_delayed((states - mean) / scale, delays) for states in training]
        spread = np.concatenate(series).std(axis=0)
        optimizer = STLSQ(threshold=threshold, alpha=1e-6)
        learnt = DiscreteSINDy(optimizer, PolynomialLibrary(degree))
        before = [states[:-1] / spread for states in series]
        after = [states[1:] / spread for states in series]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of terms that are all left out
            learnt.fit(before, 1, x_next=after)
        return self.with_fitted(
            mean=mean,
            scale=scale,
            spread=spread,
            coefficients=np.asarray(learnt.coefficients()),
            chosen_terms=terms,
            chosen_threshold=threshold,
        )

    def tuned(self):
        """Map that is learnt with the terms and the threshold that were chosen."""
        return with_options(self, CHOSEN, (self.chosen_terms, self.chosen_threshold))

    def start(self, washout):
        """The last samples, the oldest first, ``(samples * dimension, batch)``."""
        _, delays = _read(self.chosen_terms)
        last = washout[-1 - max(delays, default=0) :]
        states = (last - self.mean[:, np.newaxis]) / self.scale[:, np.newaxis]
        return np.ascontiguousarray(states.reshape(-1, washout.shape[2]))

    def advance(self, memory, steps):
        """Apply the map again and again."""
        degree, delays = _read(self.chosen_terms)
        dimension, features = len(self.mean), PolynomialFeatures(degree)
        outputs = np.empty((steps, dimension, memory.shape[1]))
        for step in range(steps):
            past = memory.reshape(-1, dimension, memory.shape[1])
            now = np.concatenate([past[-1 - delay] for delay in (0, *delays)])
            monomials = features.fit_transform(now.T / self.spread)
            following = monomials @ self.coefficients[:dimension].T
            following = np.clip(following, -self.bound, self.bound)
            state = (following * self.spread[:dimension]).T
            memory = np.concatenate([memory[dimension:], state])
            outputs[step] = state * self.scale[:, np.newaxis] + self.mean[:, np.newaxis]
        return outputs, memory


def _read(terms):
    degree, _, delays = terms.partition(" ")
    return int(degree), [int(delay) for delay in delays.split(",") if delay]


def _delayed(series, delays):
    """Samples ``(time, component)`` beside those some samples before."""
    reach = max(delays, default=0)
    parts = [series[reach - delay :][: len(series) - reach] for delay in (0, *delays)]
    return np.concatenate(parts, axis=1)

"""Models of a ring of variables, the same at each site, learnt from noisy observations alone.

`benchmarks/controllers.py` lets them control Lorenz 96. A variable depends on its neighbours up to
a distance, so that each site of a series is a sample of its own.
"""

from collections import Counter
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.control.arenas import LargestVariable
from burstcast.forecasters._square_root_filter import assimilate
from burstcast.forecasters.base import Forecaster, fitted
from burstcast.systems.integration import integrate

INFLATION = 1.08
"""Inflation of filters whose model is a learnt map."""

Term = tuple[int, ...]
"""Shifts of the neighbours whose product a term is."""


@dataclass(frozen=True)
class RingPolynomial(LargestVariable):
    """Polynomial of the neighbours at each site: the time derivative of a variable."""

    terms: tuple[Term, ...] = ()
    weights: tuple[float, ...] = ()

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Sum of the terms, ``(variables, ...)``."""
        total: FloatArray = 0.0 * state
        for weight, term in zip(self.weights, self.terms, strict=True):
            value: FloatArray = weight + 0.0 * state
            for shift in term:
                value = value * np.roll(state, shift, axis=0)
            total = total + value
        return total


@dataclass(frozen=True)
class RingMap(RingPolynomial):
    """The polynomial is the change from one sample to the next."""

    def flow_map(self, state: FloatArray, time_step: float) -> FloatArray:
        """State a sample later, ``(variables, ...)``; the time step has no effect."""
        return state + self.right_hand_side(state)


@dataclass(frozen=True)
class LearntRing(Forecaster):
    """Equations of a ring of variables, learnt from noisy observations.

    The derivative of a variable is quadratic in its neighbours up to a distance. Over two sampling
    intervals it integrates to a difference of observations (Simpson's rule), which is regressed on
    terms. Moments of noisy states are corrected for the noise, whose size is known (adjusted least
    squares, Cheng & Schneeweiss, Journal of the Royal Statistical Society B 60 (1998) 189). Terms
    whose root mean square is below ``least`` are removed.
    """

    noise: float = 1.0  #: standard deviation of the observation noise
    interval: float = 0.05  #: sampling interval
    degree: int = 2
    reach: int = 3
    least: float = 0.1

    system: RingPolynomial | None = fitted()

    def fit(self, training: FloatArray, case: object) -> Self:
        """Learn from all sites of the series, ``(series, time, component)``."""
        shifts = range(-self.reach, self.reach + 1)
        degrees = range(self.degree + 1)
        terms = [
            term for degree in degrees for term in combinations_with_replacement(shifts, degree)
        ]
        gram, target = self._moments(training.transpose(2, 0, 1), terms)
        size = np.sqrt(gram.diagonal())
        kept = np.arange(len(terms))
        for _ in range(5):
            weights = np.linalg.solve(gram[np.ix_(kept, kept)], target[kept])
            kept = kept[np.abs(weights) * size[kept] > self.least]
        weights = np.linalg.solve(gram[np.ix_(kept, kept)], target[kept])
        chosen = tuple(terms[number] for number in kept)
        return self.with_fitted(system=self._system(training.shape[2], chosen, weights))

    def _system(
        self, variables: int, terms: tuple[Term, ...], weights: FloatArray
    ) -> RingPolynomial:
        return RingPolynomial(variables=variables, terms=terms, weights=tuple(weights.tolist()))

    def _moments(self, states: FloatArray, terms: list[Term]) -> tuple[FloatArray, FloatArray]:
        """Moments of the terms with each other, and with the target of the regression.

        ``states``: ``(variables, series, time)``. Shapes ``(terms, terms)`` and ``(terms,)``.
        """
        change = (states[..., 2:] - states[..., :-2]) / (2 * self.interval)
        before, here, after = (
            self._powers(states[..., lag : states.shape[2] - 2 + lag]) for lag in range(3)
        )
        terms_here = self._monomials(terms, here)
        # terms at the times before and after have other noise than those of the moment
        around = (self._monomials(terms, before) + self._monomials(terms, after)) / 6
        apart = terms_here @ around.T / change.size
        return 4 / 6 * self._together(
            terms, here
        ) + apart, terms_here @ change.ravel() / change.size

    def _together(self, terms: list[Term], powers: FloatArray) -> FloatArray:
        """Moments of two terms at the same time, ``(terms, terms)``."""
        pairs = [[tuple(sorted(a + b)) for a in terms] for b in terms]
        keys = sorted({key for row in pairs for key in row})
        moment = {key: float(self._monomials([key], powers).mean()) for key in keys}
        return np.array([[moment[key] for key in row] for row in pairs])

    def _powers(self, states: FloatArray) -> FloatArray:
        """Powers of all neighbours, in the mean those of the true state: Hermite polynomials.

        From the first to twice the degree, ``(2 * degree, 2 * reach + 1, samples)``.
        """
        shifts = range(-self.reach, self.reach + 1)
        x = np.stack([np.roll(states, shift, axis=0).ravel() for shift in shifts])
        powers = [np.ones_like(x), x]
        for power in range(1, 2 * self.degree):
            powers.append(x * powers[power] - power * self.noise**2 * powers[power - 1])
        return np.stack(powers[1:])

    def _monomials(self, terms: list[Term], powers: FloatArray) -> FloatArray:
        """Products of neighbours, ``(terms, samples)``."""
        values = np.ones((len(terms), powers.shape[2]))
        for value, term in zip(values, terms, strict=True):
            for shift, power in Counter(term).items():
                value *= powers[power - 1, shift + self.reach]
        return values

    def start(self, washout: FloatArray) -> FloatArray:
        """The last state is the memory."""
        return washout[-1]

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Integrate the learnt equations, in two steps for each sampling interval."""
        assert self.system is not None
        states = integrate(self.system, memory, self.interval / 2, 2 * steps, 2, may_diverge=True)
        return states[1:], states[-1]


@dataclass(frozen=True)
class RingAutoregression(LearntRing):
    """Nonlinear vector autoregression of a ring: the next sample is a cubic of the last one.

    As `burstcast.forecasters.nvar`, with one lag, products of three, and the same weights at each
    site. Moments are corrected for the noise as in `LearntRing`: products with the next sample,
    whose noise is another, need no correction but that of the terms.
    """

    degree: int = 3
    least: float = 0.03

    def _system(
        self, variables: int, terms: tuple[Term, ...], weights: FloatArray
    ) -> RingPolynomial:
        return RingMap(variables=variables, terms=terms, weights=tuple(weights.tolist()))

    def _moments(self, states: FloatArray, terms: list[Term]) -> tuple[FloatArray, FloatArray]:
        here = self._powers(states[..., :-1])
        following = states[..., 1:]
        now = self._together(terms, here)
        target = self._monomials(terms, here) @ following.ravel() / following.size
        return now, target - now[terms.index((0,))]

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Apply the map again and again."""
        assert self.system is not None
        states = integrate(self.system, memory, self.interval, steps, may_diverge=True)
        return states[1:], states[-1]


@dataclass(frozen=True)
class RingNetwork(Forecaster):
    """Network with one layer of random neurons, the same at each site, and a trained readout.

    It sees a variable and its neighbours, and predicts the change to the next sample. A readout
    trained on noisy samples predicts too little (errors in variables): it learns from the states
    that an ensemble filter with `RingAutoregression` estimates along the training series (cf.
    Brajard et al., Journal of Computational Science 44 (2020) 101171). Neurons are in single
    precision.
    """

    noise: float = 1.0  #: standard deviation of the observation noise
    reach: int = 3
    neurons: int = 100
    #: largest weight of an input, in units of its standard deviation in training
    input_scaling: float = 0.08
    ridge: float = 1e-9
    series: int = 5  #: training series that are filtered
    samples: int = 730  #: samples of each that are filtered
    seed: int = 0

    input_weights: FloatArray = fitted()  #: ``(neurons, 2 * reach + 1)``
    bias: FloatArray = fitted()  #: ``(neurons, 1)``
    readout: FloatArray = fitted()  #: ``(neurons + 2 * reach + 2,)``

    def fit(self, training: FloatArray, case: object) -> Self:
        """Filter the training series, ``(series, time, component)``, and train the readout."""
        observed = training[: self.series, : self.samples].transpose(1, 2, 0)
        generator = np.random.default_rng(self.seed)
        shape = self.neurons, 2 * self.reach + 1
        weights = self.input_scaling / training.std() * generator.uniform(-1, 1, shape)
        network = self.with_fitted(
            input_weights=weights, bias=generator.uniform(-1, 1, (self.neurons, 1))
        )
        model = RingAutoregression(noise=self.noise, reach=self.reach).fit(training, case)
        states = analyses(model, observed, np.full(observed.shape[1], self.noise))
        before, change = states[:-1].transpose(1, 0, 2), np.diff(states, axis=0).transpose(1, 0, 2)
        features = network._features(before.reshape(len(before), -1)).astype(np.float64)
        gram = features @ features.T / features.shape[1] + self.ridge * np.eye(len(features))
        readout = np.linalg.solve(gram, features @ change.ravel() / features.shape[1])
        return self.with_fitted(
            input_weights=weights, bias=network.bias, readout=readout.astype(np.float32)
        )

    def _features(self, state: FloatArray) -> FloatArray:
        """Neurons, neighbours and 1 at each site, ``(features, variables * batch)``."""
        shifts = range(-self.reach, self.reach + 1)
        seen = np.stack([np.roll(state, shift, axis=0).ravel() for shift in shifts])
        seen = seen.astype(np.float32)
        neurons = np.tanh(
            self.input_weights.astype(np.float32) @ seen + self.bias.astype(np.float32)
        )
        return np.concatenate([neurons, seen, np.ones((1, seen.shape[1]), dtype=np.float32)])

    def start(self, washout: FloatArray) -> FloatArray:
        """The last state is the memory."""
        return washout[-1]

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Apply the network again and again."""
        outputs = np.empty((steps, *memory.shape))
        for step in range(steps):
            memory = memory + (self.readout @ self._features(memory)).reshape(memory.shape)
            outputs[step] = memory
        return outputs, memory


def analyses(
    model: Forecaster, observed: FloatArray, noise: FloatArray, members: int = 40
) -> FloatArray:
    """States that an ensemble filter estimates along series, ``(time, component, series)``.

    Of models whose memory is the state. The first quarter of a Lyapunov time is left out.
    """
    generator = np.random.default_rng(0)
    drawn = generator.standard_normal((len(noise), members, observed.shape[2]))
    ensemble = observed[0][:, np.newaxis] + noise[:, np.newaxis, np.newaxis] * drawn
    states = []
    for observation in observed[1:]:
        forecast = model.advance(ensemble.reshape(len(noise), -1), 1)[0][-1]
        ensemble = assimilate(forecast.reshape(ensemble.shape), observation, noise, INFLATION)
        states.append(ensemble.mean(axis=1))
    return np.array(states[20:])

"""Hidden variables of polynomial equations, found from what they do to the observed ones.

A variable h that is driven by polynomials of the observed state x and decays is a moving average of
monomials. Where the equations of x have terms h and x_j h, their increments are a regression on the
integrals of monomials, of moving averages z of the monomials, and of the products x_j z, whose
coefficients have the rank of the hidden variables: h = V z, found by the singular values, and then
by alternating least squares (reduced-rank regression; Izenman, Journal of Multivariate Analysis 5,
1975). Nothing but the span of h, and what x explains of it, is determined.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.polynomials.basis import denoised, monomials
from burstcast.systems.polynomials.regression import gregory_weights

_DEGREE = 2
_RIDGE = 1e-6
"""Penalty of a regression, in units of the mean square of its regressors."""
_ITERATIONS = 12
"""Steps of alternating least squares."""
_PAIRS = 5
"""Pairs of rates that are tried with as many hidden variables as are wanted."""
MOST_COMPONENTS = 12
"""Most observed components: moments of all products of their monomials fill the memory."""


@dataclass(frozen=True)
class HiddenSeries:
    """Estimates of hidden variables.

    Attributes
    ----------
    series
        Hidden variables of the observed series that are long enough, from sample ``first`` on, of
        unit variance, ``(time - first, hidden)``.
    rows
        Numbers of these series.
    first
        First sample at which the moving averages have forgotten where they began.
    rates
        Rates of the moving averages, in inverse samples.
    explained
        Mean square residual of the increments, in units of those of the noise, as a share of that
        of equations without hidden variables.
    singular_values
        Those of the regression, the largest one being 1.
    """

    series: list[FloatArray]
    rows: list[int]
    first: int
    rates: tuple[float, ...]
    explained: float
    singular_values: FloatArray


def moving_averages(values: FloatArray, rate: float) -> FloatArray:
    """Averages z of ``(rows, time)`` with dz/dt = rate (value - z), from the first value on.

    Values are taken to be constant at their mean between two samples. ``rate``: In inverse samples.

    Examples
    --------
    >>> moving_averages(np.full((1, 4), 2.0), 0.3).tolist()
    [[2.0, 2.0, 2.0, 2.0]]
    """
    averages, kept = np.empty_like(values), np.exp(-rate)
    averages[:, 0] = values[:, 0]
    for step in range(1, values.shape[1]):
        between = 0.5 * (values[:, step] + values[:, step - 1])
        averages[:, step] = kept * averages[:, step - 1] + (1 - kept) * between
    return averages


def hidden_series(
    series: Sequence[FloatArray],
    noise: FloatArray,
    hidden: int,
    rates: Sequence[float],
    window: int,
) -> HiddenSeries:
    """Estimate hidden variables of series ``(time, dimension)`` of quadratic equations.

    ``noise``: Standard deviation of the observation noise, ``(dimension,)``. ``hidden``: Number of
    hidden variables. ``rates``: Rates that the moving averages may have, in inverse samples; the
    two that leave the smallest residual are chosen. ``window``: Samples of the windows of the
    regression.
    """
    dimension = series[0].shape[1]
    if not 1 <= hidden <= dimension:
        raise ValueError(f"hidden is {hidden}; it must be from 1 to the {dimension} components")
    if dimension > MOST_COMPONENTS:
        raise ValueError(
            f"hidden variables are found behind {MOST_COMPONENTS} components at most, not "
            f"{dimension}"
        )
    first = int(np.ceil(1 / min(rates)))
    least = first + 4 * window
    rows = [row for row, states in enumerate(series) if len(states) > least]
    if not rows:
        raise ValueError(
            f"moving averages with the rate {min(rates):.3g} take series of more than {least} "
            f"samples, the longest has {max(map(len, series))}: raise the lowest rate"
        )
    series = [series[row] for row in rows]
    moments = _Moments.of(series, noise, list(rates), window, first)
    chosen, directions, explained, singular_values = moments.best(hidden)
    parts = [moments.averages(states, chosen)[:, first:].T @ directions for states in series]
    together = np.concatenate(parts)
    centre = together.mean(axis=0)
    whiten = np.linalg.inv(np.linalg.cholesky(np.cov(together.T).reshape(hidden, hidden)))
    found = [(part - centre) @ whiten.T for part in parts]
    return HiddenSeries(
        found, rows, first, tuple(rates[number] for number in chosen), explained, singular_values
    )


@dataclass(frozen=True)
class _Moments:
    """Moments of increments, and of integrals of monomials and of products with their averages.

    Regressors are the monomials, and, for each rate, the averages of all monomials but 1, alone and
    times each component.
    """

    rates: list[float]
    noise: FloatArray
    scale: FloatArray  #: standard deviation of each component
    size: FloatArray  #: standard deviation of each monomial but 1
    gram: (
        FloatArray  #: ``(2, regressors, regressors)``: of series that are learnt from, and left out
    )
    cross: FloatArray  #: ``(2, regressors, dimension)``
    square: FloatArray  #: mean square increments, ``(2, dimension)``
    spread: FloatArray  #: covariance of the averages of all rates

    @classmethod
    def of(
        cls,
        series: Sequence[FloatArray],
        noise: FloatArray,
        rates: list[float],
        window: int,
        first: int,
    ) -> "_Moments":
        together = np.concatenate(series)
        scale, dimension = together.std(axis=0), together.shape[1]
        basis = monomials(dimension, _DEGREE)
        size = denoised(together, np.square(noise), basis)[1:].std(axis=1)
        blank = cls(rates, noise, scale, size, *(np.empty(0) for _ in range(4)))
        weights = gregory_weights(window)
        count = len(basis) + len(rates) * len(size) * (1 + dimension)
        gram, cross = np.zeros((count, count)), np.zeros((count, dimension))
        square, samples, all_averages = np.zeros(dimension), 0, []
        for states in series:
            values = blank.values(states)
            averages = [moving_averages(values[1:], rate) for rate in rates]
            regressors = [values]
            for of_rate in averages:
                products = (states / scale).T[:, np.newaxis] * of_rate
                regressors += [of_rate, products.reshape(-1, len(states))]
            whole = np.concatenate(regressors)
            windows = len(states) - window - first
            integrals = sum(
                weight * whole[:, first + point : first + point + windows]
                for point, weight in enumerate(weights)
            )
            increments = (states[first + window :] - states[first : first + windows]) / scale
            gram += integrals @ integrals.T
            cross += integrals @ increments
            square += np.square(increments).sum(axis=0)
            samples += windows
            all_averages.append(np.concatenate(averages)[:, first:])
        spread = np.cov(np.concatenate(all_averages, axis=1))
        moments = gram / samples, cross / samples, square / samples
        return cls(rates, noise, scale, size, *moments, spread)

    @property
    def monomials(self) -> int:
        """Number of monomials."""
        return len(self.size) + 1

    def values(self, states: FloatArray) -> FloatArray:
        """Monomials of states ``(time, dimension)``, but for 1 of unit variance."""
        basis = monomials(states.shape[1], _DEGREE)
        values = denoised(states, np.square(self.noise), basis)
        values[1:] /= np.where(self.size > 0, self.size, 1.0)[:, np.newaxis]
        return values

    def averages(self, states: FloatArray, chosen: Sequence[int]) -> FloatArray:
        """Averages with the chosen rates, ``(rates * monomials - 1, time)``."""
        values = self.values(states)[1:]
        return np.concatenate([moving_averages(values, self.rates[number]) for number in chosen])

    def residual(self, gram: FloatArray, cross: FloatArray) -> FloatArray:
        """Mean square residual of a regression with some moments, ``(dimension,)``."""
        coefficients = _ridge(gram, cross)
        squares = (coefficients * (gram @ coefficients - 2 * cross)).sum(axis=0)
        return np.asarray(self.square + squares)

    @cached_property
    def closure(self) -> FloatArray:
        """Mean square residual of equations without hidden variables, ``(dimension,)``."""
        return self.residual(*self.by_factor([]))

    @cached_property
    def floor(self) -> FloatArray:
        """Mean square increments that count as explained, ``(dimension,)``.

        Those of the noise, and a thousandth of the largest residual without hidden variables.
        """
        floor: FloatArray = 2 * np.square(self.noise / self.scale) + 1e-3 * self.closure.max()
        return floor

    def best(self, hidden: int) -> tuple[list[int], FloatArray, float, FloatArray]:
        """Rates, directions of their averages, the share that they leave, and singular values.

        The pairs of rates whose averages leave the least are tried with directions, and the one is
        chosen whose directions leave the least.
        """

        def share(residual: FloatArray) -> float:
            return float((residual / self.floor).sum() / (self.closure / self.floor).sum())

        numbers = range(len(self.rates))
        several = [list(pair) for pair in combinations(numbers, min(2, len(self.rates)))]
        several.sort(key=lambda pair: share(self.residual(*self.by_factor(pair))))
        tried = []
        for chosen in several[:_PAIRS]:
            directions, singular_values = self.reduced(chosen, hidden)
            moments = _projected(*self.by_factor(chosen), self.monomials, directions)
            tried.append((chosen, directions, share(self.residual(*moments)), singular_values))
        return min(tried, key=lambda one: one[2])

    def by_factor(self, chosen: Sequence[int]) -> tuple[FloatArray, FloatArray]:
        """Moments with products sorted by their factor, 1, x_0, ..., and then by the average."""
        count, shape = self.monomials, (len(self.rates), 1 + len(self.scale), len(self.size))
        products = count + np.arange(np.prod(shape)).reshape(shape)[list(chosen)]
        order = np.concatenate([np.arange(count), products.swapaxes(0, 1).reshape(-1)])
        return self.gram[np.ix_(order, order)], self.cross[order]

    def reduced(self, chosen: Sequence[int], hidden: int) -> tuple[FloatArray, FloatArray]:
        """Directions of the averages that act on increments, and all singular values."""
        count, dimension = self.monomials, len(self.scale)
        averages = len(self.size) * len(chosen)
        gram, cross = self.by_factor(chosen)
        weight = np.sqrt(self.floor)
        of_products = gram[count:, count:].reshape(1 + dimension, averages, 1 + dimension, averages)
        mixed = gram[:count, count:].reshape(count, 1 + dimension, averages)
        crossed = cross[count:].reshape(1 + dimension, averages, dimension)
        coefficients = _ridge(gram, cross)[count:].reshape(crossed.shape)
        rows = (coefficients / weight).transpose(0, 2, 1).reshape(-1, averages)
        which = np.add.outer(np.array(chosen) * len(self.size), np.arange(len(self.size))).ravel()
        spread = self.spread[np.ix_(which, which)]
        values, vectors = np.linalg.eigh(spread)
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        _, singular, right = np.linalg.svd(rows @ root, full_matrices=False)
        directions = np.linalg.lstsq(root.T, right[:hidden].T, rcond=1e-8)[0]
        for _ in range(_ITERATIONS):
            directions = directions / np.sqrt(np.diag(directions.T @ spread @ directions))
            solved = _ridge(*_projected(gram, cross, count, directions), 1e-2 * _RIDGE)
            plain = solved[:count] / weight
            acting = solved[count:].reshape(hidden, 1 + dimension, dimension) / weight
            left = crossed / weight - np.einsum("mjz,mi->jzi", mixed, plain)
            matrix = np.einsum("kie,izjy,lje->kzly", acting, of_products, acting, optimize=True)
            target = np.einsum("kje,jze->kz", acting, left).reshape(-1, 1)
            flat = matrix.reshape(hidden * averages, hidden * averages)
            directions = _ridge(flat, target, 0.1 * _RIDGE).reshape(hidden, averages).T
        return directions, singular / singular[0]


def _projected(
    gram: FloatArray, cross: FloatArray, count: int, directions: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Moments of monomials and of products with hidden variables, by variable and factor."""
    averages, hidden = directions.shape
    factors = (len(gram) - count) // averages
    project = np.zeros((len(gram), count + hidden * factors))
    project[:count, :count] = np.eye(count)
    for variable in range(hidden):
        for factor in range(factors):
            rows = slice(count + factor * averages, count + (factor + 1) * averages)
            project[rows, count + variable * factors + factor] = directions[:, variable]
    return project.T @ gram @ project, project.T @ cross


def _ridge(gram: FloatArray, cross: FloatArray, penalty: float = _RIDGE) -> FloatArray:
    """Coefficients of a regression from its moments."""
    matrix = gram + penalty * np.trace(gram) / len(gram) * np.eye(len(gram))
    return np.asarray(np.linalg.solve(matrix, cross))

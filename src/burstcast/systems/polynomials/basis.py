"""Monomials of the components of a state, and their values for noisy states."""

from itertools import combinations_with_replacement

import numpy as np

from burstcast.base.arrays import FloatArray

Monomial = tuple[int, ...]
"""Factors of a monomial in rising order: () is 1, (0, 2, 2) is x_0 x_2^2."""


def monomials(dimension: int, degree: int) -> list[Monomial]:
    """All monomials of a state up to a degree: 1, x_0, x_1, ..., x_0^2, x_0 x_1, ..."""
    return [
        factors
        for count in range(degree + 1)
        for factors in combinations_with_replacement(range(dimension), count)
    ]


def denoised(states: FloatArray, noise_variance: FloatArray, basis: list[Monomial]) -> FloatArray:
    """Monomials of true states, ``(monomials, ...)``, estimated from ``(..., dimension)``.

    The mean of (x + noise)^2 is x^2 plus the variance of the noise, and so on: a power of a
    component is replaced by its Hermite polynomial (Cheng & Schneeweiss, "Polynomial regression
    with errors in the variables", Journal of the Royal Statistical Society B 60, 1998).
    """
    highest = max(len(factors) for factors in basis)
    powers = []
    for component, variance in enumerate(noise_variance):
        value = states[..., component]
        hermite = [np.ones_like(value), value]
        for order in range(1, highest):
            hermite.append(value * hermite[order] - order * variance * hermite[order - 1])
        powers.append(hermite)
    values = np.ones((len(basis), *states.shape[:-1]))
    for row, factors in enumerate(basis):
        for component in set(factors):
            values[row] *= powers[component][factors.count(component)]
    return values

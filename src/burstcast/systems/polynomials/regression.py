"""Polynomial equations found in noisy series, by regression in integral form.

Over a window, the increment of a component is the integral of its equation: x(t + w) - x(t) =
integral of sum_m c_m monomial_m(x) (the weak form of Messenger & Bortz, "Weak SINDy", Multiscale
Modeling & Simulation 19, 2021). Least squares gives the coefficients; the contribution of noise to
its moments is subtracted (Cheng & Schneeweiss, Journal of the Royal Statistical Society B 60,
1998). Terms that are not significant are left out one after the other (sparse regression as in
Brunton, Proctor & Kutz, PNAS 113, 2016, with a threshold in standard errors, which has no unit and
fits any amount of noise).

Coefficients may depend on parameters: each is then a constant plus a linear combination of factors
(`burstcast.forecasters._parameter_factors`); windows within which a factor changes are left out.
"""

import math
from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.series_lengths import samples_of, series_lengths
from burstcast.systems.polynomials.basis import Monomial, denoised, monomials

SIGNIFICANCE = 4
"""Least size of a coefficient, in standard errors, without which its term is left out."""

# Coefficients of Gregory's formula: corrections of the trapezoidal rule by differences at the ends.
_GREGORY = (1 / 12, 1 / 24, 19 / 720, 3 / 160, 863 / 60480)
# Stretches of the series whose scatter gives the standard errors: so many that the errors are
# known to a tenth, and each of them many windows long where the series allow it.
_STRETCHES = 40
_WINDOWS_PER_STRETCH = 4
# Powers of a component whose mean is so many standard deviations from zero lose the digits of its
# changes: it is centred first. Others are not, since centring makes terms of terms that are absent.
_FAR = 30.0
# Bounds the memory, changes no result.
_MONOMIALS_AT_ONCE = 500


def gregory_weights(intervals: int) -> FloatArray:
    """Weights of a quadrature over equally spaced points at distance 1, ``(intervals + 1,)``.

    The trapezoidal rule with Gregory's end corrections of up to order five, as many as fit.
    """
    weights = np.ones(intervals + 1)
    weights[[0, -1]] = 0.5
    for order, correction in enumerate(_GREGORY[: (intervals + 1) // 2], start=1):
        for point in range(order + 1):
            change = correction * (-1) ** point * math.comb(order, point)
            weights[point] -= change
            weights[-1 - point] -= change
    return weights


def factored_coefficients(
    series: FloatArray,
    noise: FloatArray,
    interval: float,
    degree: int,
    window: int,
    significance: float,
    factors: FloatArray | None = None,
    conserved: FloatArray | None = None,
) -> FloatArray:
    """Coefficients that are linear in factors, ``(1 + factors, monomials, dimension)``.

    The equations that observed series obey are
    dx/dt = sum_m (c[0, m] + sum_f factor_f c[f, m]) monomial_m(x). ``noise``: Standard deviation of
    the noise in each component. ``significance``: Standard errors that the coefficient of a term
    must be away from zero; 0 keeps all terms. ``factors``: In force from each sample to the next,
    ``(series, time - 1, factors)``; None: there are none. ``conserved``: Symmetric matrix of a
    quadratic form that the quadratic terms leave as it is, such as the kinetic energy in flows,
    ``(dimension, dimension)``; without factors alone. None: nothing is conserved.
    """
    if conserved is not None and (factors is not None or degree != 2):
        raise ValueError("a conserved quadratic form takes equations of degree 2 without factors")
    if factors is None:
        factors = np.empty((series.shape[0], max(0, series.shape[1] - 1), 0))
    if factors.shape[:2] != (series.shape[0], max(0, series.shape[1] - 1)):
        raise ValueError(
            f"series of shape {series.shape} need factors of the shape "
            f"({series.shape[0]}, {series.shape[1] - 1}, factors), not {factors.shape}"
        )
    count = (1 + factors.shape[2]) * len(monomials(series.shape[2], degree))
    lengths = series_lengths(series)
    if lengths is None:
        lengths = np.full(len(series), series.shape[1])
    windows = sum(
        int(_unchanged(of_series[: max(0, length - 1)], window).sum())
        for of_series, length in zip(factors, lengths, strict=True)
    )
    if windows < count:
        unchanged = " in which no parameter changes: shorten them (option window_lt)"
        raise ValueError(
            f"{series.shape[0]} series of {lengths.max()} samples are too few for {count} "
            f"coefficients of each equation from windows of {window} intervals"
            f"{unchanged if factors.shape[2] else ''}"
        )
    # in units of the components' standard deviations, in which monomials are alike in size
    samples = samples_of(series)
    scale, mean = samples.std(axis=0), samples.mean(axis=0)
    if not (scale > 0).all():
        raise ValueError(f"component {int(np.argmin(scale > 0))} is constant in all series")
    far = np.where(np.abs(mean) > _FAR * scale, mean, 0.0)
    parts = [
        ((states[:length] - far) / scale, of_series[: length - 1])
        for states, of_series, length in zip(series, factors, lengths, strict=True)
        if length > window
    ]
    gram, cross = _moments(parts, noise / scale, degree, window)
    _check_noise(gram, noise / scale, monomials(series.shape[2], degree))
    columns = [
        _significant(gram, cross[:, :, component], significance)
        for component in range(series.shape[2])
    ]
    scaled = np.stack(columns, axis=1)
    if conserved is not None:
        form = conserved * np.outer(scale, scale)
        scaled = _conserving(scaled, gram, cross, form)
    units = np.array(
        [math.prod(scale[list(factors)]) for factors in monomials(series.shape[2], degree)]
    )
    blocks = scaled.reshape(1 + factors.shape[2], len(units), series.shape[2])
    coefficients: FloatArray = blocks * scale / units[:, np.newaxis] / interval
    return _about_zero(coefficients, far, degree) if far.any() else coefficients


def _check_noise(gram: FloatArray, noise: FloatArray, basis: Sequence[Monomial]) -> None:
    """Raise ValueError where the noise that is subtracted exceeds what a monomial amounts to.

    ``gram``: By stretch, ``(stretches, coefficients, coefficients)``. ``noise``: In standard
    deviations of each component.
    """
    sums = np.diagonal(gram, axis1=1, axis2=2).sum(axis=0)
    lost = np.flatnonzero(~(sums > 0))
    if not lost.size:
        return
    factors = {component for row in lost.tolist() for component in basis[row % len(basis)]}
    component = max(factors, key=lambda number: float(noise[number]))
    raise ValueError(
        f"the noise of component {component}, {noise[component]:.2g} standard deviations, exceeds "
        "what its trajectory amounts to in the windows of the regression: its sampling is too "
        "coarse to tell noise from dynamics, or it is mostly noise; sample more finely, give the "
        "noise (option noise), or take a kind that learns no equations, such as esn or analogues"
    )


def _about_zero(coefficients: FloatArray, centre: FloatArray, degree: int) -> FloatArray:
    """Convert coefficients of centred components into coefficients of the components."""
    basis = monomials(len(centre), degree)
    place = {factors: row for row, factors in enumerate(basis)}
    expanded = np.zeros((len(basis), len(basis)))
    for row, factors in enumerate(basis):
        for chosen in product((True, False), repeat=len(factors)):
            left = tuple(component for component, kept in zip(factors, chosen, strict=True) if kept)
            others = [
                -centre[component]
                for component, kept in zip(factors, chosen, strict=True)
                if not kept
            ]
            expanded[place[left], row] += math.prod(others)
    return expanded @ coefficients


def _unchanged(factors: FloatArray, window: int) -> BoolArray:
    """Whether no factor ``(time - 1, factors)`` changes within the window from each sample."""
    windows = max(0, len(factors) + 1 - window)
    changes = np.zeros(len(factors) + 1, dtype=np.int64)
    changes[2:] = np.cumsum((factors[1:] != factors[:-1]).any(axis=1))
    # the changes so far at the window's first interval and at its last
    first = np.arange(windows)
    return np.asarray(changes[first + window] == changes[first + 1])


def _groups(
    factors: FloatArray, window: int, bounds: list[tuple[int, int]]
) -> list[tuple[int, FloatArray, IntArray]]:
    """Windows of a series by stretch and factors: stretch, factors after a 1, first samples."""
    usable = _unchanged(factors, window)
    values, which = np.unique(factors, axis=0, return_inverse=True)
    groups = []
    for stretch, (start, stop) in enumerate(bounds):
        here = start + np.flatnonzero(usable[start:stop])
        for number in np.unique(which.reshape(-1)[here]):
            of_value = here[which.reshape(-1)[here] == number]
            groups.append((stretch, np.concatenate([[1.0], values[number]]), of_value))
    return groups


def _moments(
    series: Sequence[tuple[FloatArray, FloatArray]], noise: FloatArray, degree: int, window: int
) -> tuple[FloatArray, FloatArray]:
    """Sums over the windows of each stretch of series: of integrated monomials, and increments.

    ``series``: Each with its factors, ``(time, component)`` and ``(time - 1, factors)``.
    """
    dimension, count = len(noise), series[0][1].shape[1]
    basis, variance = monomials(dimension, degree), np.square(noise)
    weights = gregory_weights(window)
    size = (1 + count) * len(basis)
    gram, cross = [], []
    for states, of_series in series:
        windows = len(states) - window
        stretches = min(
            math.ceil(_STRETCHES / len(series)),
            max(1, windows // (_WINDOWS_PER_STRETCH * window)),
        )
        bounds = list(pairwise(np.linspace(0, windows, stretches + 1).astype(int)))
        groups = _groups(of_series, window, bounds)
        # by how much the noise of each sample is in the squares of a group's integrals
        shares = np.zeros((len(groups), len(states)))
        for point, weight in enumerate(weights):
            for share, (_, _, starts) in zip(shares, groups, strict=True):
                share[starts + point] += weight**2
        values = denoised(states, variance, basis)
        integrals = sum(
            weight * values[:, point : point + windows] for point, weight in enumerate(weights)
        )
        # the noise of an increment is in its integral, too, with one sign at its beginning and the
        # other at its end: over a stretch it cancels
        increments = states[window:] - states[:-window]
        added = _squared_noise(states, variance, degree, values, shares)
        of_gram = np.zeros((stretches, size, size))
        of_cross = np.zeros((stretches, size, dimension))
        for (stretch, multiples, starts), from_noise in zip(groups, added, strict=True):
            part = np.ascontiguousarray(integrals[:, starts])
            of_gram[stretch] += np.kron(np.outer(multiples, multiples), part @ part.T - from_noise)
            of_cross[stretch] += np.kron(multiples[:, np.newaxis], part @ increments[starts])
        gram += list(of_gram)
        cross += list(of_cross)
    return np.array(gram), np.array(cross)


def _squared_noise(
    states: FloatArray, variance: FloatArray, degree: int, values: FloatArray, shares: FloatArray
) -> FloatArray:
    """Contribution of noise to the sums of products of two monomials, ``(stretches, m, m)``.

    It is the sum over samples of the product of the two values less the denoised product.
    """
    basis = monomials(states.shape[1], degree)
    if not variance.any():
        return np.zeros((len(shares), len(basis), len(basis)))
    products = monomials(states.shape[1], 2 * degree)
    sums = np.concatenate(
        [
            denoised(states, variance, products[first : first + _MONOMIALS_AT_ONCE]) @ shares.T
            for first in range(0, len(products), _MONOMIALS_AT_ONCE)
        ]
    )
    place = {factors: row for row, factors in enumerate(products)}
    rows = np.array([[place[tuple(sorted(first + second))] for second in basis] for first in basis])
    return np.array(
        [(values * share) @ values.T - sums[rows, stretch] for stretch, share in enumerate(shares)]
    )


def _significant(gram: FloatArray, cross: FloatArray, significance: float) -> FloatArray:
    """Least squares for one equation; the least significant term goes, and all are refitted."""
    kept = np.ones(gram.shape[1], dtype=bool)
    while True:
        coefficients, errors = _least_squares(gram, cross, kept)
        # a term without any scatter is certain
        ratios = np.abs(coefficients[kept]) - significance * errors[kept]
        if not kept.any() or significance == 0.0 or not (ratios < 0).any():
            return coefficients
        strength = np.full(kept.size, np.inf)
        strength[kept] = np.abs(coefficients[kept]) / np.maximum(errors[kept], np.finfo(float).tiny)
        kept[np.argmin(strength)] = False


def _conserving(
    coefficients: FloatArray, gram: FloatArray, cross: FloatArray, form: FloatArray
) -> FloatArray:
    """Coefficients ``(monomials, dimension)`` of least squares that conserve a quadratic form.

    Equations are weighted by their standard errors. Constant and linear terms that are zero stay
    so; quadratic terms are all there, since conservation adds up terms of several equations.
    ``gram``, ``cross``: Sums over the windows of each stretch.
    """
    constraints = _changes_of_form(form)
    quadratic: BoolArray = np.asarray(constraints.any(axis=(0, 2)))
    kept = (coefficients != 0) | quadratic[:, np.newaxis]
    total = gram.sum(axis=0)
    free, moved, blocks = np.zeros_like(coefficients), [], []
    for component in range(coefficients.shape[1]):
        here = kept[:, component]
        values, errors = _least_squares(gram, cross[:, :, component], here)
        inverse = _inverse(total[np.ix_(here, here)])
        covariance = np.mean(np.square(errors[here]) / np.diag(inverse)) * inverse
        free[:, component] = values
        acting = constraints[:, here, component]
        blocks.append((here, covariance @ acting.T))
        moved.append(acting @ blocks[-1][1])
    change = np.tensordot(constraints, free, axes=2)
    multipliers = np.linalg.lstsq(sum(moved), change, rcond=1e-12)[0]
    for component, (here, spread) in enumerate(blocks):
        free[here, component] -= spread @ multipliers
    return free


def _changes_of_form(form: FloatArray) -> FloatArray:
    """Change of a quadratic form by quadratic terms, ``(cubics, monomials, dimension)``.

    Each row, times the coefficients, is the coefficient of one cubic monomial in the time
    derivative of half the form.
    """
    dimension = len(form)
    basis = monomials(dimension, 2)
    cubics = monomials(dimension, 3)[len(basis) :]
    place: dict[Monomial, int] = {factors: row for row, factors in enumerate(cubics)}
    changes = np.zeros((len(cubics), len(basis), dimension))
    for row, factors in enumerate(basis):
        if len(factors) == 2:
            for component in range(dimension):
                changes[place[tuple(sorted((*factors, component)))], row] += form[component]
    return changes


def _least_squares(
    gram: FloatArray, cross: FloatArray, kept: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Coefficients of the terms that are kept, zero for the others, and their standard errors.

    The errors come from the scatter of the stretches of the series: the sandwich estimator of
    clustered data (Liang & Zeger, Biometrika 73, 1986).
    """
    rows = np.flatnonzero(kept)
    coefficients, errors = np.zeros(kept.size), np.zeros(kept.size)
    if rows.size == 0:
        return coefficients, errors
    part = gram[:, rows[:, np.newaxis], rows]
    inverse = _inverse(part.sum(axis=0))
    coefficients[rows] = inverse @ cross[:, rows].sum(axis=0)
    scores = cross[:, rows] - part @ coefficients[rows]
    errors[rows] = np.sqrt(np.square(scores @ inverse).sum(axis=0))
    return coefficients, errors


def _inverse(gram: FloatArray) -> FloatArray:
    """Pseudo-inverse of a matrix of moments, with its rows and columns in units of their size."""
    size = np.sqrt(np.diag(gram))
    units = np.outer(size, size)
    return np.asarray(np.linalg.pinv(gram / units, hermitian=True) / units)

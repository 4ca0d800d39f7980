"""A dynamical system whose equations are polynomials of the state."""

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.polynomials.basis import Monomial, monomials
from burstcast.systems.state_space import StateSpace


class PolynomialSystem(DynamicalSystem):
    """dx_i/dt = sum over m of coefficients[m, i] monomial_m(x), ``(monomials, dimension)``.

    ``observed``: What the equations stand for, whose observable they have.
    """

    def __init__(self, coefficients: FloatArray, degree: int, observed: StateSpace) -> None:
        basis = monomials(coefficients.shape[1], degree)
        if len(basis) != len(coefficients):
            raise ValueError(
                f"polynomials of degree {degree} in {coefficients.shape[1]} components have "
                f"{len(basis)} coefficients, not {len(coefficients)}"
            )
        self._equations = [
            [(basis[row], float(column[row])) for row in np.flatnonzero(column)]
            for column in coefficients.T
        ]
        self._observed = observed
        used = {monomial for terms in self._equations for monomial, _ in terms}
        needed = {monomial[:count] for monomial in used for count in range(2, len(monomial) + 1)}
        # to be made one after the other, each from a shorter one and a component
        self._products = sorted(needed, key=lambda monomial: (len(monomial), monomial))

    @property
    def dimension(self) -> int:  # type: ignore[override]
        """Number of components."""
        return len(self._equations)

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of the state; both of shape ``(dimension, ...)``."""
        value: dict[Monomial, FloatArray] = {
            (component,): state[component] for component in range(len(state))
        }
        for monomial in self._products:
            value[monomial] = value[monomial[:-1]] * state[monomial[-1]]
        rows = []
        for terms in self._equations:
            # term by term rather than by a product of matrices, whose order of summation would
            # depend on the size of the batch
            row = np.full_like(state[0], dict(terms).get((), 0.0))
            for monomial, coefficient in terms:
                if monomial:
                    row = row + coefficient * value[monomial]
            rows.append(row)
        return np.stack(rows)

    def jacobian(self, state: FloatArray) -> FloatArray:
        """Jacobian of the right-hand side, ``(dimension, dimension, ...)``."""
        jacobian = np.zeros((self.dimension, *state.shape))
        for row, terms in enumerate(self._equations):
            for monomial, coefficient in terms:
                for component in set(monomial):
                    rest = list(monomial)
                    rest.remove(component)
                    slope = np.full_like(state[0], coefficient * monomial.count(component))
                    for factor in rest:
                        slope = slope * state[factor]
                    jacobian[row, component] += slope
        return jacobian

    def observable(self, state: FloatArray) -> FloatArray:
        """Observable of the system that the equations stand for."""
        return self._observed.observable(state)

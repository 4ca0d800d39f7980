"""Learnt equations that know the parameters in force: coefficients linear in their factors.

The factors are scaled parameters, their inverses, or powers of either
(`burstcast.forecasters._parameter_factors`). That the equations depend on a parameter in such a way
is prior knowledge, as their degree is: the viscous terms of a flow are linear in 1/Re.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.exogenous import carry, of_series, of_washout
from burstcast.data.observation_noise import observation_noise
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters._options import AwareOptions, ObservationOptions, QuadraticOptions
from burstcast.forecasters._parameter_factors import ParameterFactors
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted
from burstcast.forecasters.quadratic import window_steps
from burstcast.systems.parameters import Parameters, stretches
from burstcast.systems.polynomials.basis import monomials
from burstcast.systems.polynomials.regression import SIGNIFICANCE, factored_coefficients
from burstcast.systems.polynomials.system import PolynomialSystem
from burstcast.systems.state_space import StateSpace


@dataclass(frozen=True)
class AwareQuadraticModel(ObservationOptions, QuadraticOptions, AwareOptions, IntegratedForecaster):
    """Integrates learnt equations under inputs from the last state of the washout.

    The system has the factors as further components of its state, which do not change by
    themselves: one program serves all values of the parameters.
    """

    may_diverge: ClassVar[bool] = True
    aware: ClassVar[bool] = True
    learns_parameters: ClassVar[bool] = True

    #: ``(1 + factors, monomials, dimension)``, in inverse time units
    coefficients: FloatArray = fitted()
    factors: ParameterFactors = fitted()  #: function from values of the parameters to the factors
    in_force: Parameters = fitted()  #: the parameters, and their values in the case

    def __repr__(self) -> str:
        if self.coefficients is None:
            return f"AwareQuadraticModel(by {', '.join(self.parameters)})"
        terms = [int((block != 0).sum()) for block in self.coefficients]
        return (
            f"AwareQuadraticModel({' + '.join(map(str, terms))} terms of "
            f"{self.coefficients.shape[2]} components, by {', '.join(self.factors.names)})"
        )

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Learn the equations; refuse series whose parameters do not vary."""
        states, schedules = of_series(training, case.system.dimension)
        factors = ParameterFactors.learnt(schedules, case.required_parameters, self)
        coefficients = factored_coefficients(
            states,
            observation_noise(states, self.noise),
            case.time_step * case.sampling_stride,
            self.degree,
            window_steps(self.window_lt, case.steps_per_lyapunov_time, training.shape[1]),
            SIGNIFICANCE,
            factors(schedules),
        )
        return self._of(coefficients, factors, case)

    def record(self) -> ForecasterRecord:
        """Coefficients of the equations, and how the parameters are scaled."""
        scaling = self.factors.record()
        return ForecasterRecord(
            {"coefficients": self.coefficients, **scaling.arrays}, scaling.attributes
        )

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Make the equations from their coefficients."""
        return self._of(
            record.arrays["coefficients"],
            ParameterFactors.restored(record, case.required_parameters),
            case,
        )

    def _of(
        self, coefficients: FloatArray, factors: ParameterFactors, case: ForecastingCase
    ) -> Self:
        return self.with_fitted(
            system=_with_factors(coefficients, self.degree, case.system),
            time_step=case.time_step,
            sampling_stride=case.sampling_stride,
            coefficients=coefficients,
            factors=factors,
            in_force=case.required_parameters,
        )

    @property
    def memory_size(self) -> int:
        """Components of the state without the factors."""
        return int(self.coefficients.shape[2])

    def start(self, washout: FloatArray) -> FloatArray:
        """Last state of the washout, ``(dimension, batch)``."""
        states, _, ahead = of_washout(washout, self.memory_size)
        return carry(super().start(states), ahead)

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Integrate the equations under the inputs (see `Forecaster.advance`)."""
        dimension = self.memory_size
        state, schedule, later = self.in_force.over(memory, dimension, steps)
        outputs = np.empty((steps, dimension, state.shape[1]))
        for part, factors in stretches(self.factors.of_schedule(schedule)):
            samples, last = super().advance(
                np.concatenate([state, factors]), part.stop - part.start
            )
            outputs[part], state = samples[:, :dimension], last[:dimension]
        return outputs, carry(np.ascontiguousarray(state), later)

    def advance_tangent(
        self, memory: FloatArray, tangent: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Integrate the linearised equations under the case's own values, too."""
        dimension, batch = memory.shape
        factors = self.factors.of_schedule(self.in_force.constant(1, batch))[0]
        still = np.zeros((len(factors), *tangent.shape[1:]))
        state, grown = super().advance_tangent(
            np.concatenate([memory, factors]), np.concatenate([tangent, still]), steps
        )
        return np.ascontiguousarray(state[:dimension]), np.ascontiguousarray(grown[:dimension])


class _ExtendedSpace:
    """States with factors appended, with the observable of the states."""

    def __init__(self, space: StateSpace) -> None:
        self._space = space
        self.observable_name = space.observable_name
        self.observable_symbol = space.observable_symbol
        self.dimension = space.dimension

    def observable(self, state: FloatArray) -> FloatArray:
        return self._space.observable(state[: self.dimension])


def _with_factors(coefficients: FloatArray, degree: int, space: StateSpace) -> PolynomialSystem:
    """Equations of states with factors appended: each learnt term times its factor."""
    blocks, _, dimension = coefficients.shape
    row = {
        factors: number
        for number, factors in enumerate(monomials(dimension + blocks - 1, degree + 1))
    }
    extended = np.zeros((len(row), dimension + blocks - 1))
    for block, of_block in enumerate(coefficients):
        factor = (dimension + block - 1,) if block else ()
        for monomial, values in zip(monomials(dimension, degree), of_block, strict=True):
            extended[row[monomial + factor], :dimension] = values
    return PolynomialSystem(extended, degree + 1, _ExtendedSpace(space))

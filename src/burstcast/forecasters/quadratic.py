"""Learnt equations: polynomials of the state, quadratic ones by default.

That the dynamics are polynomials of an observed state is prior knowledge; which ones, is learnt
from the noisy training series (`burstcast.polynomials.regression`).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase
from burstcast.observation_noise import observation_noise
from burstcast.polynomials.regression import polynomial_coefficients
from burstcast.polynomials.system import PolynomialSystem
from burstcast.systems.integration import integrate
from burstcast.systems.lyapunov import with_perturbations


@dataclass(frozen=True)
class QuadraticModel(Forecaster):
    """Integrates learnt equations from the last state of the washout.

    Attributes
    ----------
    coefficients
        Of the equations, ``(monomials, dimension)``, in inverse time units.
    system
        The equations.
    time_step, sampling_stride
        Of the integration: time units, and integration steps in a step of the forecast.
    """

    coefficients: FloatArray
    system: PolynomialSystem
    time_step: float
    sampling_stride: int

    @classmethod
    def fit(cls, training: FloatArray, case: ForecastingCase) -> Self:
        """Learn the equations (see `Forecaster.fit`).

        Raises
        ------
        ValueError
            If the window is shorter than a step, or the series do not determine the equations.
        """
        options = case.options
        window = durations.steps(options["window_lt"], case.steps_per_lyapunov_time)
        if window < 1:
            raise ValueError(
                f"forecasters.quadratic.window_lt is {options['window_lt']}; it must be at least "
                f"one step: a Lyapunov time has {case.steps_per_lyapunov_time}"
            )
        coefficients = polynomial_coefficients(
            training,
            observation_noise(training, options["noise"]),
            case.time_step * case.sampling_stride,
            options["degree"],
            window,
            options["significance"],
        )
        return cls.restore(ForecasterRecord({"coefficients": coefficients}), case)

    def record(self) -> ForecasterRecord:
        """Coefficients of the equations."""
        return ForecasterRecord({"coefficients": self.coefficients})

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Make the equations from their coefficients."""
        coefficients = record.arrays["coefficients"]
        system = PolynomialSystem(coefficients, case.options["degree"], case.system)
        return cls(coefficients, system, case.time_step, case.sampling_stride)

    def start(self, washout: FloatArray) -> FloatArray:
        """Last state of the washout, ``(dimension, batch)``."""
        return np.ascontiguousarray(washout[-1])

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Integrate the equations (see `Forecaster.advance`)."""
        samples = integrate(
            self.system,
            memory,
            self.time_step,
            steps * self.sampling_stride,
            stride=self.sampling_stride,
            may_diverge=True,
        )
        return samples[1:], samples[-1]

    def advance_tangent(
        self, memory: FloatArray, tangent: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Integrate the linearised equations, too (see `Forecaster.advance_tangent`)."""
        return with_perturbations(
            self.system, memory, tangent, self.time_step, steps * self.sampling_stride
        )

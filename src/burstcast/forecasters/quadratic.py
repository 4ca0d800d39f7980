"""Learnt equations: polynomials of the state, quadratic ones by default.

That the dynamics are polynomials of an observed state is prior knowledge; which ones, is learnt
from the noisy training series (`burstcast.polynomials.regression`).
"""

from dataclasses import dataclass
from typing import ClassVar, Self

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.observation_noise import observation_noise
from burstcast.polynomials.regression import polynomial_coefficients
from burstcast.polynomials.system import PolynomialSystem


@dataclass(frozen=True)
class QuadraticModel(IntegratedForecaster):
    """Integrates learnt equations from the last state of the washout.

    Attributes
    ----------
    coefficients
        Of the equations, ``(monomials, dimension)``, in inverse time units.
    """

    may_diverge: ClassVar[bool] = True

    coefficients: FloatArray

    def __repr__(self) -> str:
        """How many terms there are, no coefficients."""
        terms, components = int((self.coefficients != 0).sum()), self.coefficients.shape[1]
        return f"QuadraticModel({terms} terms of {components} components)"

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
        return cls(system, case.time_step, case.sampling_stride, coefficients)

"""Learnt equations: polynomials of the state, quadratic ones by default.

That the dynamics are polynomials of an observed state is prior knowledge; which ones, is learnt
from the noisy training series (`burstcast.systems.polynomials.regression`).
"""

from dataclasses import dataclass
from typing import ClassVar, Self

from burstcast.base import durations
from burstcast.base.arrays import FloatArray
from burstcast.data.observation_noise import observation_noise
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters._options import ObservationOptions, QuadraticOptions
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted
from burstcast.systems.polynomials.regression import SIGNIFICANCE, factored_coefficients
from burstcast.systems.polynomials.system import PolynomialSystem


def window_steps(window_lt: float, steps_per_lyapunov_time: int, length: int) -> int:
    """Steps of the window that equations are learnt from, in series of ``length`` samples."""
    name = "window_lt of learnt equations (in a campaign: forecasters.quadratic.window_lt)"
    window = durations.positive_steps(window_lt, steps_per_lyapunov_time, name)
    if window >= length:
        raise ValueError(f"{name} is {window} steps, but a series has {length} samples")
    return window


@dataclass(frozen=True)
class QuadraticModel(ObservationOptions, QuadraticOptions, IntegratedForecaster):
    """Integrates learnt equations from the last state of the washout."""

    may_diverge: ClassVar[bool] = True

    #: coefficients of the equations, ``(monomials, dimension)``, in inverse time units
    coefficients: FloatArray = fitted()

    def __repr__(self) -> str:
        if self.coefficients is None:
            return f"QuadraticModel(degree={self.degree}, window_lt={self.window_lt:g})"
        terms, components = int((self.coefficients != 0).sum()), self.coefficients.shape[1]
        return f"QuadraticModel({terms} terms of {components} components)"

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Learn the equations (see `Forecaster.fit`)."""
        window = window_steps(self.window_lt, case.steps_per_lyapunov_time, training.shape[1])
        coefficients = factored_coefficients(
            training,
            observation_noise(training, self.noise),
            case.time_step * case.sampling_stride,
            self.degree,
            window,
            SIGNIFICANCE,
        )[0]
        return self.restore(ForecasterRecord({"coefficients": coefficients}), case)

    def record(self) -> ForecasterRecord:
        """Coefficients of the equations."""
        return ForecasterRecord({"coefficients": self.coefficients})

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Make the equations from their coefficients."""
        coefficients = record.arrays["coefficients"]
        system = PolynomialSystem(coefficients, self.degree, case.system)
        return self.with_fitted(
            system=system,
            time_step=case.time_step,
            sampling_stride=case.sampling_stride,
            coefficients=coefficients,
        )

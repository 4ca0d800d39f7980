"""Factors of models that depend on parameters: monomials of the scaled parameters.

A parameter p enters as q = (t(p) - centre) / half range, where t is a transform, and t(p) has this
centre and half range over the training values: q lies in [-1, 1] there. The learnt model is linear
in the factors q, q^2, ... up to a degree, and in products of different parameters. Viscous terms of
a flow, for instance, are linear in the inverse of the Reynolds number.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.exogenous import of_series
from burstcast.forecasters._options import AwareOptions
from burstcast.forecasters._record import ForecasterRecord
from burstcast.networks.factored import FactoredSeries
from burstcast.networks.training import TrainingSeries
from burstcast.systems.parameters import Parameters
from burstcast.systems.polynomials.basis import monomials

TRANSFORMS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "identity": np.positive,
    "inverse": np.reciprocal,
}
"""Transforms of a parameter by name."""


@dataclass(frozen=True)
class ParameterFactors:
    """Factors of parameters, scaled by the values in training.

    Parameters that are constant in training have no factor: nothing can be learnt of them.

    Examples
    --------
    >>> trained = np.array([[400.0], [600.0], [1000.0]])
    >>> factors = ParameterFactors.of(["reynolds"], trained, "inverse", 2)
    >>> factors(np.array([[400.0], [1000.0]])).round(6)
    array([[ 1.,  1.],
           [-1.,  1.]])
    """

    names: tuple[str, ...]  #: names of the parameters
    #: low, high: smallest and largest value of each parameter in training, ``(parameters,)``
    low: FloatArray
    high: FloatArray
    transform: str  #: a name in `TRANSFORMS`
    degree: int  #: highest degree of the factors, at least 1

    def __post_init__(self) -> None:
        if self.transform not in TRANSFORMS:
            raise ValueError(
                f"unknown transform of a parameter {self.transform!r}; known are "
                f"{', '.join(TRANSFORMS)}"
            )
        if self.degree < 1:
            raise ValueError(f"the degree in the parameters must be 1 at least, not {self.degree}")
        if self.transform == "inverse" and not (self.low * self.high > 0).all():
            raise ValueError(
                f"the values of {', '.join(self.names)} have no inverse in between: they must all "
                f"be positive, or all negative; take the transform 'identity'"
            )

    @classmethod
    def of(
        cls, names: Sequence[str], values: FloatArray, transform: str, degree: int
    ) -> "ParameterFactors":
        """Factors scaled by training values ``(..., parameters)``."""
        flat = values.reshape(-1, len(names))
        return cls(tuple(names), flat.min(axis=0), flat.max(axis=0), transform, degree)

    @classmethod
    def learnt(
        cls, schedules: FloatArray, parameters: Parameters, options: AwareOptions
    ) -> "ParameterFactors":
        """Factors scaled by the inputs of training series; at least one parameter must vary.

        ``schedules``: ``(series, time - 1, parameters)``; empty where the case's own values are in
        force throughout.
        """
        names = parameters.names
        if schedules.size:
            factors = cls.of(names, schedules, options.transform, options.parameter_degree)
            if factors.count:
                return factors
        raise ValueError(
            f"{', '.join(names)} does not vary in training, so that nothing can be learnt of it: "
            f"train on series under several values, or take a kind that is not aware"
        )

    def record(self) -> ForecasterRecord:
        """Record of the factors in a forecaster's."""
        return ForecasterRecord(
            {"parameter_low": self.low, "parameter_high": self.high},
            {"transform": self.transform, "parameter_degree": self.degree},
        )

    @classmethod
    def restored(cls, record: ForecasterRecord, parameters: Parameters) -> "ParameterFactors":
        """Factors from a forecaster's record."""
        return cls(
            parameters.names,
            record.arrays["parameter_low"],
            record.arrays["parameter_high"],
            str(record.attributes["transform"]),
            int(record.attributes["parameter_degree"]),
        )

    @property
    def count(self) -> int:
        """Number of factors; 0 if no parameter varies in training."""
        return len(self._monomials)

    def __call__(self, values: FloatArray) -> FloatArray:
        """Factors ``(..., factors)`` of values ``(..., parameters)``.

        Values beyond those in training are extrapolated, with a warning.
        """
        if message := self.outside(values):
            warnings.warn(message, stacklevel=2)
        with np.errstate(divide="ignore"):
            transformed = TRANSFORMS[self.transform](values[..., self._varying])
        if not np.isfinite(transformed).all():
            raise ValueError(f"a value of {', '.join(self.names)} is not finite, or has no inverse")
        centre, half_range = self._scale
        scaled = (transformed - centre) / half_range
        factors = np.ones((*values.shape[:-1], self.count))
        for number, monomial in enumerate(self._monomials):
            for parameter in monomial:
                factors[..., number] *= scaled[..., parameter]
        return factors

    def of_schedule(self, schedule: FloatArray) -> FloatArray:
        """Factors ``(steps, factors, batch)`` of a schedule ``(steps, parameters, batch)``."""
        return np.ascontiguousarray(np.moveaxis(self(np.moveaxis(schedule, 1, -1)), -1, 1))

    def outside(self, values: FloatArray) -> str | None:
        """Describe values ``(..., parameters)`` outside of the training range; None: none are.

        A tenth of a per cent of the range is allowed for rounding.
        """
        slack = 1e-3 * (self.high - self.low)
        flat = values.reshape(-1, len(self.names))
        beyond = (flat < self.low - slack) | (flat > self.high + slack)
        if not beyond.any():
            return None
        row, column = (int(index) for index in np.argwhere(beyond)[0])
        return (
            f"{self.names[column]} = {flat[row, column]:g} lies outside of the values in training, "
            f"{self.low[column]:g} to {self.high[column]:g}: forecasts are extrapolated"
        )

    @cached_property
    def _varying(self) -> IntArray:
        return np.flatnonzero(self.high > self.low)

    @cached_property
    def _monomials(self) -> list[tuple[int, ...]]:
        varying = len(self._varying)
        return monomials(varying, self.degree)[1:] if varying else []

    @cached_property
    def _scale(self) -> tuple[FloatArray, FloatArray]:
        """Centre and half range of each transformed parameter that varies."""
        ends = TRANSFORMS[self.transform](np.stack([self.low, self.high])[:, self._varying])
        return ends.mean(axis=0), np.abs(ends[1] - ends[0]) / 2


def factored_training(
    training: TrainingSeries, parameters: Parameters, options: AwareOptions
) -> FactoredSeries:
    """Training series of a network that knows the parameters.

    ``training``: Series with their inputs. ``parameters``: What the inputs are.
    """
    _, schedules = of_series(training.observed, len(training.input_range))
    factors = ParameterFactors.learnt(schedules, parameters, options)
    return factored(training, factors, parameters)


def factored(
    training: TrainingSeries, factors: ParameterFactors, parameters: Parameters
) -> FactoredSeries:
    """Training series with factors in place of inputs."""
    states, schedules = of_series(training.observed, len(training.input_range))
    if not schedules.size:
        raise ValueError("the training series of this network have inputs")
    return FactoredSeries(
        states,
        training.input_range,
        training.input_offset,
        factors=factors(schedules),
        knowledge={"factors": factors, "in_force": parameters},
    )

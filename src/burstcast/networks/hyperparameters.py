"""The searched hyperparameters, the space they are searched in, and the grid that covers it."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class HyperparameterPoint:
    """Hyperparameters at which a network is evaluated."""

    spectral_radius: float  #: rho, of the recurrent matrix
    input_scaling: float  #: sigma_in, of the input matrix
    leak_rate: float = 1.0  #: a, of the neurons


@dataclass(frozen=True)
class SurrogateSettings:
    """Settings of the Gaussian process that chooses points after the grid."""

    #: bounds of the process's variance, in variances of the known objectives
    variance: tuple[float, float] = (1e-2, 1e3)
    #: bounds of its length scales, in decades of the hyperparameters
    length_scale: tuple[float, float] = (1e-2, 1e2)
    #: length scale from which the fit to the known objectives starts
    first_length_scale: float = 1.0
    random_state: int | None = None  #: seed of the optimiser; None: each network has its own


DEFAULT_SURROGATE = SurrogateSettings()


@dataclass(frozen=True)
class SearchSpace:
    """Bounds of the search, which goes on in logarithmic scale."""

    #: spectral_radius, input_scaling: lower and upper bound of each; positive
    spectral_radius: tuple[float, float]
    input_scaling: tuple[float, float]
    leak_rates: tuple[float, ...] = (1.0,)  #: of which the search takes one

    def __post_init__(self) -> None:
        for name in ("spectral_radius", "input_scaling"):
            low, high = getattr(self, name)
            if not 0 < low < high:
                raise ValueError(
                    f"the bounds of {name} must be positive and increasing, not {low}, {high}"
                )

    def grid(self, points: int) -> list[HyperparameterPoint]:
        """Grid of ``points`` x ``points`` in logarithmic scale with corners, at each leak rate."""
        return [
            HyperparameterPoint(float(rho), float(sigma), float(leak))
            for leak, rho, sigma in itertools.product(
                self.leak_rates,
                np.geomspace(*self.spectral_radius, points),
                np.geomspace(*self.input_scaling, points),
            )
        ]

    def point(self, logarithm: Sequence[float], leak_rate: float = 1.0) -> HyperparameterPoint:
        """Point with these decimal logarithms, moved onto the bounds where rounding left them."""
        rho, sigma = (
            float(np.clip(10.0**exponent, *bounds))
            for exponent, bounds in zip(
                logarithm, (self.spectral_radius, self.input_scaling), strict=True
            )
        )
        return HyperparameterPoint(rho, sigma, leak_rate)

    def logarithm(self, point: HyperparameterPoint) -> list[float]:
        """Decimal logarithms of a point, moved onto the bounds where rounding has left them."""
        return [
            float(np.clip(np.log10(value), *np.log10(bounds)))
            for value, bounds in (
                (point.spectral_radius, self.spectral_radius),
                (point.input_scaling, self.input_scaling),
            )
        ]

"""The searched hyperparameters, the space they are searched in, and the grid that covers it."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class HyperparameterPoint:
    """Hyperparameters at which a network is evaluated.

    Attributes
    ----------
    spectral_radius
        rho, of the recurrent matrix.
    input_scaling
        sigma_in, of the input matrix.
    """

    spectral_radius: float
    input_scaling: float


@dataclass(frozen=True)
class SurrogateSettings:
    """Settings of the Gaussian process that chooses points after the grid.

    Attributes
    ----------
    variance
        Bounds of the process's variance, in variances of the known objectives.
    length_scale
        Bounds of its length scales, in decades of the hyperparameters.
    first_length_scale
        Length scale from which the fit to the known objectives starts.
    random_state
        Seed of the optimiser; None: each network has its own.
    """

    variance: tuple[float, float] = (1e-2, 1e3)
    length_scale: tuple[float, float] = (1e-2, 1e2)
    first_length_scale: float = 1.0
    random_state: int | None = None


DEFAULT_SURROGATE = SurrogateSettings()


@dataclass(frozen=True)
class SearchSpace:
    """Bounds of the search, which goes on in logarithmic scale.

    Attributes
    ----------
    spectral_radius, input_scaling
        Lower and upper bound of each; positive.
    """

    spectral_radius: tuple[float, float]
    input_scaling: tuple[float, float]

    def __post_init__(self) -> None:
        """Check the bounds.

        Raises
        ------
        ValueError
            If they are not positive and increasing.
        """
        for name in ("spectral_radius", "input_scaling"):
            low, high = getattr(self, name)
            if not 0 < low < high:
                raise ValueError(
                    f"the bounds of {name} must be positive and increasing, not {low}, {high}"
                )

    def grid(self, points: int) -> list[HyperparameterPoint]:
        """Regular grid of ``points`` x ``points`` in logarithmic scale, corners included."""
        return [
            HyperparameterPoint(float(rho), float(sigma))
            for rho, sigma in itertools.product(
                np.geomspace(*self.spectral_radius, points),
                np.geomspace(*self.input_scaling, points),
            )
        ]

    def point(self, logarithm: Sequence[float]) -> HyperparameterPoint:
        """Point with these decimal logarithms, moved onto the bounds where rounding left them."""
        rho, sigma = (
            float(np.clip(10.0**exponent, *bounds))
            for exponent, bounds in zip(
                logarithm, (self.spectral_radius, self.input_scaling), strict=True
            )
        )
        return HyperparameterPoint(rho, sigma)

    def logarithm(self, point: HyperparameterPoint) -> list[float]:
        """Decimal logarithms of a point, moved onto the bounds where rounding has left them."""
        return [
            float(np.clip(np.log10(value), *np.log10(bounds)))
            for value, bounds in (
                (point.spectral_radius, self.spectral_radius),
                (point.input_scaling, self.input_scaling),
            )
        ]

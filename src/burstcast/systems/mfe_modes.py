"""The nine modes of the MFE flow: from amplitudes to velocity, vorticity and velocity statistics.

Modes of Moehlis, Faisst and Eckhardt, New Journal of Physics 6 (2004) 56. Each
component of each is a product of a function of x, one of y and one of z, and all derivatives and
averages here are the exact ones of these functions. The walls are at y = -1 and y = 1.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from burstcast.base.arrays import FloatArray
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.state_space import StateSpace

_MODES = 9


class _Factor(NamedTuple):
    """A function of one coordinate: "one", or "sin", "cos" or "cos_squared" of wavenumber * s."""

    kind: str
    wavenumber: float

    def __call__(self, coordinate: FloatArray) -> FloatArray:
        phase = self.wavenumber * coordinate
        if self.kind == "one":
            return np.ones_like(phase)
        if self.kind == "sin":
            return np.sin(phase)
        if self.kind == "cos":
            return np.cos(phase)
        return np.square(np.cos(phase))

    def derivative(self) -> tuple[float, "_Factor"]:
        """Return the derivative as a number times another function."""
        if self.kind == "one":
            return 0.0, self
        if self.kind == "sin":
            return self.wavenumber, _Factor("cos", self.wavenumber)
        if self.kind == "cos":
            return -self.wavenumber, _Factor("sin", self.wavenumber)
        return -self.wavenumber, _Factor("sin", 2.0 * self.wavenumber)

    def mean_product(self, other: "_Factor") -> float:
        """Mean over a period of the product of two of "one", "sin" and "cos" (orthogonal)."""
        if self != other:
            return 0.0
        return 1.0 if self.kind == "one" else 0.5


class _Term(NamedTuple):
    """Contribution of one mode to one component of a field."""

    mode: int  # counted from 0
    coefficient: float
    x: _Factor
    y: _Factor
    z: _Factor

    def times(self, number: float) -> "_Term":
        return self._replace(coefficient=number * self.coefficient)

    def derivative(self, direction: str) -> "_Term":
        """Differentiate in "x", "y" or "z"."""
        number, factor = getattr(self, direction).derivative()
        return self.times(number)._replace(**{direction: factor})


_Component = tuple[_Term, ...]


@dataclass(frozen=True)
class ProfileMatrices:
    """Averages over x and z of products of velocities, as forms in the amplitudes.

    With the mean amplitudes m_i and the second moments M_ij (the averages over time of a_i and of
    a_i a_j), the profiles averaged over x, z and time are ``u @ m``, ``sum_ij uu_ij M_ij`` and
    ``sum_ij uv_ij M_ij``. See `profiles`.
    """

    u: FloatArray  #: ``(points in y, 9)``
    #: uu, uv: ``(points in y, 9, 9)``
    uu: FloatArray
    uv: FloatArray

    def profiles(
        self, mean: FloatArray, second_moments: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Profiles of u, u^2 and uv from time means of a_i, ``(9,)``, and a_i a_j, ``(9, 9)``."""
        return (
            self.u @ mean,
            np.tensordot(self.uu, second_moments, axes=2),
            np.tensordot(self.uv, second_moments, axes=2),
        )


@dataclass(frozen=True)
class MoehlisFaisstEckhardtModes:
    """The modes in a box of a given size.

    Fields are returned with the component first, then the further axes of the amplitudes (times,
    say), then the axes of the grid: ``(3, ..., *grid)``. The coordinates are arrays that broadcast
    to the grid, such as the arrays of ``numpy.meshgrid(x, y, z, indexing="ij", sparse=True)``.
    """

    #: length_x, length_z: periods of the flow in x and z
    length_x: float = 4.0 * math.pi
    length_z: float = 2.0 * math.pi

    def __post_init__(self) -> None:
        for name in ("length_x", "length_z"):
            value = getattr(self, name)
            if not (value > 0.0 and math.isfinite(value)):
                raise ValueError(f"{name} must be positive and finite, not {value}")

    def velocity(
        self, amplitudes: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray
    ) -> FloatArray:
        """Velocity (u, v, w) of amplitudes ``(9, ...)``; ``(3, ..., *grid)``."""
        return _fields(self._velocity_terms(), amplitudes, x, y, z)

    def vorticity(
        self, amplitudes: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray
    ) -> FloatArray:
        """Vorticity, the curl of the velocity, of amplitudes ``(9, ...)``; ``(3, ..., *grid)``."""
        u, v, w = self._velocity_terms()
        components = (
            _difference(w, "y", v, "z"),
            _difference(u, "z", w, "x"),
            _difference(v, "x", u, "y"),
        )
        return _fields(components, amplitudes, x, y, z)

    def midplane_velocity(self, amplitudes: FloatArray, x: FloatArray, z: FloatArray) -> FloatArray:
        """Velocity u in the midplane y = 0 of amplitudes ``(9, ...)``: ``(..., x, z)``."""
        u = self._velocity_terms()[0]
        plane: FloatArray = _fields([u], amplitudes, x[:, np.newaxis], np.zeros(()), z)[0]
        return plane

    def midplane_mean_square(
        self, second_moments: FloatArray, x: FloatArray, z: FloatArray
    ) -> FloatArray:
        """Time average of u^2 in the midplane, from the means of a_i a_j, ``(9, 9)``."""
        modes = self.midplane_velocity(np.eye(_MODES), x, z)
        square: FloatArray = np.einsum(
            "ixz,ij,jxz->xz", modes, second_moments, modes, optimize=True
        )
        return square

    def profile_matrices(self, y: FloatArray) -> ProfileMatrices:
        """Averages over x and z at the heights ``y``, see `ProfileMatrices`."""
        u, v, _ = self._velocity_terms()
        # the constant 1 as a field of one term: its products with u are u itself
        unity = _Term(mode=0, coefficient=1.0, x=_ONE, y=_ONE, z=_ONE)
        return ProfileMatrices(
            u=_mean_products(u, [unity], y)[:, :, 0],
            uu=_mean_products(u, u, y),
            uv=_mean_products(u, v, y),
        )

    def _velocity_terms(self) -> tuple[_Component, _Component, _Component]:
        """Tabulate the modes by component: u, v and w."""
        pi = math.pi
        alpha = 2.0 * pi / self.length_x
        gamma = 2.0 * pi / self.length_z
        square = alpha**2 + gamma**2
        n3 = 2.0 / math.sqrt(4.0 * gamma**2 + pi**2)
        n6 = 4.0 * math.sqrt(2.0 / (3.0 * square))
        n7 = 2.0 * math.sqrt(2.0 / square)
        n8 = 2.0 * math.sqrt(2.0 / (square * (4.0 * square + pi**2)))
        sin_x, cos_x = _Factor("sin", alpha), _Factor("cos", alpha)
        sin_z, cos_z = _Factor("sin", gamma), _Factor("cos", gamma)
        sin_y, cos_y = _Factor("sin", pi / 2.0), _Factor("cos", pi / 2.0)
        cos2_y, sin3_y = _Factor("cos_squared", pi / 2.0), _Factor("sin", 1.5 * pi)
        u = (
            _Term(0, math.sqrt(2.0), _ONE, sin_y, _ONE),
            _Term(1, 4.0 / math.sqrt(3.0), _ONE, cos2_y, cos_z),
            _Term(5, -n6 * gamma, cos_x, cos2_y, sin_z),
            _Term(6, n7 * gamma, sin_x, sin_y, sin_z),
            _Term(7, n8 * pi * alpha, sin_x, sin_y, sin_z),
            _Term(8, math.sqrt(2.0), _ONE, sin3_y, _ONE),
        )
        v = (
            _Term(2, n3 * 2.0 * gamma, _ONE, cos_y, cos_z),
            _Term(7, n8 * 2.0 * square, cos_x, cos_y, sin_z),
        )
        w = (
            _Term(2, n3 * pi, _ONE, sin_y, sin_z),
            _Term(3, 4.0 / math.sqrt(3.0), cos_x, cos2_y, _ONE),
            _Term(4, 2.0, sin_x, sin_y, _ONE),
            _Term(5, n6 * alpha, sin_x, cos2_y, cos_z),
            _Term(6, n7 * alpha, cos_x, sin_y, cos_z),
            _Term(7, -n8 * pi * gamma, cos_x, sin_y, cos_z),
        )
        return u, v, w


_ONE = _Factor("one", 0.0)


def _difference(
    first: _Component, first_direction: str, second: _Component, second_direction: str
) -> _Component:
    """Subtract a derivative of one component from a derivative of another."""
    added = tuple(term.derivative(first_direction) for term in first)
    return added + tuple(term.derivative(second_direction).times(-1.0) for term in second)


def _fields(
    components: Iterable[_Component],
    amplitudes: FloatArray,
    x: npt.ArrayLike,
    y: npt.ArrayLike,
    z: npt.ArrayLike,
) -> FloatArray:
    """Sum the terms of each component; ``(components, *amplitudes.shape[1:], *grid)``."""
    if len(amplitudes) != _MODES:
        raise ValueError(f"there must be {_MODES} amplitudes, not {len(amplitudes)}")
    x, y, z = (np.asarray(coordinate, dtype=np.float64) for coordinate in (x, y, z))
    grid = np.broadcast_shapes(x.shape, y.shape, z.shape)
    fields = []
    for component in components:
        field = np.zeros(amplitudes.shape[1:] + grid)
        for term in component:
            # the factors of one coordinate each stay small until they are multiplied
            shape = (term.x(x) * term.z(z)) * (term.coefficient * term.y(y))
            field += np.multiply.outer(amplitudes[term.mode], shape)
        fields.append(field)
    return np.stack(fields)


def flow_modes(system: StateSpace) -> MoehlisFaisstEckhardtModes | None:
    """Velocity modes that a system's state is the amplitudes of; None for other systems."""
    if isinstance(system, MoehlisFaisstEckhardt):
        return MoehlisFaisstEckhardtModes(system.length_x, system.length_z)
    return None


def _mean_products(first: Iterable[_Term], second: Iterable[_Term], y: FloatArray) -> FloatArray:
    """Averages over x and z of the products of two components' terms, ``(len(y), 9, 9)``."""
    matrices = np.zeros((len(y), _MODES, _MODES))
    for a in first:
        for b in second:
            mean = a.x.mean_product(b.x) * a.z.mean_product(b.z)
            matrices[:, a.mode, b.mode] += mean * a.coefficient * b.coefficient * (a.y(y) * b.y(y))
    return matrices

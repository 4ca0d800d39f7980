"""The two-dimensional Kolmogorov flow, a turbulent flow whose dissipation has bursts.

Source: M. Farazmand, T. P. Sapsis, "A variational approach to probing extreme events in turbulent
dynamical systems", Science Advances 3 (2017) e1701533. The flow is periodic in a square of side
2 pi, and a force sin(n y) drives it along x; it obeys the Navier-Stokes equations.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import ArrayLike, NDArray

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.systems.base import EnergyBudget, Symmetry
from burstcast.systems.exponential_scheme import SemilinearSystem

ComplexArray = NDArray[np.complex128]

# Squared wavenumber up to which moduli are invariants: 54 wave vectors.
_LOW = 34
# Trajectories that are transformed together: their grids stay in the cache.
_BLOCK = 16


@dataclass(frozen=True)
class KolmogorovFlow(SemilinearSystem):
    r"""Kolmogorov flow in the amplitudes of its Fourier modes; the observable is the dissipation.

    With vorticity w and velocity (u, v), dw/dt + u dw/dx + v dw/dy = (1/Re) Laplacian(w) - n cos(n
    y). A state holds the amplitudes of orthonormal velocity modes: for each wave vector k of
    `wave_vectors`, a_k and b_k with w = sum_k sqrt(2) |k| (a_k cos(k x) - b_k sin(k x)); all a_k
    come first, then all b_k. The kinetic energy, half the mean square of the velocity, is then half
    the squared length of the state, and the dissipation is (1/Re) sum_k |k|^2 (a_k^2 + b_k^2).

    Products are computed on a grid without aliasing (3/2 rule), so that the truncated equations
    conserve energy and enstrophy except for the force and viscosity.
    """

    reynolds: float = 40.0  #: Reynolds number, the inverse of the viscosity. The flow bursts at 40.
    forcing_wavenumber: float = 4  #: wavenumber n of the force, a whole number
    #: largest wavenumber K in each direction, a whole number: a state has (2 K + 1)^2 - 1
    #: components. Flows with 7 burst twice as often as those with 10 or 15.
    largest_wavenumber: float = 10
    #: growth rate that a force in phase with the large-scale mode, the wave vector (1, 0), gives
    #: its amplitude while it is small, in inverse units of time; 0: there is no such force. An
    #: actuator that keeps up the mode whose collapse precedes a burst.
    large_scale_growth: float = 0.0
    #: modulus of the large-scale mode at which this force vanishes, and beyond which it damps the
    #: mode: the growth rate falls with the squared modulus, so that no force diverges. At Re = 40
    #: the modulus is 0.89 in the median, and 1.11 at most.
    large_scale_limit: float = 1.0

    observable_name: ClassVar[str] = "dissipation"
    observable_symbol: ClassVar[str] = "D"
    case_defaults: ClassVar[Mapping[str, Any]] = {
        "event_threshold": 0.195,  # mean and two standard deviations at Re = 40
        "ensemble": {
            "time_step": 0.05,
            "sampling_stride": 10,
            "transient": 300.0,
            "duration": 3000.0,
        },
        "density": {"range": [0.05, 0.45]},
        "controlled_density": {"range": [0.05, 0.45]},
        "fixed_point": {"variation": 0.001, "above": 0.0},
        "lyapunov": {"orthonormalisation_interval": 2.0},
    }

    def __post_init__(self) -> None:
        if not (math.isfinite(self.reynolds) and self.reynolds > 0.0):
            raise ValueError(f"reynolds must be positive and finite, not {self.reynolds}")
        if not math.isfinite(self.large_scale_growth):
            raise ValueError(f"large_scale_growth must be finite, not {self.large_scale_growth}")
        if not (math.isfinite(self.large_scale_limit) and self.large_scale_limit > 0.0):
            raise ValueError(
                f"large_scale_limit must be positive and finite, not {self.large_scale_limit}"
            )
        for name in ("forcing_wavenumber", "largest_wavenumber"):
            value = getattr(self, name)
            if not (value >= 1 and float(value).is_integer()):
                raise ValueError(f"{name} must be a positive whole number, not {value}")
            object.__setattr__(self, name, int(value))
        if self.forcing_wavenumber > self.largest_wavenumber:
            raise ValueError(
                f"forcing_wavenumber must be at most largest_wavenumber, "
                f"{self.largest_wavenumber}, not {self.forcing_wavenumber}"
            )

    @property
    def dimension(self) -> int:  # type: ignore[override]  # of other systems a class variable
        """Number of components, (2 K + 1)^2 - 1."""
        return 2 * len(self._modes.vectors)

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names by wave vector, with m for minus: "a_1_m4" is the first amplitude of (1, -4)."""
        names = [f"{x}_{y}".replace("-", "m") for x, y in self._modes.vectors]
        return tuple(f"{part}_{name}" for part in "ab" for name in names)

    @property
    def wave_vectors(self) -> IntArray:
        """Wave vectors (kx, ky) of the amplitudes, ``(dimension / 2, 2)``: half of all of them."""
        return self._modes.vectors.copy()

    @property
    def _modes(self) -> "_Modes":
        return _modes(int(self.largest_wavenumber))

    def linear_rates(self) -> FloatArray:
        """Rates of viscosity, -|k|^2 / Re, and of a weak large-scale mode, ``(dimension,)``."""
        rates: FloatArray = -np.tile(self._modes.square, 2) / self.reynolds
        rates[self._large_scale] += self.large_scale_growth
        return rates

    def nonlinear(self, state: FloatArray) -> FloatArray:
        """Advection and forces, ``(dimension, ...)``."""
        columns = state.reshape(self.dimension, -1)
        change = np.empty_like(columns)
        for start in range(0, columns.shape[1], _BLOCK):
            block = slice(start, start + _BLOCK)
            change[:, block] = _advection(columns[:, block], self._modes)
        change[self._forced] -= math.sqrt(0.5)
        if self.large_scale_growth:
            mode = columns[self._large_scale]
            change[self._large_scale] -= self.large_scale_growth * self._saturation(mode) * mode
        return change.reshape(state.shape)

    def _saturation(self, mode: FloatArray) -> FloatArray:
        """Share of the growth that the large-scale mode ``(2, ...)`` has lost; above 1, damping."""
        share: FloatArray = np.square(mode / self.large_scale_limit).sum(axis=0)
        return share

    @property
    def _large_scale(self) -> list[int]:
        """Components a and b of the wave vector (1, 0)."""
        place = self._modes.place[1, 0]
        return [place, place + self.dimension // 2]

    @property
    def _forced(self) -> int:
        """Component that the force drives: a of the wave vector (0, n)."""
        return self._modes.place[0, int(self.forcing_wavenumber)]

    def observable(self, state: FloatArray) -> FloatArray:
        """Dissipation: the mean square of the vorticity over the Reynolds number, ``(...)``."""
        square = np.tile(self._modes.square, 2).reshape((-1,) + (1,) * (state.ndim - 1))
        return _sum_of_components(square * np.square(state)) / self.reynolds

    def energy_budget(self, state: FloatArray) -> EnergyBudget:
        """Power of the forces, the mean of u sin(n y) and the large-scale force's; dissipation."""
        work = -math.sqrt(0.5) * state[self._forced]
        if self.large_scale_growth:
            mode = state[self._large_scale]
            growth = self.large_scale_growth * (1.0 - self._saturation(mode))
            work = work + growth * np.square(mode).sum(axis=0)
        return EnergyBudget(work, self.observable(state))

    def laminar_state(self) -> FloatArray:
        """Steady flow u = (Re / n^2) sin(n y), ``(dimension,)``: unstable where the flow bursts."""
        state = np.zeros(self.dimension)
        state[self._forced] = -self.reynolds / (math.sqrt(2.0) * self.forcing_wavenumber**2)
        return state

    def sample_initial_states(self, series: int, generator: np.random.Generator) -> FloatArray:
        """Random smooth flows, ``(dimension, series)``: normal amplitudes that fall with |k|."""
        square = np.tile(self._modes.square, 2)
        size = 0.3 * np.exp(-square / 16.0) / np.sqrt(square)
        return np.asarray(size[:, np.newaxis] * generator.standard_normal((self.dimension, series)))

    @property
    def domain(self) -> tuple[float, float]:
        """Periods of the flow along x and y."""
        return 2.0 * math.pi, 2.0 * math.pi

    def vorticity(self, state: FloatArray, points: FloatArray) -> FloatArray:
        """Vorticity at points of the plane.

        ``state``: ``(dimension, ...)``. ``points``: Coordinates (x, y), ``(points, 2)``. Shape
        ``(points, ...)``, in the inverse units of time.
        """
        return np.tensordot(self._modes.of_vorticity(points), state, axes=1)

    def velocity(self, state: FloatArray, points: FloatArray) -> FloatArray:
        """Velocity at points of the plane.

        ``state``: ``(dimension, ...)``. ``points``: Coordinates (x, y), ``(points, 2)``. Returns
        components u, then v: ``(2, points, ...)``.
        """
        u, v = self._modes.of_velocity(points)
        return np.stack([np.tensordot(part, state, axes=1) for part in (u, v)])

    def shifted(self, state: FloatArray, distance: float) -> FloatArray:
        """Flow moved by a distance along x, ``(dimension, ...)``: a solution if the flow is one."""
        c = _paired(state)
        moved = c * _over(np.exp(-1j * distance * self._modes.vectors[:, 0]), c)
        return np.concatenate([moved.real, moved.imag])

    def shift_reflected(self, state: FloatArray) -> FloatArray:
        """Flow reflected in x and moved by pi / n along y: a solution if the flow is one."""
        modes, c = self._modes, _paired(state)
        # the amplitude of (-x, y) is the conjugate of the one of (x, -y); amplitudes of (0, y) stay
        mirrored = np.array(
            [modes.place[x, -y] if x else modes.place[x, y] for x, y in modes.vectors]
        )
        reflected = -c[mirrored]
        inside = _over(modes.vectors[:, 0] > 0, c)
        reflected = np.where(inside, np.conj(reflected), reflected)
        moved = reflected * _over(
            np.exp(-1j * np.pi / self.forcing_wavenumber * modes.vectors[:, 1]), c
        )
        return np.concatenate([moved.real, moved.imag])

    def rotated(self, state: FloatArray) -> FloatArray:
        """Flow rotated by pi about the origin: a solution if the flow is one."""
        half = len(state) // 2
        return np.concatenate([state[:half], -state[half:]])

    def symmetries(self) -> tuple[Symmetry, ...]:
        """Symmetries of the flow: shifts along x, shifts with reflection, and the rotation by pi.

        Shifts along x are represented by 2 K + 1 of them, which average second moments of states as
        all shifts do.
        """
        shifts = 2 * int(self.largest_wavenumber) + 1
        return (
            Symmetry(lambda state: self.shifted(state, 2.0 * math.pi / shifts), shifts),
            Symmetry(self.shift_reflected, 2 * int(self.forcing_wavenumber)),
            Symmetry(self.rotated, 2),
        )

    def invariants(self, state: FloatArray) -> FloatArray:
        r"""Quantities that a shift along x does not change, ``(invariants, ...)``.

        The moduli of the amplitudes up to |k|^2 = 34; both parts of the amplitude of the mean flow
        (0, n), and of its products with the amplitudes of the triads (1, 0) and (1, n), (1, 0) and
        (1, -n), which carry energy into a burst (Farazmand and Sapsis 2017). The rotation by pi
        changes the signs of imaginary parts; the shift with reflection exchanges (kx, ky) and (kx,
        -ky).
        """
        c, place, n = _paired(state), self._modes.place, int(self.forcing_wavenumber)
        mean_flow, large_scale = c[place[0, n]], c[place[1, 0]]
        phased = np.stack(
            [
                mean_flow,
                large_scale * mean_flow * np.conj(c[place[1, n]]),
                large_scale * np.conj(mean_flow) * np.conj(c[place[1, -n]]),
            ]
        )
        moduli = np.abs(c[self._modes.square <= _LOW])
        return np.concatenate([moduli, phased.real, phased.imag])

    @property
    def invariant_names(self) -> tuple[str, ...]:
        """Names of the `invariants`."""
        low = [
            f"modulus_{x}_{y}".replace("-", "m")
            for (x, y), square in zip(self._modes.vectors, self._modes.square, strict=True)
            if square <= _LOW
        ]
        phased = ("mean_flow", "triad", "triad_m")
        parts = [f"{name}_{part}" for part in ("real", "imaginary") for name in phased]
        return (*low, *parts)

    def precursor(self, state: FloatArray) -> FloatArray:
        """Minus the modulus of the amplitude of (1, 0), ``(...)``.

        It falls before a burst, when its energy goes into the mean flow (Farazmand and Sapsis
        2017).
        """
        modulus: FloatArray = np.abs(_paired(state)[self._modes.place[1, 0]])
        return -modulus

    def energy_of_last_shell(self, state: FloatArray) -> FloatArray:
        """Share of the energy in wave vectors with the largest wavenumber, ``(...)``.

        A flow is resolved where this is small.
        """
        last = np.tile(np.abs(self._modes.vectors).max(axis=1) == self.largest_wavenumber, 2)
        squares = np.square(state)
        share: FloatArray = squares[last].sum(axis=0) / squares.sum(axis=0)
        return share


class _Modes(NamedTuple):
    """Wave vectors up to a largest wavenumber, and where they lie on the grid of products."""

    vectors: IntArray
    square: FloatArray
    phase: ComplexArray
    """exp(i theta) / sqrt(2), theta being the direction of the wave vector."""
    grid: int
    place: dict[tuple[int, int], int]

    def of_vorticity(self, points: FloatArray) -> FloatArray:
        """Vorticity of each component at points, ``(points, dimension)``."""
        waves = np.sqrt(2.0 * self.square) * np.exp(1j * (points @ self.vectors.T))
        return np.concatenate([waves.real, -waves.imag], axis=1)

    def of_velocity(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Velocities u and v of each component at points, ``(points, dimension)`` each."""
        waves = np.sqrt(2.0 / self.square) * np.exp(1j * (points @ self.vectors.T))
        u, v = 1j * self.vectors[:, 1] * waves, -1j * self.vectors[:, 0] * waves
        return (
            np.concatenate([u.real, -u.imag], axis=1),
            np.concatenate([v.real, -v.imag], axis=1),
        )


@lru_cache(maxsize=8)
def _modes(largest: int) -> _Modes:
    numbers = range(-largest, largest + 1)
    vectors = np.array([(x, y) for x in numbers for y in numbers if (x, y) > (0, 0)])
    square = np.square(vectors).sum(axis=1).astype(np.float64)
    phase = (vectors[:, 0] + 1j * vectors[:, 1]) / np.sqrt(2.0 * square)
    grid = scipy.fft.next_fast_len(3 * largest + 1)
    place = {(int(x), int(y)): number for number, (x, y) in enumerate(vectors)}
    return _Modes(vectors, square, phase, grid, place)


def _advection(state: FloatArray, modes: _Modes) -> FloatArray:
    """Change of amplitudes ``(dimension, batch)`` by advection.

    The vorticity changes by (d_yy - d_xx)(u v) + d_xy(u^2 - v^2). Both products are parts of
    (u + i v)^2, so that one transform to the grid and one back suffice.
    """
    x, y = modes.vectors.T
    c = _paired(state)
    phase = modes.phase[:, np.newaxis]
    field = np.zeros((modes.grid, modes.grid, state.shape[1]), dtype=np.complex128)
    # u + i v has the coefficients exp(i theta) c at k, and -exp(i theta) c* at -k
    field[x, y], field[-x, -y] = phase * c, -phase * np.conj(c)
    values = scipy.fft.ifft2(field, axes=(0, 1), norm="forward", overwrite_x=True)
    square = scipy.fft.fft2(values * values, axes=(0, 1), norm="forward", overwrite_x=True)
    here, opposite = square[x, y], np.conj(square[-x, -y])
    of_differences, of_product = (here + opposite) / 2.0, (here - opposite) / 4j
    change = (_over(x**2 - y**2, here) * of_product - _over(x * y, here) * of_differences) * _over(
        np.sqrt(2.0 / modes.square), here
    )
    return np.concatenate([change.real, change.imag])


def _paired(state: FloatArray) -> ComplexArray:
    """Amplitudes as complex numbers a + i b, ``(dimension / 2, ...)``."""
    half = len(state) // 2
    return np.asarray(state[:half] + 1j * state[half:])


def _over(values: ArrayLike, array: ComplexArray) -> NDArray[Any]:
    """Values by wave vector, shaped to act on an array of such values for each trajectory."""
    return np.asarray(values).reshape((-1,) + (1,) * (array.ndim - 1))


def _sum_of_components(values: FloatArray) -> FloatArray:
    """Sum over the first axis, in the same order whatever the other axes are."""
    return np.asarray(np.ascontiguousarray(np.moveaxis(values, 0, -1)).sum(axis=-1))

"""The nine-mode model of a turbulent shear flow of Moehlis, Faisst and Eckhardt (MFE).

J. Moehlis, H. Faisst and B. Eckhardt, "A low-dimensional model for turbulent shear flows", New
Journal of Physics 6 (2004) 56. The flow between two free-slip walls at y = -1 and y = 1, periodic
in x and z, is driven by a sinusoidal body force. Its velocity is the sum of nine modes
(`burstcast.systems.mfe_modes`) times the amplitudes a_1, ..., a_9, whose equations are the Galerkin
projection of the Navier-Stokes equations on the modes. The chaotic flow is a transient that ends in
the laminar state; on the way the kinetic energy bursts.
"""

import math
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem, EnergyBudget

_WALL_WAVENUMBER = math.pi / 2  # beta: half a wave between the walls


class _Coefficients(NamedTuple):
    """Coefficients of the quadratic terms; ``c_i_jk`` belongs to a_j a_k in the equation of a_i.

    Those of the terms that the mean shear a_1 + a_9 takes part in are named after what it couples.
    """

    streak_roll: float  # a_1 + a_9 with a_2 and a_3
    shear_oblique: float  # a_1 + a_9 with a_6 and a_8
    advection: float  # a_1 + a_9 with a_4 and a_5, and with a_6 and a_7
    c_2_46: float
    c_2_57: float
    c_2_58: float
    c_3_47: float
    c_3_48: float
    c_3_56: float
    c_4_26: float
    c_4_37: float
    c_4_38: float
    c_5_27: float
    c_5_28: float
    c_5_36: float
    c_6_24: float
    c_6_35: float
    c_7_25: float
    c_7_34: float
    c_8_25: float
    c_8_34: float


def _quadratic_coefficients(alpha: float, gamma: float) -> _Coefficients:
    beta = _WALL_WAVENUMBER
    root6 = math.sqrt(6.0)
    root32 = math.sqrt(1.5)
    k_ag = math.sqrt(alpha**2 + gamma**2)
    k_bg = math.sqrt(beta**2 + gamma**2)
    k_abg = math.sqrt(alpha**2 + beta**2 + gamma**2)
    abg = alpha * beta * gamma
    return _Coefficients(
        streak_roll=root32 * beta * gamma / k_bg,
        shear_oblique=root32 * beta * gamma / k_abg,
        advection=alpha / root6,
        c_2_46=10.0 / (3.0 * root6) * gamma**2 / k_ag,
        c_2_57=-(gamma**2) / (root6 * k_ag),
        c_2_58=-abg / (root6 * k_ag * k_abg),
        c_3_47=2.0 / root6 * abg / (k_ag * k_bg),
        c_3_48=(beta**2 * (3.0 * alpha**2 + gamma**2) - 3.0 * gamma**2 * (alpha**2 + gamma**2))
        / (root6 * k_ag * k_bg * k_abg),
        c_3_56=2.0 / root6 * abg / (k_ag * k_bg),
        c_4_26=-10.0 / (3.0 * root6) * alpha**2 / k_ag,
        c_4_37=-root32 * abg / (k_ag * k_bg),
        c_4_38=-root32 * (alpha * beta) ** 2 / (k_ag * k_bg * k_abg),
        c_5_27=alpha**2 / (root6 * k_ag),
        c_5_28=-abg / (root6 * k_ag * k_abg),
        c_5_36=2.0 / root6 * abg / (k_ag * k_bg),
        c_6_24=10.0 / (3.0 * root6) * (alpha**2 - gamma**2) / k_ag,
        c_6_35=-2.0 * math.sqrt(2.0 / 3.0) * abg / (k_ag * k_bg),
        c_7_25=(gamma**2 - alpha**2) / (root6 * k_ag),
        c_7_34=abg / (root6 * k_ag * k_bg),
        c_8_25=2.0 / root6 * abg / (k_ag * k_abg),
        c_8_34=gamma**2
        * (3.0 * alpha**2 - beta**2 + 3.0 * gamma**2)
        / (root6 * k_ag * k_bg * k_abg),
    )


def _viscous_rates(alpha: float, gamma: float) -> FloatArray:
    """Decay rates of the nine amplitudes times the Reynolds number."""
    alpha2, beta2, gamma2 = alpha**2, _WALL_WAVENUMBER**2, gamma**2
    return np.array(
        [
            beta2,
            4.0 * beta2 / 3.0 + gamma2,
            beta2 + gamma2,
            alpha2 + 4.0 * beta2 / 3.0,
            alpha2 + beta2,
            alpha2 + 4.0 * beta2 / 3.0 + gamma2,
            alpha2 + beta2 + gamma2,
            alpha2 + beta2 + gamma2,
            9.0 * beta2,
        ]
    )


@dataclass(frozen=True)
class MoehlisFaisstEckhardt(DynamicalSystem):
    """The amplitude equations of the nine-mode shear flow (section 2 of the paper).

    Parameters
    ----------
    reynolds
        Reynolds number.
    length_x, length_z
        Size of the periodic box in x and z; the walls are at y = -1 and y = 1.

    Raises
    ------
    ValueError
        If a parameter is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.systems.mfe import MoehlisFaisstEckhardt
    >>> flow = MoehlisFaisstEckhardt(reynolds=400.0)
    >>> laminar = np.array([1.0, 0, 0, 0, 0, 0, 0, 0, 0])
    >>> float(np.abs(flow.right_hand_side(laminar)).max()), float(flow.observable(laminar))
    (0.0, 0.5)
    """

    reynolds: float
    length_x: float = 4.0 * math.pi
    length_z: float = 2.0 * math.pi

    _quadratic: _Coefficients = field(init=False, repr=False, compare=False)
    _growth: FloatArray = field(init=False, repr=False, compare=False)  # linear rates, negative

    dimension: ClassVar[int] = 9
    observable_name: ClassVar[str] = "kinetic energy"
    observable_symbol: ClassVar[str] = "k"

    def __post_init__(self) -> None:
        for name in ("reynolds", "length_x", "length_z"):
            value = float(getattr(self, name))
            if not 0.0 < value < math.inf:
                raise ValueError(f"{name} must be positive and finite, not {value}")
            object.__setattr__(self, name, value)
        alpha = 2.0 * math.pi / self.length_x
        gamma = 2.0 * math.pi / self.length_z
        object.__setattr__(self, "_quadratic", _quadratic_coefficients(alpha, gamma))
        object.__setattr__(self, "_growth", -_viscous_rates(alpha, gamma) / self.reynolds)

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of the amplitudes; both of shape ``(9, ...)``, real or complex."""
        c = self._quadratic
        growth = self._growth.reshape((9,) + (1,) * (state.ndim - 1))
        derivative = np.multiply(state, growth, order="C")
        derivative[0] -= growth[0]  # the body force keeps a_1 = 1 against viscosity

        # Rows are combined by elementwise operations rather than by a matrix product, whose order
        # of summation would depend on the size of the batch. What equations share is computed once.
        rows = (9, state[0].size)
        a1, a2, a3, a4, a5, a6, a7, a8, a9 = state.reshape(rows)
        d1, d2, d3, d4, d5, d6, d7, d8, d9 = derivative.reshape(rows)
        shear = a1 + a9
        advection = c.advection * shear
        roll = c.streak_roll * a3
        oblique = c.shear_oblique * a8
        stress = roll * a2 - oblique * a6
        product_25 = a2 * a5
        product_34 = a3 * a4

        d1 += stress
        d2 += (c.c_2_57 * a7 + c.c_2_58 * a8) * a5
        d2 += c.c_2_46 * a4 * a6
        d2 -= roll * shear
        d3 += (c.c_3_47 * a7 + c.c_3_48 * a8) * a4
        d3 += c.c_3_56 * a5 * a6
        d4 += (c.c_4_37 * a7 + c.c_4_38 * a8) * a3
        d4 += c.c_4_26 * a2 * a6
        d4 -= advection * a5
        d5 += (c.c_5_27 * a7 + c.c_5_28 * a8) * a2
        d5 += c.c_5_36 * a3 * a6
        d5 += advection * a4
        d6 += c.c_6_24 * a2 * a4
        d6 += c.c_6_35 * a3 * a5
        d6 += advection * a7
        d6 += oblique * shear
        d7 += c.c_7_25 * product_25
        d7 += c.c_7_34 * product_34
        d7 -= advection * a6
        d8 += c.c_8_25 * product_25
        d8 += c.c_8_34 * product_34
        d9 += stress
        return derivative

    def jacobian(self, state: FloatArray) -> FloatArray:
        """Jacobian of the right-hand side, ``(9, 9, ...)``; ``[i, j]`` is d(da_i/dt) / d a_j."""
        c = self._quadratic
        a1, a2, a3, a4, a5, a6, a7, a8, a9 = state
        shear = a1 + a9
        j = np.zeros((9, *state.shape), dtype=state.dtype)
        for i in range(9):
            j[i, i] = self._growth[i]

        j[0, 1] = j[8, 1] = c.streak_roll * a3
        j[0, 2] = j[8, 2] = c.streak_roll * a2
        j[0, 5] = j[8, 5] = -c.shear_oblique * a8
        j[0, 7] = j[8, 7] = -c.shear_oblique * a6

        j[1, 0] = j[1, 8] = -c.streak_roll * a3
        j[1, 2] = -c.streak_roll * shear
        j[1, 3] = c.c_2_46 * a6
        j[1, 4] = c.c_2_57 * a7 + c.c_2_58 * a8
        j[1, 5] = c.c_2_46 * a4
        j[1, 6] = c.c_2_57 * a5
        j[1, 7] = c.c_2_58 * a5

        j[2, 3] = c.c_3_47 * a7 + c.c_3_48 * a8
        j[2, 4] = c.c_3_56 * a6
        j[2, 5] = c.c_3_56 * a5
        j[2, 6] = c.c_3_47 * a4
        j[2, 7] = c.c_3_48 * a4

        j[3, 0] = j[3, 8] = -c.advection * a5
        j[3, 1] = c.c_4_26 * a6
        j[3, 2] = c.c_4_37 * a7 + c.c_4_38 * a8
        j[3, 4] = -c.advection * shear
        j[3, 5] = c.c_4_26 * a2
        j[3, 6] = c.c_4_37 * a3
        j[3, 7] = c.c_4_38 * a3

        j[4, 0] = j[4, 8] = c.advection * a4
        j[4, 1] = c.c_5_27 * a7 + c.c_5_28 * a8
        j[4, 2] = c.c_5_36 * a6
        j[4, 3] = c.advection * shear
        j[4, 5] = c.c_5_36 * a3
        j[4, 6] = c.c_5_27 * a2
        j[4, 7] = c.c_5_28 * a2

        j[5, 0] = j[5, 8] = c.advection * a7 + c.shear_oblique * a8
        j[5, 1] = c.c_6_24 * a4
        j[5, 2] = c.c_6_35 * a5
        j[5, 3] = c.c_6_24 * a2
        j[5, 4] = c.c_6_35 * a3
        j[5, 6] = c.advection * shear
        j[5, 7] = c.shear_oblique * shear

        j[6, 0] = j[6, 8] = -c.advection * a6
        j[6, 1] = c.c_7_25 * a5
        j[6, 2] = c.c_7_34 * a4
        j[6, 3] = c.c_7_34 * a3
        j[6, 4] = c.c_7_25 * a2
        j[6, 5] = -c.advection * shear

        j[7, 1] = c.c_8_25 * a5
        j[7, 2] = c.c_8_34 * a4
        j[7, 3] = c.c_8_34 * a3
        j[7, 4] = c.c_8_25 * a2
        return j

    def observable(self, state: FloatArray) -> FloatArray:
        """Mean kinetic energy k = (1/2) sum a_i^2 over the volume, of shape ``(...)``."""
        # Row by row: a sum over the first axis would depend on the memory layout in its last bits.
        energy: FloatArray = np.square(state[0])
        for row in state[1:]:
            energy = energy + row * row
        return 0.5 * energy

    def energy_budget(self, state: FloatArray) -> EnergyBudget:
        """Input of the body force and viscous dissipation, both of shape ``(...)``.

        The quadratic terms only exchange energy between the modes, so that dk/dt = I - D with I =
        (beta^2 / Re) a_1 and D = (1 / Re) sum_i d_i a_i^2, where d_i is the mean squared gradient
        of mode i.
        """
        rates = -self._growth
        dissipation = rates[0] * np.square(state[0])
        for rate, row in zip(rates[1:], state[1:], strict=True):
            dissipation = dissipation + rate * row * row
        return EnergyBudget(input=rates[0] * state[0], dissipation=dissipation)

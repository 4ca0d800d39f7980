"""The Kuramoto-Sivashinsky equation on a periodic interval: flames, films, phase turbulence.

Source: Y. Kuramoto, T. Tsuzuki, Prog. Theor. Phys. 55 (1976) 356; G. I. Sivashinsky, Acta
Astronautica 4 (1977) 1177. On a length of 22, its leading Lyapunov exponent is 0.048 (P.
Cvitanovic, R. L. Davidchack, E. Siminos, SIAM J. Appl. Dyn. Syst. 9 (2010) 1), or 0.043 (R. A.
Edson, J. E. Bunder, T. W. Mattner, A. J. Roberts, ANZIAM J. 61 (2019) 270).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from burstcast.base.arrays import FloatArray, sum_of_rows
from burstcast.systems.base import EnergyBudget, Symmetry
from burstcast.systems.exponential_scheme import SemilinearSystem


@dataclass(frozen=True)
class KuramotoSivashinsky(SemilinearSystem):
    """u_t = -u u_x - u_xx - u_xxxx with period ``length``; the observable is the energy.

    A state has the amplitudes of u = sum_k a_k cos(k q x) + b_k sin(k q x), q = 2 pi / length: all
    a_k, then all b_k. The mean of u is 0. The energy is the mean of u^2 / 2.

    Parameters
    ----------
    length
        Period in space. At 22, the default, the equation is weakly chaotic.
    wavenumbers
        Number of wavenumbers that are kept; the state has twice as many amplitudes.

    Raises
    ------
    ValueError
        If the length is not positive, or there are fewer than two wavenumbers.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.systems.kuramoto_sivashinsky import KuramotoSivashinsky
    >>> system = KuramotoSivashinsky(length=2 * np.pi, wavenumbers=2)
    >>> float(system.right_hand_side(np.array([1.0, 0.0, 0.0, 0.0]))[3])
    0.5
    >>> float(system.observable(np.array([1.0, 0.0, 0.0, 0.0])))
    0.25
    """

    length: float = 22.0
    wavenumbers: int = 16

    observable_name: ClassVar[str] = "energy"
    observable_symbol: ClassVar[str] = "e"
    case_defaults: ClassVar[Mapping[str, Any]] = {
        "event_threshold": {"quantile": 0.95},
        "ensemble": {
            "time_step": 0.25,
            "sampling_stride": 2,
            "transient": 200.0,
            "duration": 1000.0,
        },
        "density": {"range": [0.0, 3.0]},
        "fixed_point": {"variation": 0.01, "above": 0.0},
        "lyapunov": {"orthonormalisation_interval": 2.5},
    }

    def __post_init__(self) -> None:
        if not 0 < self.length < math.inf:
            raise ValueError(f"length must be positive and finite, not {self.length}")
        if self.wavenumbers < 2:
            raise ValueError(f"wavenumbers must be 2 at least, not {self.wavenumbers}")

    @property
    def dimension(self) -> int:  # type: ignore[override]
        """Number of amplitudes."""
        return 2 * self.wavenumbers

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the amplitudes: a1, a2, ..., b1, b2, ..."""
        numbers = range(1, self.wavenumbers + 1)
        return tuple(f"{name}{number}" for name in "ab" for number in numbers)

    def _k(self) -> FloatArray:
        """Wavenumbers in inverse units of length, ``(wavenumbers,)``."""
        return 2 * np.pi / self.length * np.arange(1.0, self.wavenumbers + 1)

    def linear_rates(self) -> FloatArray:
        """Growth by -u_xx and damping by -u_xxxx, k^2 - k^4 of each amplitude."""
        k = self._k()
        return np.tile(k**2 - k**4, 2)

    def nonlinear(self, state: FloatArray) -> FloatArray:
        """Amplitudes of -(u^2)_x / 2, without what lies beyond the last wavenumber."""
        number = self.wavenumbers
        a, b = state[:number], state[number:]
        cosine, sine = np.zeros_like(a), np.zeros_like(b)  # twice the amplitudes of u^2
        for m in range(1, number):  # by each pair of wavenumbers, in one order: the same bits
            am, bm = a[m - 1], b[m - 1]
            low, high = slice(0, number - m), slice(m, number)
            # the sum of two wavenumbers, m and n
            cosine[high] += am * a[low] - bm * b[low]
            sine[high] += am * b[low] + bm * a[low]
            # their difference, n - m, from both orders of the pair
            cosine[low] += 2 * (am * a[high] + bm * b[high])
            sine[low] += 2 * (am * b[high] - bm * a[high])
        k = self._k().reshape((-1,) + (1,) * (state.ndim - 1)) / 4
        return np.concatenate([-k * sine, k * cosine])

    def observable(self, state: FloatArray) -> FloatArray:
        """Mean of u^2 / 2 over the interval, of shape ``(...)``."""
        return sum_of_rows(state * state) / 4

    def sample_initial_states(self, series: int, generator: np.random.Generator) -> FloatArray:
        """Random long waves, ``(dimension, series)``."""
        decay = np.tile(np.exp(-np.arange(self.wavenumbers) / 3.0), 2)
        return decay[:, np.newaxis] * generator.standard_normal((self.dimension, series))

    def energy_budget(self, state: FloatArray) -> EnergyBudget:
        """Growth and damping: d/dt (1/2) sum a_i^2 = sum k^2 a_i^2 - sum k^4 a_i^2."""
        k = np.tile(self._k(), 2).reshape((-1,) + (1,) * (state.ndim - 1))
        growing, damped = k**2 * state * state, k**4 * state * state
        return EnergyBudget(input=sum_of_rows(growing), dissipation=sum_of_rows(damped))

    def symmetries(self) -> tuple[Symmetry, ...]:
        """Reflection, u(x) to -u(-x), and the shift by half of the interval."""
        signs = np.repeat([-1.0, 1.0], self.wavenumbers)
        halves = np.tile((-1.0) ** np.arange(1, self.wavenumbers + 1), 2)

        def by(factors: FloatArray) -> Symmetry:
            return Symmetry(lambda u: factors.reshape((-1,) + (1,) * (u.ndim - 1)) * u, 2)

        return by(signs), by(halves)

"""Lyapunov exponents: the spectrum by the QR method, the leading one by growth of perturbations.

Both average over trajectories and over time (section 2.1 of the paper). They share no code beyond
the time stepping: each checks the other. The states to start from are on the attractor. Where chaos
is transient, start from series that do not laminarise over the time integrated here, with the time
step that they were made with: both functions then follow the same trajectories, bit for bit.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, ClassVar

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import RATE, TIME
from burstcast.base.resampling import Estimate
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast.systems.differentiation import Method, derivative, derivative_method, jacobian
from burstcast.systems.integration import check_batch, integrate
from burstcast.systems.runge_kutta import step

logger = logging.getLogger(__name__)

# Ratio of the weakest to the strongest growth between two orthonormalisations below which the
# weakest direction drowns in the rounding errors of the strongest.
_SMALLEST_GROWTH_RATIO = 1e-10
_JACOBIAN_TOLERANCE = 1e-5


@dataclass(frozen=True)
class LyapunovSpectrum:
    """Lyapunov exponents of each trajectory, in inverse time units."""

    #: ``(batch, exponents)``, in the order of the QR method: from the largest to the smallest, up
    #: to the statistical error of a trajectory of finite length
    exponents: Annotated[
        FloatArray, Described("run exponent", RATE, "Lyapunov exponents of each run")
    ]
    duration: Annotated[float, Described("", TIME, "time that they are averaged over")]


def exponents_record(spectrum: Estimate, growth: Estimate) -> dict[str, Any]:
    """Contents of a file of Lyapunov exponents: all by QR, the leading one by growth as well."""
    ends = ("mean", "low", "high")
    return {
        "leading": {name: float(getattr(spectrum, name)[0]) for name in ends},
        "leading_by_growth": {name: float(getattr(growth, name)) for name in ends},
        "spectrum": spectrum.mean.tolist(),
        "spectrum_low": spectrum.low.tolist(),
        "spectrum_high": spectrum.high.tolist(),
    }


def alignment_of(steps: int, orthonormalisation_steps: int) -> int:
    """Steps until perturbations are aligned: a quarter of a series, in whole intervals."""
    return steps // 4 // orthonormalisation_steps * orthonormalisation_steps


def lyapunov_spectrum(
    system: DynamicalSystem,
    state: FloatArray,
    time_step: float,
    steps: int,
    orthonormalisation_steps: int,
    alignment_steps: int = 0,
    exponents: int | None = None,
) -> LyapunovSpectrum:
    """Lyapunov exponents by repeated QR factorisation of the tangent propagator.

    As many perturbations as there are exponents evolve under the linearised equations, and
    are orthonormalised at regular intervals before they all line up with the fastest one
    (Ginelli et al., Phys. Rev. Lett. 99 (2007) 130601, which the paper follows). The exponents are
    the mean growth rates, the logarithms of the diagonal of R over time. The linear equations are
    stepped by the same Runge-Kutta scheme, which yields the derivative of the discrete map itself.

    Parameters
    ----------
    system
        The equations; their parameters are numbers.
    state
        States on the attractor to start from, ``(dimension, batch)``. They must not leave the
        chaotic phase within ``alignment_steps + steps`` steps: see the module's description.
    time_step
        Step of the scheme, in time units.
    steps
        Number of steps that growth is averaged over; an incomplete interval at their end is
        left out.
    orthonormalisation_steps
        Number of steps between two factorisations.
    alignment_steps
        Number of steps before growth counts, so that the perturbations forget the unit vectors
        that they start from; rounded up to whole intervals. This takes a few times the inverse of
        the gap between neighbouring exponents: about 1000 time units in the shear flow.
    exponents
        Number of leading exponents; None: as many as the system has dimensions.

    Raises
    ------
    ValueError
        If the interval is so long that the weakest direction is lost to rounding.
    FloatingPointError
        If a trajectory leaves the range of floating-point numbers.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.systems.integration import integrate
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> from burstcast.systems.lyapunov import lyapunov_spectrum
    >>> start = np.array([[1.0], [1.0], [20.0]]) + np.random.default_rng(0).normal(size=(3, 8))
    >>> on_attractor = integrate(Lorenz63(), start, 0.01, 2000, stride=2000)[-1]
    >>> spectrum = lyapunov_spectrum(Lorenz63(), on_attractor, 0.01, 5000, 10)
    >>> bool(abs(spectrum.exponents[:, 0].mean() - 0.906) < 0.05)
    True
    """
    check_batch(system, state, time_step)
    if orthonormalisation_steps < 1:
        raise ValueError(
            f"at least one step must lie between two factorisations, not {orthonormalisation_steps}"
        )
    if alignment_steps < 0:
        raise ValueError(f"the alignment must not be negative, not {alignment_steps} steps")
    intervals = steps // orthonormalisation_steps
    if intervals < 1:
        raise ValueError(
            f"{steps} steps hold no complete interval of {orthonormalisation_steps} steps "
            "between two factorisations"
        )
    dimension, batch = state.shape
    number = dimension if exponents is None else exponents
    if not 1 <= number <= dimension:
        raise ValueError(f"a system of {dimension} dimensions does not have {number} exponents")
    flow = tangent_flow(system)

    def advance(state: FloatArray, tangent: FloatArray) -> tuple[FloatArray, FloatArray]:
        return _propagated(flow, state, tangent, time_step, orthonormalisation_steps)

    interval = orthonormalisation_steps * time_step
    basis = np.broadcast_to(np.eye(dimension, number), (batch, dimension, number))

    def check(growth: FloatArray) -> None:  # at once: the rest takes minutes
        kept = _kept(growth)
        if kept == number:
            return
        _, tangent = _propagated(flow, state, basis, time_step, 1)
        of_a_step = np.abs(np.diagonal(np.linalg.qr(tangent)[1], axis1=1, axis2=2))
        advice = f"compute {kept} exponents (lyapunov.exponents)"
        if _kept(of_a_step) == number:
            rate = -float(np.log(of_a_step / of_a_step.max(axis=1, keepdims=True)).min())
            shorter = -0.7 * np.log(_SMALLEST_GROWTH_RATIO) / rate * time_step
            advice = (
                f"shorten it (lyapunov.orthonormalisation_interval) to "
                f"{max(time_step, shorter):.2g}, or {advice}"
            )
        raise ValueError(
            f"an interval of {interval:g} time units between two factorisations is too long: the "
            f"weakest direction is lost to rounding, from exponent {kept + 1} on: {advice}"
        )

    log_growth = tangent_growth(
        advance,
        state,
        basis,
        intervals,
        alignment_intervals=-(-alignment_steps // orthonormalisation_steps),
        check=check,
    )
    duration = intervals * orthonormalisation_steps * time_step
    return LyapunovSpectrum(exponents=log_growth / duration, duration=duration)


def _kept(growth: FloatArray) -> int:
    """Number of leading directions that growth ``(batch, perturbations)`` does not lose."""
    lost = (growth < _SMALLEST_GROWTH_RATIO * growth.max(axis=1, keepdims=True)).any(axis=0)
    return int(lost.argmax()) if lost.any() else len(lost)


def checked_jacobian(system: DynamicalSystem, states: FloatArray) -> float:
    """Relative error of a system's Jacobian against differences; states ``(dimension, batch)``."""
    differences = jacobian(system.right_hand_side, states, "finite differences")
    difference = np.abs(system.jacobian(states) - differences).max(axis=2)
    i, j = np.unravel_index(int(np.argmax(difference)), difference.shape)
    error = float(difference[i, j]) / max(float(np.abs(differences).max()), 1e-300)
    if not error < _JACOBIAN_TOLERANCE:
        raise ValueError(
            f"jacobian: the entry [{i}, {j}] differs from differences of right_hand_side by "
            f"{error:.2g} of the largest entry"
        )
    return error


def tangent_growth(
    advance: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]],
    state: FloatArray,
    tangent: FloatArray,
    intervals: int,
    alignment_intervals: int = 0,
    check: Callable[[FloatArray], None] | None = None,
) -> FloatArray:
    """Logarithmic growth of perturbations that are orthonormalised after each interval.

    This is the QR method (`lyapunov_spectrum`) for whatever makes trajectories: the equations, or
    the closed loop of a network.

    ``advance``: Takes states and perturbations over one interval: the derivative of the map that
    takes the states. ``state``: ``(..., batch)``. ``tangent``: Perturbations in columns, ``(batch,
    size, perturbations)``; orthonormal unless there is an alignment. ``check``: Called with the
    growth over each interval, ``(batch, perturbations)``. Shape ``(batch,
    perturbations)``; NaN for directions so weak that an interval loses them to rounding.
    """
    batch, _, perturbations = tangent.shape
    log_growth = np.zeros((batch, perturbations))
    lost = np.zeros((batch, perturbations), dtype=bool)
    for interval in range(alignment_intervals + intervals):
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                state, tangent = advance(state, tangent)
            finite = bool(np.isfinite(state).all() and np.isfinite(tangent).all())
        except FloatingPointError:
            finite = False
        if not finite:
            raise FloatingPointError(
                "a trajectory or its perturbations left the range of floating-point numbers"
            )
        tangent, triangle = np.linalg.qr(tangent)
        growth = np.abs(np.diagonal(triangle, axis1=1, axis2=2))
        if check is not None:
            check(growth)
        lost |= growth < _SMALLEST_GROWTH_RATIO * growth.max(axis=1, keepdims=True)
        if interval >= alignment_intervals:
            log_growth += np.log(growth, out=np.zeros_like(growth), where=~lost)
    return np.where(lost, np.nan, log_growth)


def kaplan_yorke_dimension(exponents: FloatArray) -> float:
    """Kaplan-Yorke dimension from the leading Lyapunov exponents.

    With j the largest number of leading exponents whose sum S_j is not negative, it is
    j + S_j / abs(exponent j + 1) (Kaplan & Yorke, in Functional Differential Equations and
    Approximation of Fixed Points, Lecture Notes in Mathematics 730 (1979) 204).

    ``exponents``: The leading ones, ``(exponents,)``; NaN counts as missing. Returns zero where the
    first exponent is negative; NaN where the sum of all is not: the dimension exceeds their number.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.systems.lyapunov import kaplan_yorke_dimension
    >>> round(kaplan_yorke_dimension(np.array([0.906, 0.0, -14.57])), 3)
    2.062
    """
    ordered = np.sort(exponents[~np.isnan(exponents)])[::-1]
    sums = np.cumsum(ordered)
    last = int(np.sum(sums >= 0.0)) - 1  # sums rise, then fall: those before are not negative
    if last + 1 == len(ordered):
        return float("nan")
    if last < 0:
        return 0.0
    return last + 1 + float(sums[last] / -ordered[last + 1])


def tangent_flow(system: DynamicalSystem) -> DynamicalSystem:
    """The variational equations: a state x and one perturbation v, dv/dt = J(x) v.

    A step of the scheme yields the state of a step of the system alone, bit for bit, and the
    perturbation multiplied by the derivative of that step: of the Jacobian, or, where the system
    has none or an integrator of its own, by complex steps or differences. Several perturbations of
    one state are several trajectories, of twice the dimension: the components of x, then of v.
    """
    if has_own(system, "flow_map"):
        method = derivative_method(partial(step, system, time_step=1e-3), system.dimension)
        logger.info("%s has its own integrator: derivatives by %s", type(system).__name__, method)
        return _TangentMap(system, method)
    if has_own(system, "jacobian"):
        return _TangentFlow(system)
    method = derivative_method(system.right_hand_side, system.dimension)
    logger.info("%s has no Jacobian: derivatives by %s", type(system).__name__, method)
    return _TangentFlow(system, method)


@dataclass(frozen=True)
class _TangentFlow(DynamicalSystem):
    """State and perturbation ``(2 dimension, ...)``; derivatives by the Jacobian, or a method."""

    system: DynamicalSystem
    method: Method | None = None

    observable_name: ClassVar[str] = "observable of the state"
    observable_symbol: ClassVar[str] = "x"

    def __post_init__(self) -> None:
        # a class variable of a system; here twice the dimension of the system inside
        object.__setattr__(self, "dimension", 2 * self.system.dimension)

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of state and perturbation."""
        function = self.system.right_hand_side
        x, perturbation = np.split(state, 2)
        if self.method is not None:
            return np.concatenate([function(x), derivative(function, x, perturbation, self.method)])
        jacobian = self.system.jacobian(x)
        # term by term, so that the rounding does not depend on how a library multiplies matrices
        change = jacobian[:, 0] * perturbation[0]
        for column in range(1, len(x)):
            change = change + jacobian[:, column] * perturbation[column]
        return np.concatenate([function(x), change])

    def observable(self, state: FloatArray) -> FloatArray:
        """Observable of the state."""
        return self.system.observable(state[: self.system.dimension])


@dataclass(frozen=True)
class _TangentMap(_TangentFlow):
    """State and perturbation under an integrator, which is differentiated by the method."""

    def flow_map(self, state: FloatArray, time_step: float) -> FloatArray:
        """State and perturbation one integration step later."""
        assert self.method is not None
        x, perturbation = np.split(state, 2)
        advance = partial(step, self.system, time_step=time_step)
        return np.concatenate([advance(x), derivative(advance, x, perturbation, self.method)])


def with_perturbations(
    system: DynamicalSystem, state: FloatArray, tangent: FloatArray, time_step: float, steps: int
) -> tuple[FloatArray, FloatArray]:
    """States ``(dimension, batch)`` and perturbations ``(dimension, n, batch)`` after steps."""
    columns = np.ascontiguousarray(tangent.transpose(2, 0, 1))
    state, columns = _propagated(tangent_flow(system), state, columns, time_step, steps)
    return state, np.ascontiguousarray(columns.transpose(1, 2, 0))


def _propagated(
    flow: DynamicalSystem, state: FloatArray, tangent: FloatArray, time_step: float, steps: int
) -> tuple[FloatArray, FloatArray]:
    """States ``(dimension, batch)`` and perturbations in columns ``(batch, dimension, number)``."""
    batch, dimension, number = tangent.shape
    columns = np.empty((2, dimension, batch, number))
    columns[0] = state[:, :, np.newaxis]
    columns[1] = tangent.transpose(1, 0, 2)
    joined = columns.reshape(2 * dimension, batch * number)
    end = integrate(flow, joined, time_step, steps, steps)[-1]
    states, tangents = end.reshape(2, dimension, batch, number)
    # contiguous: numpy factorises stacks of strided matrices more slowly
    return np.ascontiguousarray(states[:, :, 0]), np.ascontiguousarray(tangents.transpose(1, 0, 2))


def perturbation_growth(
    system: DynamicalSystem,
    state: FloatArray,
    time_step: float,
    steps: int,
    initial_distance: float,
    saturation_distance: float,
    generator: np.random.Generator,
    alignment_steps: int = 0,
) -> FloatArray:
    """Leading Lyapunov exponents ``(batch,)`` from the divergence of neighbouring trajectories.

    Beside each trajectory runs a neighbour. When nonlinearity is about to saturate their distance,
    the neighbour is brought back to the initial distance along the direction that it has reached
    (Benettin et al., Meccanica 15 (1980) 9), and growth starts anew from another point of the
    attractor. A distance that falls far below the initial one is renewed likewise, before rounding
    errors show in it. The exponent is the ratio of all logarithmic growth to all the time: a mean
    of the rates of phases would count short phases, of fast growth, too much.

    ``initial_distance``, ``saturation_distance``: Distances between neighbours at the start of a
    growth phase and at its end, in units of the state (see `attractor_size`). ``alignment_steps``:
    Number of steps before growth counts, so that the perturbations find the leading direction (see
    `lyapunov_spectrum`).
    """
    check_batch(system, state, time_step)
    if not 0.0 < initial_distance < saturation_distance < np.inf:
        raise ValueError(
            "the distances must satisfy 0 < initial < saturation, "
            f"not {initial_distance} and {saturation_distance}"
        )
    if steps < 1:
        raise ValueError(f"growth must be averaged over at least one step, not {steps}")
    if alignment_steps < 0:
        raise ValueError(f"the alignment must not be negative, not {alignment_steps} steps")
    direction = generator.standard_normal(state.shape)
    direction *= initial_distance / _norm(direction)
    pair = np.stack([state, state + direction], axis=1)
    log_growth = np.zeros(state.shape[1])
    distance = _distance(pair)
    for index in range(alignment_steps + steps):
        if index == alignment_steps:
            log_growth = -np.log(distance / initial_distance)
        pair = integrate(system, pair.reshape(len(pair), -1), time_step, 1)[-1].reshape(pair.shape)
        distance = _distance(pair)
        restart = (distance > saturation_distance) | (distance < 0.01 * initial_distance)
        if restart.any():
            log_growth[restart] += np.log(distance[restart] / initial_distance)
            direction = (pair[:, 1, restart] - pair[:, 0, restart]) / distance[restart]
            pair[:, 1, restart] = pair[:, 0, restart] + initial_distance * direction
            distance[restart] = initial_distance
    log_growth += np.log(distance / initial_distance)
    return log_growth / (steps * time_step)


def attractor_size(states: FloatArray) -> float:
    """Root-mean-square distance of states ``(dimension, count)`` from their mean."""
    if states.ndim != 2:
        raise ValueError(f"states must have the shape (dimension, count), not {states.shape}")
    deviation = states - states.mean(axis=1, keepdims=True)
    return float(np.sqrt(np.mean(np.sum(np.square(deviation), axis=0))))


def _distance(pair: FloatArray) -> FloatArray:
    """Distance between the neighbours of each pair, ``(dimension, 2, batch)``."""
    distance = _norm(pair[:, 1] - pair[:, 0])
    if not ((distance > 0.0) & np.isfinite(distance)).all():
        raise FloatingPointError(
            "two neighbouring trajectories coincide or left the range of floating-point "
            "numbers: check the time step and the initial distance"
        )
    return distance


def _norm(vectors: FloatArray) -> FloatArray:
    """Euclidean norm over the first axis."""
    # row by row, so that the rounding does not depend on the size of the batch
    total: FloatArray = np.square(vectors[0])
    for row in vectors[1:]:
        total += row * row
    return np.sqrt(total)

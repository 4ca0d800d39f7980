"""Check that a system keeps to the interface: shapes, types, batches, derivatives, finite steps.

All checks are trials: only the class of the system is needed.
"""

import math
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.discovery import UnsoundError
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast.systems.compiled import hindrance
from burstcast.systems.differentiation import derivative_method
from burstcast.systems.flow_map import FlowMap
from burstcast.systems.integration import integrate
from burstcast.systems.lyapunov import checked_jacobian
from burstcast.systems.sampling import sampled_initial_states

_TRAJECTORIES = 16
_STEPS = 400
_ROUNDING = 1e-9
"""Relative difference by which a trajectory in a batch and alone may differ."""


def check_system(system: DynamicalSystem, generator: np.random.Generator) -> str:
    """Report on a system's integrator and derivatives, after some steps of 16 trajectories.

    Raises `UnsoundError` with all violations of the interface, or where states do not stay finite.
    """
    start = _initial_states(system, generator)
    if problems := list(interface_problems(system, start)):
        raise UnsoundError(problems)
    ensemble = type(system).case_defaults.get("ensemble", {})
    time_step = ensemble.get("time_step") or _rough_time_step(system, start)
    (reached,) = _finite(partial(integrate, system, start, time_step, _STEPS, _STEPS))[-1:]
    if lost := int((~np.isfinite(system.observable(reached))).sum()):
        raise UnsoundError(
            [f"observable is not finite for {lost} of {_TRAJECTORIES} states on trajectories"]
        )
    return (
        f"{type(system).__name__}: keeps to the interface\n"
        f"  integrator             {_integrator(system, time_step)}\n"
        f"  derivatives            {_derivatives(system, start)}\n"
        f"{_rounded_by_batch(system, start)}"
    )


# -- the interface ---------------------------------------------------------------------------------


def interface_problems(system: DynamicalSystem, states: FloatArray) -> Iterator[str]:
    """Violations of the interface by a system, tried with states ``(dimension, batch)``."""
    dimension = len(states)
    functions: list[tuple[str, Callable[[FloatArray], FloatArray], tuple[int, ...]]] = [
        ("observable", system.observable, ())
    ]
    if has_own(system, "flow_map"):
        functions += [("flow_map", lambda state: system.flow_map(state, 1e-3), (dimension,))]
    else:
        functions += [("right_hand_side", system.right_hand_side, (dimension,))]
        if has_own(system, "jacobian"):
            functions += [("jacobian", system.jacobian, (dimension, dimension))]
    sound = True
    for name, function, leading in functions:
        problem = _shape_problem(name, function, states, leading)
        problem = problem or _batch_problem(name, function, states)
        if problem:
            sound = False
            yield problem
    if sound and has_own(system, "jacobian") and not has_own(system, "flow_map"):
        try:
            checked_jacobian(system, states)
        except ValueError as error:
            yield str(error)


def _shape_problem(
    name: str,
    function: Callable[[FloatArray], FloatArray],
    states: FloatArray,
    leading: tuple[int, ...],
) -> str | None:
    for given in (states, states[:, :6].reshape(len(states), 2, 3), states[:, 0]):
        before = given.copy()
        try:
            with np.errstate(all="ignore"):
                result = np.asarray(function(given))
        except Exception as error:  # whatever the system raises
            return f"{name} fails for states {given.shape}: {type(error).__name__}: {error}"
        expected = (*leading, *given.shape[1:])
        if result.shape != expected:
            return (
                f"{name} returns the shape {result.shape} for states {given.shape}, not {expected}"
            )
        if result.dtype != np.float64:
            return f"{name} returns numbers of type {result.dtype}, not float64"
        if not np.array_equal(given, before, equal_nan=True):
            return f"{name} changes the states that it is given"
    return None


def _batch_problem(
    name: str, function: Callable[[FloatArray], FloatArray], states: FloatArray
) -> str | None:
    together = np.asarray(function(states))
    for number in range(min(4, states.shape[1])):
        alone = np.asarray(function(np.ascontiguousarray(states[:, [number]])))[..., 0]
        if _difference(together[..., number], alone) > _ROUNDING:
            return (
                f"{name}: a trajectory in a batch differs from the same trajectory alone; act on "
                "each trailing index independently (no means or products over the batch)"
            )
    return None


def _difference(values: FloatArray, others: FloatArray) -> float:
    """Largest difference of two arrays, relative to their largest number; NaN equals NaN."""
    if not np.array_equal(np.isnan(values), np.isnan(others)):
        return math.inf
    finite = np.isfinite(values) & np.isfinite(others)
    if not np.array_equal(values[~finite], others[~finite], equal_nan=True):
        return math.inf
    size = np.abs(values[finite]).max(initial=0.0)
    return float(np.abs(values - others)[finite].max(initial=0.0) / max(size, 1e-300))


def _rounded_by_batch(system: DynamicalSystem, states: FloatArray) -> str:
    """A line on functions that round a trajectory alone otherwise than in a batch, if any do."""
    functions = {"observable": system.observable}
    if has_own(system, "flow_map"):
        functions["flow_map"] = lambda state: system.flow_map(state, 1e-3)
    else:
        functions["right_hand_side"] = system.right_hand_side
    rounded = []
    for name, function in functions.items():
        alone = np.asarray(function(np.ascontiguousarray(states[:, :1])))[..., 0]
        if not np.array_equal(np.asarray(function(states))[..., 0], alone):
            rounded.append(name)
    if not rounded:
        return ""
    return (
        f"  batches                {', '.join(rounded)}: one trajectory alone is rounded\n"
        f"                         otherwise than in a batch, as by sums over axis 0; results\n"
        f"                         depend on the size of batches by rounding errors\n"
    )


# -- trials ---------------------------------------------------------------------------------------


def _initial_states(system: DynamicalSystem, generator: np.random.Generator) -> FloatArray:
    ensemble = type(system).case_defaults.get("ensemble", {})
    if ensemble.get("initial_state") is not None:
        states = np.repeat(
            np.array(ensemble["initial_state"], dtype=np.float64)[:, None], 16, axis=1
        )
        component = (ensemble.get("perturbed_component") or 1) - 1
        states[component] += (ensemble.get("perturbation") or 0.01) * generator.random(
            _TRAJECTORIES
        )
        return states
    if has_own(system, "sample_initial_states"):
        try:
            return sampled_initial_states(system, _TRAJECTORIES, generator)
        except Exception as error:
            raise UnsoundError([f"sample_initial_states: {error}"]) from error
    return generator.standard_normal((system.dimension, _TRAJECTORIES))


def _rough_time_step(system: DynamicalSystem, states: FloatArray) -> float:
    """A twentieth of the fastest time scale along the first steps, or of changes; 1 for a map."""
    if isinstance(system, FlowMap):
        return 1.0
    if has_own(system, "flow_map"):
        change = np.linalg.norm(system.right_hand_side(states), axis=0)
        return 0.05 * float(np.median(np.linalg.norm(states, axis=0) / np.maximum(change, 1e-300)))
    step = math.inf
    for _ in range(3):
        matrices = np.moveaxis(system.jacobian(states), -1, 0)
        rate = float(np.abs(np.linalg.eigvals(matrices)).max())
        step = min(step, 0.05 / rate if rate > 0 else 1.0)
        states = _finite(partial(integrate, system, states, step, 200, 200))[-1]
    return step


def _finite(run: Callable[[], FloatArray]) -> FloatArray:
    try:
        return run()
    except FloatingPointError as error:
        raise UnsoundError(
            [
                f"trajectories do not stay finite: {error}; say where they begin "
                "(sample_initial_states, or initial_state in case_defaults), or take a shorter "
                "time_step"
            ]
        ) from error


def _integrator(system: DynamicalSystem, time_step: float) -> str:
    reason = hindrance(system, time_step)
    if has_own(system, "flow_map"):
        return "its own integrator" + ("" if reason else ", compiled")
    if reason is None:
        return "Runge-Kutta scheme, compiled"
    return f"Runge-Kutta scheme, in numpy; not compiled: {reason}"


def _derivatives(system: DynamicalSystem, states: FloatArray) -> str:
    if has_own(system, "flow_map"):
        method = derivative_method(lambda x: system.flow_map(x, 1e-3), system.dimension)
        return f"no Jacobian is asked for: {method} of the integrator"
    if has_own(system, "jacobian"):
        return f"Jacobian given, within {checked_jacobian(system, states):.1g} of differences"
    return f"no Jacobian given: {derivative_method(system.right_hand_side, system.dimension)}"

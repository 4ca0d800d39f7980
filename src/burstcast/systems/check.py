"""Check of a system in seconds: interface, time scales, exponents and extreme values.

Everything is found by trying: nothing has to be known of the system but its class. What a person
would set for a case is proposed, in the system's own units.
"""

import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast.systems.compiled import compiled_steps, hindrance
from burstcast.systems.differentiation import derivative_method
from burstcast.systems.flow_map import FlowMap
from burstcast.systems.integration import integrate
from burstcast.systems.lyapunov import (
    Estimate,
    attractor_size,
    checked_jacobian,
    lyapunov_spectrum,
    mean_with_interval,
    perturbation_growth,
)
from burstcast.systems.sampling import sampled_initial_states

Verdict = Literal["chaotic", "regular", "undecided"]

_TRAJECTORIES = 16
_STEPS = 20_000  # of each trajectory; fewer where a step takes long
_SECONDS = 4.0  # for each of three integrations
_SAMPLES_PER_PERIOD = 40
_FEWEST_SAMPLES_PER_PERIOD = 10
_MOST_SAMPLES_PER_LYAPUNOV_TIME = 200
_STEP_ERROR = 1e-6  # of a sampling interval, in standard deviations
_QUANTILE = 0.95
_EXPONENTS = 10  # leading ones, of systems with more dimensions
_TRANSIENT_LT, _DURATION_LT = 20.0, 70.0


class UnsoundSystemError(ValueError):
    """A system that does not keep to the interface; ``problems`` has one message for each."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        super().__init__("; ".join(problems))


@dataclass(frozen=True)
class SystemCheck:
    """Findings about a system."""

    name: str  #: name of its class
    #: "compiled Runge-Kutta scheme", "Runge-Kutta scheme in numpy", "its own integrator"
    integrator: str
    derivatives: str  #: how the system is differentiated, in words
    #: time_step, sampling_stride: integration step, in time units, and steps in a step of a
    #: forecast: what the class says, or else proposed from the fastest time scale
    time_step: float
    sampling_stride: int
    fastest_period: float  #: period of the component that changes fastest, in time units
    #: by_qr, by_growth: leading Lyapunov exponent with its 95 % interval, by both methods, in
    #: inverse time units
    by_qr: Estimate
    by_growth: Estimate
    #: time that the exponents are averaged over, of each of 16 trajectories, in time units
    duration: float
    spectrum: FloatArray  #: the leading exponents, at most ten
    #: quantiles of the observable on the attractor, by their share: 0, 0.5, 0.9, 0.95, 0.99, 1
    observable_quantiles: Mapping[float, float]
    events_per_lyapunov_time: float  #: upward crossings of the quantile 0.95 of the observable
    case: Mapping[str, Any]  #: settings of a case, as an entry of ``cases`` has them

    @property
    def verdict(self) -> Verdict:
        """Whether the leading exponent is positive, by the intervals of both methods.

        Regular: both intervals lie below zero, as for a limit cycle that is approached.
        Undecided: anything else.
        """
        return _verdict(self.by_qr, self.by_growth)

    @property
    def steps_per_lyapunov_time(self) -> float:
        """Steps of a forecast in a Lyapunov time; infinite where nothing grows."""
        exponent = float(self.by_qr.mean)
        interval = self.time_step * self.sampling_stride
        return 1.0 / (exponent * interval) if exponent > 0 else math.inf

    def summary(self) -> str:
        """Findings in words and numbers."""
        interval, quantiles = self.time_step * self.sampling_stride, self.observable_quantiles
        return "\n".join(
            [
                f"{self.name}: keeps to the interface",
                f"  integrator             {self.integrator}",
                f"  derivatives            {self.derivatives}",
                f"  leading exponent       {_in_words(self.by_qr)} by QR, "
                f"{_in_words(self.by_growth)} by growth of perturbations",
                f"  exponents              {', '.join(f'{value:.3g}' for value in self.spectrum)}",
                f"  fastest period         {self.fastest_period:.3g} time units",
                f"  time step, sampling    {self.time_step:g}, every {self.sampling_stride} steps "
                f"({interval:g} time units)",
                *self._chaos_in_words(),
                f"  observable             {quantiles[0.0]:.3g} to {quantiles[1.0]:.3g}, median "
                f"{quantiles[0.5]:.3g}; quantiles 0.9, 0.95, 0.99: {quantiles[0.9]:.3g}, "
                f"{quantiles[0.95]:.3g}, {quantiles[0.99]:.3g}",
                f"  beyond quantile 0.95   begins {self.events_per_lyapunov_time:.2g} times in a "
                "Lyapunov time",
            ]
        )

    def _chaos_in_words(self) -> list[str]:
        if self.verdict == "chaotic":
            return [
                f"  Lyapunov time          {1 / float(self.by_qr.mean):.3g} time units, "
                f"{self.steps_per_lyapunov_time:.3g} steps of a forecast"
            ]
        if self.verdict == "regular":
            return ["  no chaos               the leading exponent is below zero: no Lyapunov time"]
        bound = max(float(self.by_qr.high), float(self.by_growth.high))
        return [
            f"  chaos undecided        after {self.duration:.3g} time units, the interval of the "
            "leading exponent",
            "                         holds zero: a Lyapunov time, if there is one, is longer than "
            f"{1 / bound:.3g}",
            "                         time units",
        ]


def _in_words(estimate: Estimate) -> str:
    return f"{float(estimate.mean):.4g} +- {float(estimate.high - estimate.mean):.2g}"


def check_system(
    system: DynamicalSystem, generator: np.random.Generator, longest: float = 60.0
) -> SystemCheck:
    """Examine a system.

    ``longest``: Seconds after which no longer runs are made where the sign of the leading exponent
    is still undecided.
    """
    start = _initial_states(system, generator)
    if problems := list(interface_problems(system, start)):
        raise UnsoundSystemError(problems)
    said = type(system).case_defaults.get("ensemble", {})
    rough = said.get("time_step") or _rough_time_step(system, start)
    states = _developed(system, start, rough)
    period = _fastest_period(states, rough, float(np.abs(start).max()))
    stride, time_step = said.get("sampling_stride"), said.get("time_step")
    interval = stride * time_step if stride and time_step else _round(period / _SAMPLES_PER_PERIOD)
    if isinstance(system, FlowMap) and not time_step:
        time_step = interval = 1.0
    if not time_step:
        stride = stride or _stride(system, states[-1], interval)
        time_step = interval / stride
    stride = stride or max(1, round(interval / time_step))

    steps = _affordable(system, states[-1], time_step)
    samples = integrate(system, states[-1], time_step, steps, stride)
    size = attractor_size(samples.transpose(1, 0, 2).reshape(system.dimension, -1))
    every = max(1, min(stride * 5, steps // 20))
    # the linearised equations are several trajectories for each
    tangent_steps = max(20 * every, steps // (1 if _is_compiled(system, time_step) else 4))
    began, longer = time.perf_counter(), 1
    while True:
        spectrum = lyapunov_spectrum(
            system,
            samples[-1],
            time_step,
            longer * tangent_steps,
            every,
            longer * tangent_steps // 4,
            min(system.dimension, _EXPONENTS),
        ).exponents
        growth = perturbation_growth(
            system,
            samples[-1],
            time_step,
            longer * steps,
            1e-8 * size,
            1e-2 * size,
            generator,
            longer * steps // 4,
        ).exponents
        by_qr, by_growth = mean_with_interval(spectrum[:, 0]), mean_with_interval(growth)
        passed = time.perf_counter() - began
        # a run that is four times as long takes three times what all have taken so far
        if _verdict(by_qr, by_growth) != "undecided" or 4.0 * passed > longest:
            break
        longer *= 4
    observable = system.observable(samples.transpose(1, 0, 2))
    shares = (0.0, 0.5, 0.9, _QUANTILE, 0.99, 1.0)
    quantiles = dict(zip(shares, map(float, np.quantile(observable, shares)), strict=True))
    threshold = quantiles[_QUANTILE]
    crossings = (observable[:-1] < threshold) & (observable[1:] >= threshold)
    exponent = float(by_qr.mean)
    if exponent > 0 and not said.get("sampling_stride"):
        stride = _coarser(stride, time_step, period, 1.0 / exponent)
    per_time = crossings.sum() / (_TRAJECTORIES * steps * time_step)
    return SystemCheck(
        name=type(system).__name__,
        integrator=_integrator(system, time_step),
        derivatives=_derivatives(system, samples[-1]),
        time_step=time_step,
        sampling_stride=stride,
        fastest_period=period,
        by_qr=by_qr,
        by_growth=by_growth,
        duration=longer * steps * time_step,
        spectrum=np.asarray(spectrum.mean(axis=0)),
        observable_quantiles=quantiles,
        events_per_lyapunov_time=per_time / exponent if exponent > 0 else 0.0,
        case=_case(system, time_step, stride, exponent, samples, quantiles),
    )


# -- the interface ---------------------------------------------------------------------------------


def interface_problems(system: DynamicalSystem, states: FloatArray) -> Iterator[str]:
    """Violations of the interface by a system, with one message for each.

    ``states``: States ``(dimension, batch)`` to try it with.
    """
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
        if problem is None:
            problem = _batch_problem(name, function, states)
        if problem is not None:
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
                found = np.asarray(function(given))
        except Exception as error:  # whatever the system raises
            return f"{name} fails for states {given.shape}: {type(error).__name__}: {error}"
        expected = (*leading, *given.shape[1:])
        if found.shape != expected:
            return (
                f"{name} returns the shape {found.shape} for states {given.shape}, not {expected}"
            )
        if found.dtype != np.float64:
            return f"{name} returns numbers of type {found.dtype}, not float64"
        if not np.array_equal(given, before, equal_nan=True):
            return f"{name} changes the states that it is given"
    return None


def _batch_problem(
    name: str, function: Callable[[FloatArray], FloatArray], states: FloatArray
) -> str | None:
    together = np.asarray(function(states))
    for number in range(min(4, states.shape[1])):
        alone = np.asarray(function(np.ascontiguousarray(states[:, [number]])))[..., 0]
        if not np.array_equal(together[..., number], alone, equal_nan=True):
            return (
                f"{name}: a trajectory in a batch differs from the same trajectory alone; act on "
                "each trailing index independently (no matrix products over the batch)"
            )
    return None


# -- time scales -----------------------------------------------------------------------------------


def _initial_states(system: DynamicalSystem, generator: np.random.Generator) -> FloatArray:
    said = type(system).case_defaults.get("ensemble", {})
    if said.get("initial_state") is not None:
        states = np.repeat(np.array(said["initial_state"], dtype=np.float64)[:, None], 16, axis=1)
        component = (said.get("perturbed_component") or 1) - 1
        states[component] += (said.get("perturbation") or 0.01) * generator.random(_TRAJECTORIES)
        return states
    if has_own(system, "sample_initial_states"):
        try:
            return sampled_initial_states(system, _TRAJECTORIES, generator)
        except Exception as error:
            raise UnsoundSystemError([f"sample_initial_states: {error}"]) from error
    return generator.standard_normal((system.dimension, _TRAJECTORIES))


def _rough_time_step(system: DynamicalSystem, states: FloatArray) -> float:
    """A twentieth of the fastest time scale at these states and along their first steps.

    Of the states' own change, where an integrator of the system's own makes stiffness harmless; one
    for a map.
    """
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


def _developed(system: DynamicalSystem, start: FloatArray, time_step: float) -> FloatArray:
    """States on the attractor, as it seems: ``(samples, dimension, batch)``, at every step."""
    steps = _affordable(system, start, time_step)
    late = _finite(lambda: integrate(system, start, time_step, steps, steps))[-1]
    return _finite(lambda: integrate(system, late, time_step, steps // 4))


def _finite(run: Callable[[], FloatArray]) -> FloatArray:
    try:
        return run()
    except FloatingPointError as error:
        raise UnsoundSystemError(
            [
                f"trajectories do not stay finite: {error}; say where they begin "
                "(sample_initial_states, or initial_state in case_defaults), or take a shorter "
                "time_step"
            ]
        ) from error


def _affordable(system: DynamicalSystem, states: FloatArray, time_step: float) -> int:
    """Steps of all trajectories that take some seconds."""
    began = time.perf_counter()
    _finite(lambda: integrate(system, states, time_step, 1))  # compiles, too
    began = time.perf_counter()
    _finite(lambda: integrate(system, states, time_step, 4))
    seconds = (time.perf_counter() - began) / 4
    return int(min(_STEPS, max(400, _SECONDS / max(seconds, 1e-9))))


def _fastest_period(states: FloatArray, time_step: float, size: float) -> float:
    """2 pi times the scatter of the fastest component over the scatter of its change."""
    scatter = states.std(axis=(0, 2))
    change = np.diff(states, axis=0).std(axis=(0, 2)) / time_step
    moving = scatter > 1e-8 * max(float(np.abs(states).max()), size)
    if not moving.any():
        raise UnsoundSystemError(["all trajectories come to rest: there is nothing to forecast"])
    return float((2 * math.pi * scatter[moving] / change[moving]).min())


def _stride(system: DynamicalSystem, states: FloatArray, interval: float) -> int:
    """Integration steps in a sampling interval, so many that half as long ones change nothing."""
    scatter = states.std(axis=1, keepdims=True)
    scatter = np.where(scatter > 0, scatter, scatter.max())
    stride = 1
    while stride < 1024:
        try:
            coarse, fine = (
                integrate(system, states, interval / count, count, count)[-1]
                for count in (stride, 2 * stride)
            )
        except FloatingPointError:
            pass
        else:
            if (np.abs(coarse - fine) < _STEP_ERROR * scatter).all():
                break
        stride *= 2
    return stride


def _coarser(stride: int, time_step: float, period: float, lyapunov_time: float) -> int:
    """Integration steps in a sampling interval, so that forecasts need no more steps than needed.

    Where a Lyapunov time has many samples, ten in the fastest period are enough.
    """
    wanted = lyapunov_time / _MOST_SAMPLES_PER_LYAPUNOV_TIME
    longest = period / _FEWEST_SAMPLES_PER_PERIOD
    if stride * time_step >= min(wanted, longest):
        return stride
    return max(stride, math.floor(_round(min(wanted, longest)) / time_step + 0.5))


def _round(value: float) -> float:
    """The nearest of 1, 2, 5, 10, ... that is not larger than it by much."""
    power = 10.0 ** math.floor(math.log10(value))
    digit = next(digit for digit in (5.0, 2.0, 1.0) if value >= 0.95 * digit * power)
    return float(f"{digit * power:.3g}")


# -- in words, and as a case -----------------------------------------------------------------------


def _verdict(*estimates: Estimate) -> Verdict:
    if all(estimate.low > 0 for estimate in estimates):
        return "chaotic"
    return "regular" if all(estimate.high < 0 for estimate in estimates) else "undecided"


def _is_compiled(system: DynamicalSystem, time_step: float) -> bool:
    try:
        return compiled_steps((system,), time_step, False) is not None
    except TypeError:  # no hash
        return False


def _integrator(system: DynamicalSystem, time_step: float) -> str:
    compiled = _is_compiled(system, time_step)
    if has_own(system, "flow_map"):
        return "its own integrator" + (", compiled" if compiled else "")
    if compiled:
        return "Runge-Kutta scheme, compiled"
    return f"Runge-Kutta scheme, in numpy; not compiled: {hindrance(system, time_step)}"


def _derivatives(system: DynamicalSystem, states: FloatArray) -> str:
    if has_own(system, "flow_map"):
        method = derivative_method(lambda x: system.flow_map(x, 1e-3), system.dimension)
        return f"no Jacobian is asked for: {method} of the integrator"
    if has_own(system, "jacobian"):
        return f"Jacobian given, within {checked_jacobian(system, states):.1g} of differences"
    return f"no Jacobian given: {derivative_method(system.right_hand_side, system.dimension)}"


def _case(
    system: DynamicalSystem,
    time_step: float,
    stride: int,
    exponent: float,
    samples: FloatArray,
    quantiles: Mapping[float, float],
) -> dict[str, Any]:
    """Settings of a case: what the class says, and a proposal for what it does not."""
    interval = time_step * stride
    lyapunov_time = 1.0 / exponent if exponent > 0 else 100.0 * interval
    margin = 0.05 * (quantiles[1.0] - quantiles[0.0])
    ensemble: dict[str, Any] = {
        "time_step": time_step,
        "sampling_stride": stride,
        "transient": _whole(_TRANSIENT_LT * lyapunov_time, time_step),
        "duration": _whole(_DURATION_LT * lyapunov_time, interval),
    }
    if not has_own(system, "sample_initial_states"):
        scatter = samples.std(axis=(0, 2))
        component = int(np.argmax(scatter))
        ensemble["initial_state"] = [float(f"{x:.4g}") for x in samples[-1, :, 0]]
        ensemble["perturbed_component"] = component + 1
        ensemble["perturbation"] = float(f"{0.1 * scatter[component]:.2g}")
    proposed: dict[str, Any] = {
        "event_threshold": {"quantile": _QUANTILE},
        "ensemble": ensemble,
        "density": {
            "range": [
                _outwards(quantiles[0.0] - margin, math.floor),
                _outwards(quantiles[1.0] + margin, math.ceil),
            ]
        },
        "lyapunov": {"orthonormalisation_interval": float(f"{5 * interval:.12g}")},
    }
    return _laid_over(proposed, type(system).case_defaults)


def _whole(duration: float, unit: float) -> float:
    """A duration as a whole number of units, with two leading digits or so."""
    count = max(1, round(duration / unit))
    power = 10 ** max(0, len(str(count)) - 2)
    return float(f"{max(1, -(-count // power) * power) * unit:.12g}")


def _outwards(value: float, rounded: Callable[[float], int]) -> float:
    """Two leading digits, away from what lies inside."""
    if value == 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - 1)
    return float(f"{rounded(value / unit) * unit:.3g}")


def _laid_over(base: Mapping[str, Any], overlay: Mapping[str, Any]) -> dict[str, Any]:
    result = dict(base)
    for key, value in overlay.items():
        below = result.get(key)
        both = isinstance(value, Mapping) and isinstance(below, Mapping) and "quantile" not in below
        result[key] = _laid_over(below, value) if both else value  # type: ignore[arg-type]
    return result

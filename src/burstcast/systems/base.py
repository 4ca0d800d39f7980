"""The interface of a dynamical system."""

import abc
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems import differentiation


class EnergyBudget(NamedTuple):
    """Energy budget of E = (1/2) sum_i a_i^2 per unit of time: dE/dt = input - dissipation."""

    input: FloatArray
    dissipation: FloatArray


class Symmetry(NamedTuple):
    """A linear map of states ``(dimension, ...)`` that takes solutions to solutions.

    Applied ``order`` times it leaves every state as it was.
    """

    transform: Callable[[FloatArray], FloatArray]
    order: int


class DynamicalSystem(abc.ABC):
    """An autonomous system of ordinary differential equations with a scalar observable.

    A subclass is a frozen dataclass whose fields are the parameters of the equations, so that
    ``dataclasses.replace(system, reynolds=2000.0)`` is the same system under other parameters.
    States are arrays with the components first: ``(dimension, ...)``. All methods act on each
    trailing index independently, bit for bit.

    Methods that are made of sums, differences, products, quotients, whole powers up to 16 and
    square roots of components are compiled by themselves, and many times faster than numpy
    (`burstcast.systems.compiled`); arrays that take results must be made like the state
    (``np.empty_like(state)``, ``dtype=state.dtype``). All others are integrated by numpy, which is
    slower; ``burstcast check-system`` names the line that hinders compilation.
    """

    dimension: ClassVar[int]
    """Number of components; a property where it follows from the parameters."""
    observable_name: ClassVar[str]
    """Name of the observable for axes and tables, such as "kinetic energy"."""
    observable_symbol: ClassVar[str]
    """Symbol of the observable in TeX, without dollars: "k"."""
    case_defaults: ClassVar[Mapping[str, Any]] = {}
    """What a case of this system starts from, by the names of the settings of a case: thresholds,
    bins, initial state, steps, noise, actuation, in the system's own units. All may be left out."""

    @abc.abstractmethod
    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Time derivative of the state; both of shape ``(dimension, ...)``."""

    @abc.abstractmethod
    def observable(self, state: FloatArray) -> FloatArray:
        """Observable whose extreme events are forecast, of shape ``(...)``."""

    def jacobian(self, state: FloatArray) -> FloatArray:
        """Jacobian of the right-hand side, ``(dimension, dimension, ...)``: d f_i / d x_j.

        Optional: without it, it is found by complex steps, or by central differences
        (`burstcast.systems.differentiation`), which is slower, since it is not compiled.
        """
        method = differentiation.derivative_method(self.right_hand_side, self.dimension)
        return differentiation.jacobian(self.right_hand_side, state, method)

    def flow_map(self, state: FloatArray, time_step: float) -> FloatArray:
        """State one integration step later, both of shape ``(dimension, ...)``.

        Optional: an integrator of the system's own in place of the Runge-Kutta scheme
        (`burstcast.systems.stiff`), or a map (`burstcast.systems.flow_map`).
        """
        raise NotImplementedError(f"{type(self).__name__} is integrated by the Runge-Kutta scheme")

    def forced(self, force: Sequence[float]) -> "DynamicalSystem":
        """The system with a constant force on its right-hand side, one number per component.

        Optional: needed only for an actuation by a force of a system with a `flow_map`.
        """
        raise NotImplementedError(f"{type(self).__name__} does not say how a force enters it")

    def sample_initial_states(self, series: int, generator: np.random.Generator) -> FloatArray:
        """Initial states of an ensemble, ``(dimension, series)``.

        Optional: without it, all series begin near the case's ``ensemble.initial_state``.
        """
        raise NotImplementedError(f"{type(self).__name__} does not draw initial states")

    def energy_budget(self, state: FloatArray) -> EnergyBudget | None:
        """Energy input and dissipation of states, for the costs of control; None if unknown."""
        return None

    def symmetries(self) -> tuple[Symmetry, ...]:
        """Symmetries, by which training data are enlarged (`burstcast.data.encoders.pod`)."""
        return ()

    def energy_of_last_shell(self, state: FloatArray) -> FloatArray:
        """Share of the energy in the smallest scales of a truncated flow, ``(...)``."""
        raise NotImplementedError(f"{type(self).__name__} is not truncated")

    def precursor(self, state: FloatArray) -> FloatArray:
        """Precursor of events by theory, ``(...)``, which is large before an event."""
        raise NotImplementedError(f"{type(self).__name__} has no precursor")


def has_own(system: DynamicalSystem | type[DynamicalSystem], method: str) -> bool:
    """Whether a system has an optional method: "jacobian", "flow_map", "sample_initial_states"."""
    owner = system if isinstance(system, type) else type(system)
    return getattr(owner, method) is not getattr(DynamicalSystem, method)

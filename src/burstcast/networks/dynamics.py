"""Dynamics of the reservoir, driven by data (open loop) or by its own predictions (closed loop).

One step is r <- tanh(W_in [u; b_in] + W r), a prediction [r; 1]^T W_out (section "Echo state
networks" of the paper). Leaking neurons take only a share of this step, the leak rate; a quadratic
readout squares every second entry of r (`burstcast.networks.readout`). All methods work on a batch
of trajectories at once; each trajectory is bit for bit the same whatever batch it is part of.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal, get_args

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.networks.backend import Backend
from burstcast.networks.backend_compiled import CompiledBackend
from burstcast.networks.backend_scipy import ScipyBackend
from burstcast.networks.readout import ReadoutKind, readout_features
from burstcast.networks.reservoir import Reservoir

COLUMNS_PER_PANEL = 1000
"""Most columns of a panel of states, steps times batch, by default."""


@dataclass(frozen=True)
class StatePanel:
    """Reservoir states of consecutive steps."""

    #: start, stop: the states are those after the inputs ``start`` to ``stop - 1``; the state after
    #: input i predicts the data at step i + 1
    start: int
    stop: int
    states: FloatArray  #: shape ``(neurons, stop - start, batch)``, C-contiguous

    @property
    def columns(self) -> FloatArray:
        """The states as a matrix ``(neurons, (stop - start) * batch)``, the batch fastest."""
        return self.states.reshape(self.states.shape[0], -1)


@dataclass(frozen=True)
class Dynamics:
    """A reservoir with its hyperparameters applied.

    Parameters
    ----------
    reservoir
        The random matrices.
    spectral_radius
        rho, multiplies the recurrent weights.
    input_scaling
        sigma_in, multiplies the input weights, including the weights of the bias.
    backend
        Implementation: "compiled" or "scipy". They agree to rounding error.
    leak_rate
        a in r <- (1 - a) r + a tanh(...), above 0 and 1 at most; 1: neurons do not leak.
    readout
        "linear", or "quadratic": every second entry of the state is squared before the readout.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.networks.dynamics import Dynamics
    >>> from burstcast.networks.reservoir import make_reservoir
    >>> reservoir = make_reservoir(100, 3, 20, 0.1, np.random.default_rng(0))
    >>> dynamics = Dynamics(reservoir, spectral_radius=0.4, input_scaling=1.0)
    >>> inputs = np.zeros((5, 3, 2))
    >>> dynamics.open_loop(inputs).shape
    (100, 2)
    """

    reservoir: Reservoir
    spectral_radius: float
    input_scaling: float
    backend: Literal["compiled", "scipy"] = "compiled"
    leak_rate: float = 1.0
    readout: ReadoutKind = "linear"

    def __post_init__(self) -> None:
        for name in ("spectral_radius", "input_scaling"):
            value = getattr(self, name)
            if not (value >= 0 and np.isfinite(value)):
                raise ValueError(f"{name} must be finite and not negative, not {value}")
        if self.backend not in ("compiled", "scipy"):
            raise ValueError(f"the backend is 'compiled' or 'scipy', not {self.backend!r}")
        if not 0 < self.leak_rate <= 1:
            raise ValueError(f"leak_rate must be above 0 and 1 at most, not {self.leak_rate}")
        if self.readout not in get_args(ReadoutKind):
            raise ValueError(f"the readout is 'linear' or 'quadratic', not {self.readout!r}")

    def features(self, states: FloatArray, *, overwrite: bool = False) -> FloatArray:
        """States ``(neurons, ...)`` as the output weights multiply them, ``(neurons, ...)``."""
        return readout_features(states, self.readout, overwrite=overwrite)

    def open_loop(self, inputs: FloatArray, states: FloatArray | None = None) -> FloatArray:
        """States ``(neurons, batch)`` after a sequence of inputs, from zero or given states.

        ``inputs``: Inputs divided by their range, ``(steps, dimension, batch)``.
        """
        inputs, states = self._check_inputs(inputs, states)
        return self._implementation.open_loop(inputs, states, None)

    def state_panels(
        self,
        inputs: FloatArray,
        states: FloatArray | None = None,
        *,
        breakpoints: Sequence[int] = (),
        columns_per_panel: int = COLUMNS_PER_PANEL,
    ) -> Iterator[StatePanel]:
        """Stream the states that a sequence of inputs drives (see `open_loop`), panel by panel.

        ``breakpoints``: Steps at which a panel must end, in any order. The last states of the panel
        that ends at step b are those after the inputs before b, whose prediction is the data at
        step b. ``columns_per_panel``: Most columns of a panel, steps times batch; one step at
        least. Yields panels in the order of time, each a fresh array.
        """
        inputs, states = self._check_inputs(inputs, states)
        steps, _, batch = inputs.shape
        outside = [step for step in breakpoints if not 0 <= step <= steps]
        if outside:
            raise ValueError(f"breakpoints outside the {steps} steps of the inputs: {outside}")
        # The checks above run when the generator is made, not when its first panel is asked for.
        return self._panels(
            inputs,
            states,
            sorted({0, *breakpoints, steps}),
            max(1, columns_per_panel // max(1, batch)),
        )

    def closed_loop(
        self,
        weights: FloatArray,
        input_range: FloatArray,
        states: FloatArray,
        steps: int,
    ) -> tuple[FloatArray, FloatArray]:
        """Autonomous forecast: every prediction is the next input.

        ``weights``: Readout weights W_out, the bias last, ``(neurons + 1, dimension)``.
        ``input_range``: Divisors of the inputs, ``(dimension,)``. ``states``: Initial states,
        ``(neurons, batch)``, not changed. Returns predictions, ``(steps, dimension, batch)``, of
        which the first is computed from the initial states, and the states after the last one was
        fed back, with which a call continues the forecast. A network may diverge: that is a result.
        """
        neurons, dimension = self.reservoir.neurons, self.reservoir.dimension
        weights = np.ascontiguousarray(weights, dtype=np.float64)
        input_range = np.ascontiguousarray(input_range, dtype=np.float64)
        if weights.shape != (neurons + 1, dimension):
            raise ValueError(
                f"readout weights must have shape {(neurons + 1, dimension)}, not {weights.shape}"
            )
        if input_range.shape != (dimension,):
            raise ValueError(
                f"the input range must have shape {(dimension,)}, not {input_range.shape}"
            )
        if not np.isfinite(weights).all():
            raise ValueError("the readout weights are not finite")
        if not (np.isfinite(input_range).all() and (input_range > 0).all()):
            raise ValueError("the input range must be finite and positive")
        if steps < 0:
            raise ValueError(f"a forecast cannot have {steps} steps")
        states = self._check_states(states)
        return self._implementation.closed_loop(weights, input_range, states, steps)

    @cached_property
    def _implementation(self) -> Backend:
        reservoir = self.reservoir
        implementation = ScipyBackend if self.backend == "scipy" else CompiledBackend
        return implementation(
            reservoir.recurrent * self.spectral_radius,
            reservoir.input_column,
            reservoir.input_weight * self.input_scaling,
            reservoir.input_bias,
            self.leak_rate,
            self.readout,
        )

    def _panels(
        self, inputs: FloatArray, states: FloatArray, edges: Sequence[int], steps_per_panel: int
    ) -> Iterator[StatePanel]:
        for first, end in pairwise(edges):
            for start in range(first, end, steps_per_panel):
                stop = min(start + steps_per_panel, end)
                record = np.empty((self.reservoir.neurons, stop - start, states.shape[1]))
                states = self._implementation.open_loop(inputs[start:stop], states, record)
                yield StatePanel(start, stop, record)

    def _check_inputs(
        self, inputs: FloatArray, states: FloatArray | None
    ) -> tuple[FloatArray, FloatArray]:
        inputs = np.ascontiguousarray(inputs, dtype=np.float64)
        if inputs.ndim != 3 or inputs.shape[1] != self.reservoir.dimension:
            raise ValueError(
                f"inputs must have shape (steps, {self.reservoir.dimension}, batch), "
                f"not {inputs.shape}"
            )
        if not np.isfinite(inputs).all():
            raise ValueError("the inputs of the network are not finite")
        if states is None:
            states = np.zeros((self.reservoir.neurons, inputs.shape[2]))
        states = self._check_states(states)
        if states.shape[1] != inputs.shape[2]:
            raise ValueError(
                f"{states.shape[1]} initial states do not fit {inputs.shape[2]} input series"
            )
        return inputs, states

    def _check_states(self, states: FloatArray) -> FloatArray:
        states = np.ascontiguousarray(states, dtype=np.float64)
        if states.ndim != 2 or states.shape[0] != self.reservoir.neurons:
            raise ValueError(
                f"states must have shape ({self.reservoir.neurons}, batch), not {states.shape}"
            )
        if not np.isfinite(states).all():
            raise ValueError("the initial states are not finite")
        return states

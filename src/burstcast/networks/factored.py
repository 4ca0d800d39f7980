"""A readout whose weights are linear in factors of parameters: W_out = W_0 + sum_f q_f W_f.

The reservoir does not receive the parameters: the readout is trained on [r; q_f r; q_f] with the
factors in force (`burstcast.forecasters._parameter_factors`). As an input, a parameter would have
to be interpolated between the few values of the training; a factor of the readout is interpolated
exactly, as far as one step of the flow is linear in it.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.reservoir import Reservoir
from burstcast.systems.parameters import stretches, values_in


@dataclass(frozen=True)
class FactoredStates:
    """Features of a readout that is linear in factors."""

    neurons: int  #: size of the reservoir
    #: neurons that the input reaches; other neurons settle at constants, whose products with a
    #: factor would be copies of the factor, and are left out
    driven: IntArray
    factors: int  #: number of factors; 0: the features are the states

    @classmethod
    def of(cls, reservoir: Reservoir, factors: int) -> "FactoredStates":
        """Features of the states of a reservoir."""
        return cls(reservoir.neurons, driven_neurons(reservoir), factors)

    @property
    def size(self) -> int:
        """Number of features."""
        return self.neurons + self.factors * (len(self.driven) + 1)

    def features(self, states: FloatArray, factors: FloatArray) -> FloatArray:
        """Features ``(size, columns)``: states, driven states times each factor, factors.

        ``states``: ``(neurons, columns)``. ``factors``: From each step to the next, ``(factors,
        columns)``.
        """
        products = [factor * states[self.driven] for factor in factors]
        return np.concatenate([states, *products, factors])

    def weights_at(self, weights: FloatArray, factors: FloatArray) -> FloatArray:
        """Readout of the states alone under factors: ``(neurons + 1, dimension)``."""
        if len(weights) != self.size + 1:
            raise ValueError(f"a readout of {self.size} features has no {len(weights)} weights")
        combined = np.concatenate([weights[: self.neurons], weights[-1:]])
        multiples, by_factor = np.split(
            weights[self.neurons : -1], [self.factors * len(self.driven)]
        )
        for number, factor in enumerate(factors):
            block = multiples[number * len(self.driven) : (number + 1) * len(self.driven)]
            combined[self.driven] += factor * block
            combined[-1] += factor * by_factor[number]
        return combined


def driven_neurons(reservoir: Reservoir) -> IntArray:
    """Neurons whose state depends on the input, directly or through others, ascending."""
    reached = (reservoir.input_column < reservoir.dimension) & (reservoir.input_weight != 0)
    connected = abs(reservoir.recurrent)
    while True:
        further = reached | (connected @ reached.astype(np.float64) > 0)
        if (further == reached).all():
            return np.flatnonzero(reached)
        reached = further


def factored_closed_loop(
    dynamics: Dynamics,
    weights: FloatArray,
    input_range: FloatArray,
    states: FloatArray,
    factors: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Autonomous forecast by a readout that is linear in factors (see `Dynamics.closed_loop`).

    ``weights``: Of the features, ``(size + 1, dimension)``. ``factors``: During each step,
    ``(steps, factors, batch)``. A forecast that has overflowed when its factors change is NaN from
    there on.
    """
    layout = FactoredStates.of(dynamics.reservoir, factors.shape[1])
    outputs = np.full((len(factors), len(input_range), states.shape[1]), np.nan)
    states = np.array(states, dtype=np.float64)
    for part, in_force in stretches(factors):
        different, which = values_in(in_force)
        for number, values in enumerate(different):
            here = np.flatnonzero((which == number) & np.isfinite(states).all(axis=0))
            if here.size:
                outputs[part, :, here], states[:, here] = dynamics.closed_loop(
                    layout.weights_at(weights, values),
                    input_range,
                    states[:, here],
                    part.stop - part.start,
                )
    return outputs, states

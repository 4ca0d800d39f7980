"""A readout whose weights are linear in factors of parameters: W_out = W_0 + sum_f q_f W_f.

The reservoir does not receive the parameters: the readout is trained on [r; q_f r; q_f] with the
factors in force (`burstcast.forecasters._parameter_factors`). As an input, a parameter would have
to be interpolated between the few values of the training; a factor of the readout is interpolated
exactly, as far as one step of the flow is linear in it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.reservoir import Reservoir
from burstcast.networks.training import TrainingSeries
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


@dataclass(frozen=True)
class FactoredSeries(TrainingSeries):
    """Training series of a readout that is linear in factors."""

    #: factors in force from each sample to the next, ``(series, time - 1, factors)``
    factors: FloatArray = field(kw_only=True)

    def __post_init__(self) -> None:
        expected = (self.series, self.length - 1)
        if self.factors.shape[:2] != expected:
            raise ValueError(
                f"{self.series} series of {self.length} samples need factors of the shape "
                f"({self.series}, {self.length - 1}, factors), not {self.factors.shape}"
            )

    def part(self, rows: slice | IntArray) -> Self:
        """Some of the series."""
        return replace(self, observed=self.observed[rows], factors=self.factors[rows])

    def feature_count(self, dynamics: Dynamics) -> int:
        """Number of features (`FactoredStates`)."""
        return FactoredStates.of(dynamics.reservoir, self.factors.shape[2]).size

    def features(self, dynamics: Dynamics, states: FloatArray, first: int, stop: int) -> FloatArray:
        """Features of states (see `TrainingSeries.features`)."""
        layout = FactoredStates.of(dynamics.reservoir, self.factors.shape[2])
        # a state at step j predicts step j: what counts is in force from step j - 1 on
        in_force = self.factors[:, first - 1 : stop - 1].transpose(2, 1, 0)
        columns = dynamics.features(states, overwrite=True)
        return layout.features(columns, in_force.reshape(layout.factors, columns.shape[1]))

    def closed_loop(
        self,
        network: EchoStateNetwork,
        states: FloatArray,
        rows: slice,
        starts: Sequence[int],
        steps: int,
    ) -> FloatArray:
        """Forecasts under the factors of the series (see `TrainingSeries.closed_loop`)."""
        # the step to the first sample is the first that is forecast
        in_force = [self.factors[rows, start - 1 : start - 1 + steps] for start in starts]
        factors = np.concatenate([part.transpose(1, 2, 0) for part in in_force], axis=2)
        return forecast_under(network, states, factors)[0]


def forecast_under(
    network: EchoStateNetwork, states: FloatArray, factors: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Autonomous forecast by a readout that is linear in factors (`EchoStateNetwork.forecast`).

    ``factors``: In force during each step, ``(steps, factors, batch)``. A forecast that has
    overflowed when its factors change is NaN from there on.
    """
    outputs = np.full((len(factors), len(network.input_range), states.shape[1]), np.nan)
    states = np.array(states, dtype=np.float64)
    for part, in_force in stretches(factors):
        different, which = values_in(in_force)
        for number, values in enumerate(different):
            here = np.flatnonzero((which == number) & np.isfinite(states).all(axis=0))
            if here.size:
                outputs[part, :, here], states[:, here] = network_under(network, values).forecast(
                    states[:, here], part.stop - part.start
                )
    return outputs, states


def network_under(network: EchoStateNetwork, factors: FloatArray) -> EchoStateNetwork:
    """Plain network that a network trained with factors is under constant ones, ``(factors,)``."""
    layout = FactoredStates.of(network.dynamics.reservoir, len(factors))
    weights = layout.weights_at(network.readout.weights, factors)
    return replace(network, readout=replace(network.readout, weights=weights))

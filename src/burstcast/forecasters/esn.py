"""The echo state network as a forecaster."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from burstcast.arrays import BoolArray, FloatArray
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.readout import Readout
from burstcast.esn.reservoir import ReservoirSeed
from burstcast.esn.tangent import ClosedLoopTangent
from burstcast.esn.training import TrainingSeries, train, train_leaving_one_out
from burstcast.forecasters._reservoirs import recorded_dynamics, restored_dynamics
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase


@dataclass(frozen=True)
class NetworkForecaster(Forecaster):
    """An echo state network: open loop over the washout, closed loop from there on."""

    has_search: ClassVar[bool] = True

    network: EchoStateNetwork  #: the trained network
    seed: ReservoirSeed  #: what its reservoir is made from
    #: a forecast beyond this many training ranges of any component has diverged; None: not judged
    divergence_bound: float | None

    def __repr__(self) -> str:
        return f"NetworkForecaster(seed {self.seed.seed}: {self.network!r})"

    @classmethod
    def fit(
        cls, training: FloatArray, case: ForecastingCase, parameters: FloatArray | None = None
    ) -> Self:
        """Refuse: a network needs hyperparameters, which a search finds."""
        raise NotImplementedError("networks are trained with hyperparameters that a search finds")

    @classmethod
    def trained(
        cls,
        dynamics: Dynamics,
        seed: ReservoirSeed,
        training: TrainingSeries,
        *,
        washout: int,
        tikhonov: float,
        divergence_bound: float | None,
        **knowledge: Any,
    ) -> Self:
        """Train a network on all series.

        ``washout``: Steps at the beginning of each series that training leaves out.
        """
        readout = train(dynamics, training, washout=washout, tikhonov=tikhonov)
        network = EchoStateNetwork(dynamics, readout, training.input_range)
        return cls(network, seed, divergence_bound, **knowledge)

    def leave_one_out(
        self,
        training: FloatArray,
        case: ForecastingCase,
        washout: int,
        parameters: FloatArray | None = None,
    ) -> Iterator[Self]:
        """Train the readout again without each series (see `Forecaster.leave_one_out`)."""
        network = self.network
        readouts = train_leaving_one_out(
            network.dynamics,
            self._training_series(training, parameters),
            washout=washout,
            tikhonov=network.readout.tikhonov,
        )
        for readout in readouts:
            yield replace(self, network=replace(network, readout=readout))

    def _training_series(
        self, training: FloatArray, parameters: FloatArray | None
    ) -> TrainingSeries:
        """Series that the network is trained on."""
        return TrainingSeries(training, self.network.input_range)

    def record(self) -> ForecasterRecord:
        """Readout, normalisation and seed of the reservoir, without large matrices."""
        dynamics, readout = self.network.dynamics, self.network.readout
        return ForecasterRecord(
            {"weights": readout.weights, "input_range": self.network.input_range},
            {
                **recorded_dynamics(self.seed, dynamics),
                "tikhonov": readout.tikhonov,
                "solver": readout.solver,
                "reciprocal_condition": readout.reciprocal_condition,
            },
        )

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Make the reservoir anew, and put the readout to it."""
        attributes, input_range = record.attributes, record.arrays["input_range"]
        seed, dynamics = restored_dynamics(attributes, len(input_range), case.options["backend"])
        readout = Readout(
            weights=np.ascontiguousarray(record.arrays["weights"]),
            tikhonov=float(attributes["tikhonov"]),
            solver=str(attributes["solver"]),
            reciprocal_condition=float(attributes["reciprocal_condition"]),
        )
        network = EchoStateNetwork(dynamics, readout, input_range)
        bound = case.options["divergence_bound"]
        return cls(network, seed, bound, **cls._knowledge(record, case))

    @classmethod
    def _knowledge(cls, record: ForecasterRecord, case: ForecastingCase) -> dict[str, Any]:
        """Fields of a kind that has more than a network."""
        return {}

    def start(self, washout: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        """Reservoir states after the washout, ``(neurons, batch)``."""
        return self.network.washout(washout)

    def advance(
        self, memory: FloatArray, steps: int, parameters: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Closed loop (see `Forecaster.advance`)."""
        return self.network.forecast(memory, steps)

    def advance_tangent(
        self, memory: FloatArray, tangent: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Closed loop and its derivative (see `Forecaster.advance_tangent`)."""
        return self._tangent.advance(memory, tangent, steps)

    @cached_property
    def _tangent(self) -> ClosedLoopTangent:
        return ClosedLoopTangent(self.network)

    def diverged(self, outputs: FloatArray) -> BoolArray:
        """Mark forecasts that are not finite or beyond the divergence bound."""
        assert self.divergence_bound is not None
        return self.network.diverged(outputs, self.divergence_bound)

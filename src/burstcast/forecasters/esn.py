"""The echo state network as a forecaster."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.left_out import LeftOut
from burstcast.forecasters._options import NetworkOptions
from burstcast.forecasters._reservoirs import (
    recorded_dynamics,
    recorded_scales,
    restored_dynamics,
)
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase, fitted
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.readout import Readout
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.tangent import ClosedLoopTangent
from burstcast.networks.training import TrainingSeries, train, train_leaving_one_out


@dataclass(frozen=True)
class NetworkForecaster(NetworkOptions, Forecaster):
    """An echo state network: open loop over the washout, closed loop from there on."""

    has_search: ClassVar[bool] = True

    network: EchoStateNetwork = fitted()  #: the trained network
    seed: ReservoirSeed = fitted()  #: what its reservoir is made from

    def __repr__(self) -> str:
        if self.network is None:
            return f"NetworkForecaster(readout={self.readout!r})"
        return f"NetworkForecaster(seed {self.seed.seed}: {self.network!r})"

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Refuse: a network needs hyperparameters, which a search finds."""
        raise NotImplementedError("networks are trained with hyperparameters that a search finds")

    def trained(
        self,
        dynamics: Dynamics,
        seed: ReservoirSeed,
        training: TrainingSeries,
        *,
        washout: int,
        tikhonov: float,
        steps_per_lyapunov_time: int,
    ) -> Self:
        """Train a network on all series.

        ``washout``: Steps at the beginning of each series that training leaves out.
        ``steps_per_lyapunov_time``: Unit of durations among the options of some kinds.
        """
        readout = train(dynamics, training, washout=washout, tikhonov=tikhonov)
        scales = training.input_range, training.input_offset
        network = EchoStateNetwork(dynamics, readout, *scales)
        return self.with_fitted(network=network, seed=seed, **training.knowledge)

    def leave_one_out(
        self,
        training: FloatArray,
        case: ForecastingCase,
        washout: int,
        left_out: Sequence[LeftOut] | None = None,
    ) -> Iterator[Self]:
        """Train the readout again without each series (see `Forecaster.leave_one_out`)."""
        network = self.network
        readouts = train_leaving_one_out(
            network.dynamics,
            self._training_series(training),
            washout=washout,
            tikhonov=network.readout.tikhonov,
            left_out=left_out,
        )
        for readout in readouts:
            yield replace(self, network=replace(network, readout=readout))

    def _training_series(self, training: FloatArray) -> TrainingSeries:
        """Series that the network is trained on."""
        network = self.network
        return TrainingSeries(training, network.input_range, input_offset=network.input_offset)

    def record(self) -> ForecasterRecord:
        """Readout, normalisation and seed of the reservoir, without large matrices."""
        dynamics, readout = self.network.dynamics, self.network.readout
        scales = recorded_scales(self.network.input_range, self.network.input_offset)
        return ForecasterRecord(
            {"weights": readout.weights, **scales},
            {
                **recorded_dynamics(self.seed, dynamics),
                "tikhonov": readout.tikhonov,
                "solver": readout.solver,
                "reciprocal_condition": readout.reciprocal_condition,
            },
        )

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Make the reservoir anew, and put the readout to it."""
        attributes, input_range = record.attributes, record.arrays["input_range"]
        seed, dynamics = restored_dynamics(attributes, len(input_range), self.backend)
        readout = Readout(
            weights=np.ascontiguousarray(record.arrays["weights"]),
            tikhonov=float(attributes["tikhonov"]),
            solver=str(attributes["solver"]),
            reciprocal_condition=float(attributes["reciprocal_condition"]),
        )
        offset = record.arrays.get("input_offset")
        network = EchoStateNetwork(dynamics, readout, input_range, offset)
        return self.with_fitted(network=network, seed=seed, **self._knowledge(record, case))

    def _knowledge(self, record: ForecasterRecord, case: ForecastingCase) -> dict[str, Any]:
        """Fields of a kind that has more than a network."""
        return {}

    def start(self, washout: FloatArray) -> FloatArray:
        """Reservoir states after the washout, ``(neurons, batch)``."""
        return self.network.washout(washout)

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
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

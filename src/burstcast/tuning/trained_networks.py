"""Networks with the hyperparameters that a search has found: for jobs and for `EventForecaster`."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.reservoir import Reservoir, ReservoirSeed
from burstcast.esn.training import TrainingSeries
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.tuning.scan import leak_rate_of


def trained_networks(
    network: NetworkForecaster,
    seed: ReservoirSeed,
    reservoir: Reservoir,
    training: TrainingSeries,
    found: Iterable[Mapping[str, Any]],
    *,
    washout: int,
    knowledge: Mapping[str, Any],
) -> Iterator[NetworkForecaster]:
    """Train a network of a reservoir at each of some points of its search.

    ``network``: The unfitted network, whose further fitted fields are ``knowledge``. ``found``:
    Records of evaluations (`burstcast.tuning.scan.Evaluation.record`). ``washout``: Steps at the
    beginning of each series that training leaves out.
    """
    for point in found:
        radius, scaling = point["spectral_radius"], point["input_scaling"]
        yield network.trained(
            Dynamics(
                reservoir, radius, scaling, network.backend, leak_rate_of(point), network.readout
            ),
            seed,
            training,
            washout=washout,
            tikhonov=point["tikhonov"],
            **knowledge,
        )

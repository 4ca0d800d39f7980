"""Networks with the hyperparameters that a search has found: for jobs and for `EventForecaster`."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Literal

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.readout import ReadoutKind
from burstcast.esn.reservoir import Reservoir, ReservoirSeed
from burstcast.esn.training import TrainingSeries
from burstcast.forecasters.base import Forecaster
from burstcast.tuning.scan import leak_rate_of


def trained_networks(
    kind: Any,
    seed: ReservoirSeed,
    reservoir: Reservoir,
    training: TrainingSeries,
    found: Iterable[Mapping[str, Any]],
    *,
    washout: int,
    backend: Literal["compiled", "scipy"],
    readout: ReadoutKind,
    divergence_bound: float | None,
    knowledge: Mapping[str, Any],
) -> Iterator[Forecaster]:
    """Train a network of a reservoir at each of some points of its search.

    ``kind``: A `burstcast.forecasters.esn.NetworkForecaster`, whose further fields are
    ``knowledge``. ``found``: Records of evaluations (`burstcast.tuning.scan.Evaluation.record`).
    ``washout``: Steps at the beginning of each series that training leaves out.
    ``divergence_bound``: In training ranges, where diverged forecasts are to be recognised.
    """
    for point in found:
        radius, scaling = point["spectral_radius"], point["input_scaling"]
        yield kind.trained(
            Dynamics(reservoir, radius, scaling, backend, leak_rate_of(point), readout),
            seed,
            training,
            washout=washout,
            tikhonov=point["tikhonov"],
            divergence_bound=divergence_bound,
            **knowledge,
        )

"""Networks trained on a job's series, with hyperparameters that a search has found."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from burstcast import durations
from burstcast.esn.dynamics import Dynamics
from burstcast.forecasters.base import Forecaster
from burstcast.tuning.scan import leak_rate_of
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.forecasters import kind_of
from burstcast_workflow.jobs.networks import knowledge, reservoir_seed, training_series
from burstcast_workflow.jobs.time_unit import lyapunov_time


def trained_networks(
    settings: Settings,
    ensemble: str,
    scheduled: Sequence[str],
    points: Iterable[Mapping[str, Any]],
    divergence_bound: float | None = None,
) -> Iterator[Forecaster]:
    """Train a job's network with the hyperparameters of each of some points of its search.

    The bound is given where forecasts that diverge are to be recognised.
    """
    networks: Any = kind_of(settings["forecaster"])
    seed = reservoir_seed(settings, settings["forecaster"])
    series = training_series(settings, ensemble, scheduled)
    reservoir = seed.reservoir(series.dimension)
    backend, readout = settings["forecasters.esn.backend"], settings["forecasters.esn.readout"]
    washout = durations.steps(settings["washout_lt"], lyapunov_time(settings))
    told = knowledge(settings, scheduled)
    for point in points:
        yield networks.trained(
            Dynamics(
                reservoir,
                point["spectral_radius"],
                point["input_scaling"],
                backend,
                leak_rate_of(point),
                readout,
            ),
            seed,
            series,
            washout=washout,
            tikhonov=point["tikhonov"],
            divergence_bound=divergence_bound,
            **told,
        )

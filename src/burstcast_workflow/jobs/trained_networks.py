"""Networks trained on a job's series, with hyperparameters that a search has found."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from burstcast import durations
from burstcast.forecasters.base import Forecaster
from burstcast.tuning import trained_networks as library
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
    """Train a job's network with the hyperparameters of each of some points of its search."""
    seed = reservoir_seed(settings, settings["forecaster"])
    series = training_series(settings, ensemble, scheduled)
    return library.trained_networks(
        kind_of(settings["forecaster"]),
        seed,
        seed.reservoir(series.dimension),
        series,
        points,
        washout=durations.steps(settings["washout_lt"], lyapunov_time(settings)),
        backend=settings["forecasters.esn.backend"],
        readout=settings["forecasters.esn.readout"],
        divergence_bound=divergence_bound,
        knowledge=knowledge(settings, scheduled),
    )

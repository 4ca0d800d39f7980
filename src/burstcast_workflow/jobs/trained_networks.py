"""Networks trained on a job's series, with hyperparameters that a search has found."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from burstcast.forecasters.base import Forecaster
from burstcast.tuning import trained_networks as library
from burstcast_workflow.jobs.networks import Networks


def trained_networks(
    settings: Networks,
    ensemble: str,
    scheduled: Sequence[str],
    points: Iterable[Mapping[str, Any]],
    divergence_bound: float | None = None,
) -> Iterator[Forecaster]:
    """Train a job's network with the hyperparameters of each of some points of its search."""
    seed = settings.reservoir_seed(settings.forecaster)
    series = settings.learnt(ensemble, scheduled)
    return library.trained_networks(
        settings.unfitted(settings.forecaster, divergence_bound),
        seed,
        seed.reservoir(series.dimension),
        series,
        points,
        washout=settings.washout,
        knowledge=settings.knowledge(scheduled),
    )

"""Estimate the leading Lyapunov exponent of measured series: how fast neighbours part."""

from burstcast import random_streams
from burstcast.statistics.neighbour_divergence import neighbour_divergence
from burstcast_workflow.harness.job import Settings, job, write_json
from burstcast_workflow.jobs.data import training_states
from burstcast_workflow.jobs.time_unit import sampling_interval


@job
def estimated_exponent(*, ensemble: str, exponents: str, settings: Settings) -> None:
    """Write the exponent of the training series, with its interval."""
    series, interval = training_states(settings, ensemble), sampling_interval(settings)
    try:
        found = neighbour_divergence(
            series,
            interval,
            random_streams.stream(
                settings["random_seed"], "neighbour divergence", settings["case"]
            ),
            resamples=settings["bootstrap.resamples"],
            confidence=settings["bootstrap.confidence"],
        )
    except ValueError as error:
        raise ValueError(
            f"{error}; give the unit of time (lyapunov.published_exponent, its inverse)"
        ) from error
    of_series = {"series": len(series), "duration": interval * (series.shape[1] - 1)}
    write_json(exponents, {**found.record(), **of_series}, settings.provenance)

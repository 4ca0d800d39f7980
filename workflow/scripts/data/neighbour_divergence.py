"""Estimate the leading Lyapunov exponent of measured series: how fast neighbours part."""

from burstcast.base import random_streams
from burstcast.base.series_lengths import array_or_list
from burstcast.statistics.neighbour_divergence import NoExponentError, neighbour_divergence
from burstcast_workflow.harness.job import JobSettings, at, job, tell, write_json
from burstcast_workflow.jobs.cases import Sampling
from burstcast_workflow.jobs.series import Training


class Divergence(JobSettings):
    """How fast neighbours part."""

    training: Training
    sampling: Sampling
    random_seed: int = at("random_seed")
    resamples: int = at("bootstrap.resamples")
    confidence: float = at("bootstrap.confidence")
    sets_time_unit: bool = at("case.estimates_time_unit")


@job
def estimated_exponent(*, ensemble: str, exponents: str, settings: Divergence) -> None:
    """Write the exponent of the training series with its interval, or that they show none."""
    series, interval = settings.training.states(ensemble), settings.sampling.interval
    stream = random_streams.stream(settings.random_seed, "neighbour divergence", settings.case)
    try:
        record = neighbour_divergence(
            array_or_list(series),
            interval,
            stream,
            resamples=settings.resamples,
            confidence=settings.confidence,
        ).record()
    except NoExponentError as error:
        if settings.sets_time_unit:
            advice = "give the unit of time (lyapunov.given_exponent, its inverse)"
            raise ValueError(f"{error}; {advice}") from error
        tell(f"no Lyapunov exponent is estimated: {error}")
        record = error.record()
    of_series = {"series": len(series), "duration": interval * (series.shape[1] - 1)}
    write_json(exponents, {**record, **of_series}, settings.provenance)

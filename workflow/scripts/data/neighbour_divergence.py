"""Estimate the leading Lyapunov exponent of measured series: how fast neighbours part."""

from burstcast import random_streams
from burstcast.statistics.neighbour_divergence import NoExponentError, neighbour_divergence
from burstcast_workflow.harness.job import Settings, job, tell, write_json
from burstcast_workflow.jobs.data import training_states
from burstcast_workflow.jobs.time_unit import sampling_interval


@job
def estimated_exponent(*, ensemble: str, exponents: str, settings: Settings) -> None:
    """Write the exponent of the training series with its interval, or that they show none."""
    series, interval = training_states(settings, ensemble), sampling_interval(settings)
    seed, is_time_unit = settings["random_seed"], settings["sets_time_unit"]
    stream = random_streams.stream(seed, "neighbour divergence", settings["case"])
    try:
        record = neighbour_divergence(
            series,
            interval,
            stream,
            resamples=settings["bootstrap.resamples"],
            confidence=settings["bootstrap.confidence"],
        ).record()
    except NoExponentError as error:
        if is_time_unit:
            advice = "give the unit of time (lyapunov.published_exponent, its inverse)"
            raise ValueError(f"{error}; {advice}") from error
        tell(f"no Lyapunov exponent is estimated: {error}")
        record = error.record()
    of_series = {"series": len(series), "duration": interval * (series.shape[1] - 1)}
    write_json(exponents, {**record, **of_series}, settings.provenance)

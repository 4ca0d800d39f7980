"""Calibrate the probabilities of all sources of alarms in a case, and choose their thresholds."""

from burstcast.forecasts.alarms import calibrated_alarms
from burstcast_workflow.harness.job import JobSettings, at, job, write_json
from burstcast_workflow.jobs.cases import Clock
from burstcast_workflow.jobs.forecasts import ScoredForecasts


class Calibration(JobSettings):
    """Thresholds of alarms."""

    scored: ScoredForecasts
    clock: Clock
    prior_forecasts: float = at("probability.prior_forecasts")


@job
def calibrate(
    *,
    calibration_set: str,
    calibration_forecasts: list[str],
    calibration: str,
    settings: Calibration,
) -> None:
    """Write calibrations and thresholds by alarm and prediction time."""
    alarms = calibrated_alarms(
        settings.scored.points(calibration_set, calibration_forecasts),
        settings.scored.prediction_times_lt,
        settings.scored.event_threshold,
        settings.prior_forecasts,
    )
    record = {"steps_per_lyapunov_time": settings.clock.lyapunov_time, "alarms": alarms}
    write_json(calibration, record, settings.provenance)

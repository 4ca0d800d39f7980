"""Find the event threshold of a case: a number, or a quantile of its training series."""

from typing import Any

from burstcast.base.files.netcdf import read_rows
from burstcast.base.series_lengths import numbers_of
from burstcast.data.event_threshold import threshold_at
from burstcast_workflow.harness.job import JobSettings, at, job, write_json
from burstcast_workflow.jobs.series import Training, kept_series


class Threshold(JobSettings):
    """A threshold of the observable: a number, or a mapping with its ``quantile``."""

    training: Training
    threshold: float | dict[str, Any] = at("case.event_threshold")


@job
def event_threshold_of_case(*, ensemble: str, event_threshold: str, settings: Threshold) -> None:
    """Write the threshold."""
    threshold = settings.threshold
    if isinstance(threshold, dict):
        settings.training.check_series(kept_series(ensemble))
        observable = read_rows(ensemble, "observable", 0, settings.training.series)
        threshold = threshold_at(threshold["quantile"], numbers_of(observable))
    write_json(event_threshold, {"event_threshold": threshold}, settings.provenance)

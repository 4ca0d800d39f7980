"""Turn a quantile into an event threshold, from the training series alone."""

from burstcast.base.files.netcdf import read_rows
from burstcast.base.series_lengths import numbers_of
from burstcast.data.event_threshold import threshold_at
from burstcast_workflow.harness.job import at, job, write_json
from burstcast_workflow.jobs.series import Training, kept_series


class AtQuantile(Training):
    """A threshold of the observable."""

    quantile: float = at("case.event_quantile")


@job
def event_threshold_of_case(*, ensemble: str, event_threshold: str, settings: AtQuantile) -> None:
    """Write the threshold."""
    settings.check_series(kept_series(ensemble))
    observable = read_rows(ensemble, "observable", 0, settings.training_series)
    threshold = threshold_at(settings.quantile, numbers_of(observable))
    record = {"case": settings.case, "event_threshold": threshold}
    write_json(event_threshold, record, settings.provenance)

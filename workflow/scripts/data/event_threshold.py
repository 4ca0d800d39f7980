"""Turn a quantile into an event threshold, from the training series alone."""

from burstcast.data.event_threshold import threshold_at
from burstcast.files.netcdf import read_rows
from burstcast_workflow.harness.job import Settings, job, write_json
from burstcast_workflow.jobs.data import check_kept_series, kept_series


@job
def event_threshold_of_case(*, ensemble: str, event_threshold: str, settings: Settings) -> None:
    """Write the threshold."""
    series = settings["case.training.series"]
    check_kept_series(kept_series(ensemble), {"training.series": series})
    observable = read_rows(ensemble, "observable", 0, series)
    threshold = threshold_at(settings["quantile"], observable)
    found = {"case": settings["case"], "event_threshold": threshold}
    write_json(event_threshold, found, settings.provenance)

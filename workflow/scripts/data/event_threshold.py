"""Turn a quantile into an event threshold, from the training series alone."""

from burstcast.data.event_threshold import threshold_at
from burstcast.files.netcdf import read_rows
from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_json
from burstcast_workflow.jobs.data import check_kept_series, kept_series


@job
def event_threshold_of_case(
    *, ensemble: str, event_threshold: str, settings: Settings, provenance: Provenance
) -> None:
    """Write the threshold."""
    series = settings["case.training.series"]
    check_kept_series(kept_series(ensemble), {"training.series": series})
    observable = read_rows(ensemble, "observable", 0, series)
    write_json(
        event_threshold,
        {
            "case": settings["case"],
            "event_threshold": threshold_at(settings["quantile"], observable),
            "provenance": provenance,
        },
    )

"""Export what other programs need to forecast a case: training series, washouts, a page."""

from pathlib import Path

from burstcast.benchmark.export import case_attributes, case_variables, page
from burstcast.files.atomic_files import atomic
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.forecast_task import task_data

SCORING = """\
Name the file in the config, in `campaign.forecasters.external`: the campaign checks and scores it
(docs/benchmark.md of burstcast)."""


@job
def export_task(
    *,
    ensemble: str,
    evaluation_set: str,
    events: str,
    summary: str,
    forecast_task: str,
    page_of_task: str,
    settings: Settings,
) -> None:
    """Write the observed data, without the truth, and the page that explains them."""
    data = task_data(settings, ensemble, evaluation_set, events, summary)
    write_netcdf(
        forecast_task, case_variables(data), {**settings.provenance, **case_attributes(data)}
    )
    with atomic(page_of_task) as partial:
        Path(partial).write_text(page([data], SCORING, Path(forecast_task).name), encoding="utf-8")

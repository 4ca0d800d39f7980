"""Export what other programs need to forecast a case: training series, washouts, a page."""

from pathlib import Path

from burstcast.benchmark.task_file import page, task_attributes, task_variables
from burstcast.files.atomic_files import atomic
from burstcast_workflow.harness.job import job, write_netcdf
from burstcast_workflow.jobs.forecast_task import Task


@job
def export_task(
    *,
    ensemble: str,
    evaluation_set: str,
    events: str,
    summary: str,
    forecast_task: str,
    page_of_task: str,
    settings: Task,
) -> None:
    """Write the observed data, without the truth, and the page that explains them."""
    data = settings.data(ensemble, evaluation_set, events, summary)
    attributes = {**settings.provenance, **task_attributes(data)}
    write_netcdf(forecast_task, task_variables(data), attributes)
    with atomic(page_of_task) as partial:
        Path(partial).write_text(page(data, Path(forecast_task).name), encoding="utf-8")

"""What seeds hide: the scatter of scores over choices of the training series, and over seeds."""

from pathlib import Path
from typing import Any

from burstcast.base.files.tables import read_table
from burstcast_workflow.harness.job import JobSettings, at, job
from burstcast_workflow.jobs.tables import Tables


class Scatter(JobSettings):
    """Tables of scores, and the kinds of forecasters in them."""

    written: Tables
    scattered: dict[str, dict[str, Any]] = at("scattered")
    kinds: list[str] = at("kinds")


@job
def separate_scatter(*, scores: list[str], tables: list[str], settings: Scatter) -> None:
    """Write both standard deviations of each metric, by forecaster, size and strategy."""
    # loaded here, with pandas: jobs from the cache start without it
    from burstcast.tables.realisations import scatter_of_families

    rows: list[dict[str, Any]] = []
    for path in scores:
        scattered = settings.scattered[Path(path).stem]
        by = [key for key in scattered["by"] if key not in ("case", "reynolds")]
        rows += scatter_of_families(read_table(path), settings.kinds, by, scattered["percentiles"])
    settings.written.write(tables, training_realisations=rows)

"""What seeds hide: the scatter of scores over choices of the training series, and over seeds."""

from pathlib import Path
from typing import Any

from burstcast.files.tables import read_table
from burstcast.tables.realisations import scatter_of_families
from burstcast_workflow.harness.job import Settings, job
from burstcast_workflow.jobs.tables import write_tables


@job
def separate_scatter(*, scores: list[str], tables: list[str], settings: Settings) -> None:
    """Write both standard deviations of each metric, by forecaster, size and strategy."""
    rows: list[dict[str, Any]] = []
    for path in scores:
        scattered, kinds = settings["scattered"][Path(path).stem], settings["kinds"]
        rows += scatter_of_families(
            read_table(path), kinds, scattered["by"][2:], scattered["percentiles"]
        )
    write_tables(tables, settings, training_realisations=rows)

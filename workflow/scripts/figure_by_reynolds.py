"""Draw prediction horizon and F-score against the Reynolds number."""

from typing import Any

from burstcast.figures.by_reynolds import by_reynolds
from burstcast.published import published_percentiles
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.table_files import read_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the networks of one size."""
    tables = [read_table(path) for path in (inputs.horizon, inputs.classification)]
    published = {}
    if settings["published_overlay"]:
        values = read_table(inputs.published)
        published = {
            f"published_{name}": published_percentiles(values, name)
            for name in ("horizon", "classification")
        }
    figure = by_reynolds(
        *(table[table["case"].isin(settings["cases"])] for table in tables),
        settings["fixed_neurons"],
        settings["reynolds_prediction_times_lt"],
        **published,
    )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

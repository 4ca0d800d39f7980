"""Average the prediction horizons of each forecaster over the events."""

import pandas as pd

from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_netcdf
from burstcast_workflow.harness.tables import keyed_table, write_table
from burstcast_workflow.jobs.gather import gathered


def horizon_table(*, horizons: list[str], table: str, settings: Settings) -> None:
    """Write one row for each forecaster; the averages are undefined where there is no event."""
    rows = []
    for record, path in gathered(settings["rows"], horizons):
        found = pd.Series(read_netcdf(path)["prediction_horizon_lt"])
        rows.append(
            {
                **record["keys"],
                "events": len(found),
                "mean_horizon_lt": found.mean(),
                "median_horizon_lt": found.median(),
            }
        )
    write_table(table, keyed_table(rows))


if __name__ == "__main__":
    run_job(snakemake, horizon_table)  # noqa: F821 - Snakemake puts it there

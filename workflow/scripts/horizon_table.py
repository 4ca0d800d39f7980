"""Average the prediction horizons of each network over the events."""

from typing import Any

import pandas as pd

from burstcast_workflow.gather import NETWORK, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf
from burstcast_workflow.table_files import keyed_table, write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write one row for each network; the averages are undefined where there is no event."""
    rows = []
    for keys, path in gathered(settings["networks"], inputs.horizons, NETWORK):
        horizons = pd.Series(read_netcdf(path)["prediction_horizon_lt"])
        rows.append(
            {
                **keys,
                "events": len(horizons),
                "mean_horizon_lt": horizons.mean(),
                "median_horizon_lt": horizons.median(),
            }
        )
    write_table(outputs.table, keyed_table(rows))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

"""Draw what the search for the hyperparameters of one network saw."""

from typing import Any

import pandas as pd

from burstcast.figures.search_landscape import search_landscape
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.table_files import read_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the best Tikhonov parameter of each point, for each strategy."""
    traces = []
    for path in inputs.searches:
        trace = read_table(path)
        traces.append(trace.loc[trace.groupby("evaluation")["objective"].idxmin()])
    write_figure(outputs, search_landscape(pd.concat(traces, ignore_index=True)))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

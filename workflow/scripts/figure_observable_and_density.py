"""Draw a typical evolution of the observable and its density over all data."""

from typing import Any

import numpy as np

from burstcast.figures.observable_and_density import observable_and_density
from burstcast.statistics.densities import bin_edges, histogram
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the first kept series and the histogram of all of them."""
    observable = read_netcdf(inputs.ensemble, "observable")["observable"]
    density = settings["density"]
    counts = histogram(observable, bin_edges(*density["range"], density["bins"]))
    figure = observable_and_density(
        np.arange(observable.shape[1]) / read_steps_per_lyapunov_time(settings, inputs.lyapunov),
        observable[0],
        counts.edges,
        counts.density,
        settings["event_threshold"],
        symbol=settings["symbol"],
        name=settings["observable_name"],
    )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

"""Draw the density of the observable with and without control, averaged over the networks."""

from itertools import pairwise
from typing import Any

import numpy as np

from burstcast.figures.control_density import ControlledDensity, control_density
from burstcast.figures.nothing_to_show import nothing_to_show
from burstcast.statistics.densities import Histogram, mean_density
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.gather import NETWORK, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf
from burstcast_workflow.table_files import keyed_table, write_table

RUN = (*NETWORK, "prediction_time_lt")
SAMPLES = ("uncontrolled", "controlled", "free")


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw one panel for each case; write all densities, without the time of actuation, too."""
    runs = [
        (run, read_netcdf(path)) for run, path in gathered(settings["runs"], inputs.histograms, RUN)
    ]
    panels, rows = [], []
    for case in dict.fromkeys(run["case"] for run, _ in runs):
        of_case = [(run, data) for run, data in runs if run["case"] == case]
        first, edges = of_case[0][0], of_case[0][1]["edge"]
        times = sorted({run["prediction_time_lt"] for run, _ in of_case})
        by_time = {
            time: [data for run, data in of_case if run["prediction_time_lt"] == time]
            for time in times
        }
        reynolds = first["reynolds"]
        panels.append(
            ControlledDensity(
                title=case if reynolds is None else f"Re = {reynolds:g}",
                bin_edges=edges,
                threshold=first["event_threshold"],
                # the flows that count differ a little between prediction times
                uncontrolled=_mean("uncontrolled", [data for _, data in of_case]),
                controlled={time: _mean("controlled", data) for time, data in by_time.items()},
            )
        )
        for time, data in by_time.items():
            densities = {name: _mean(name, data) for name in SAMPLES}
            rows += [
                {
                    "case": case,
                    "reynolds": reynolds,
                    "prediction_time_lt": time,
                    "low": low,
                    "high": high,
                    **{f"density_{name}": density[index] for name, density in densities.items()},
                }
                for index, (low, high) in enumerate(pairwise(edges))
            ]
    write_table(outputs.table, keyed_table(rows))
    # not a number where no flow counts
    if any(np.isfinite(panel.uncontrolled).all() for panel in panels):
        figure = control_density(
            panels, symbol=settings["symbol"], name=settings["observable_name"]
        )
    else:
        figure = nothing_to_show("No flow was free of events for long enough to be controlled.")
    write_figure(outputs, figure)


def _mean(name, histograms):
    """Mean over networks of the density in one of the samples."""
    return mean_density([Histogram(data["edge"], data[name]) for data in histograms])


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

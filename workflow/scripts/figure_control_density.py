"""Draw the density of the observable with and without control, averaged over the networks."""

from burstcast.figures.control_density import ControlledDensity, control_density
from burstcast.statistics.densities import Histogram, mean_density
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import run_job
from burstcast_workflow.storage import read_netcdf


def main(inputs, outputs, settings, provenance):
    """Draw one panel for each case."""
    runs = list(zip(settings["runs"], map(read_netcdf, inputs.histograms), strict=True))
    figure = control_density(
        [
            _panel([entry for entry in runs if entry[0]["case"] == case])
            for case in dict.fromkeys(run["case"] for run, _ in runs)
        ],
        symbol=settings["symbol"],
        name=settings["observable_name"],
    )
    write_figure(outputs, figure)


def _panel(runs):
    """Densities of one case."""
    first, histograms = runs[0]
    times = sorted({run["prediction_time_lt"] for run, _ in runs})

    def mean(name, entries):
        return mean_density([Histogram(data["edge"], data[name]) for data in entries])

    by_time = {
        time: [data for run, data in runs if run["prediction_time_lt"] == time] for time in times
    }
    reynolds = first["reynolds"]
    return ControlledDensity(
        title=first["case"] if reynolds is None else f"Re = {reynolds:g}",
        bin_edges=histograms["edge"],
        threshold=first["event_threshold"],
        # the flows that count differ a little between prediction times
        uncontrolled=mean("uncontrolled", [data for _, data in runs]),
        controlled={time: mean("controlled", data) for time, data in by_time.items()},
        free={time: mean("free", data) for time, data in by_time.items()},
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

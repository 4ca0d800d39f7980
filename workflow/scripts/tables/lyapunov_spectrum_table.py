"""Average the Lyapunov exponents of the data and of the forecasters' own flows."""

from burstcast import random_streams
from burstcast.files.netcdf import read_netcdf
from burstcast.statistics.lyapunov_spectrum import summarise
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.gather import case_keys, gathered
from burstcast_workflow.jobs.tables import with_ends, write_tables


@job
def lyapunov_spectrum_table(
    *, spectrum: str | list[str], forecasters: list[str], tables: list[str], settings: Settings
) -> None:
    """Write a row for each exponent, and one with the dimension for each forecaster."""
    rows, of_dimensions = [], []
    data = {"forecaster": "data", "neurons": None, "validation": None, "seed": None}
    # measured series have none
    files = [({**case_keys(settings), **data}, spectrum)] if isinstance(spectrum, str) else []
    files += [(keys, origin.path) for keys, origin in gathered(settings, forecasters)]
    for keys, path in files:
        exponents, case = read_netcdf(path, "exponents")["exponents"], keys["case"]
        found = summarise(
            exponents,
            settings["bootstrap.confidence"],
            settings["bootstrap.resamples"],
            random_streams.stream(settings["random_seed"], "bootstrap", "lyapunov spectrum", case),
        )
        rows += [
            {**keys, "number": number, **with_ends("lyapunov_exponent", *ends)}
            for number, ends in enumerate(zip(found.mean, found.low, found.high, strict=True), 1)
        ]
        dimension = found.dimension, found.dimension_low, found.dimension_high
        of_dimensions.append(
            {**keys, "runs": len(exponents), **with_ends("kaplan_yorke_dimension", *dimension)}
        )
    write_tables(tables, settings, lyapunov_spectrum=rows, kaplan_yorke=of_dimensions)

"""Data of a case for its jobs: training series and observations.

It imports neither systems nor networks: what is observed does not depend on their code.
"""

from collections.abc import Mapping

from burstcast.arrays import FloatArray
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.ensemble_files import SCHEDULE
from burstcast.files.netcdf import read_netcdf, read_rows, variable_names
from burstcast.statistics.densities import bin_edges, edges_over
from burstcast_workflow.harness.settings import Settings

OBSERVED = "observed"
"""Variable of an ensemble whose states were observed, with noise, before they were encoded."""


def kept_series(ensemble: str) -> int:
    """Number of series of an ensemble that did not laminarise."""
    return int(read_netcdf(ensemble, "series")["series"].size)


def check_kept_series(kept: int, needs: Mapping[str, int]) -> None:
    """Check that the kept series are as many as settings ask for, none of them twice."""
    if sum(needs.values()) > kept:
        listed = " and ".join(f"{name} is {count}" for name, count in needs.items())
        raise ValueError(
            f"{listed}, but only {kept} series did not laminarise and were kept: "
            f"raise ensemble.series, or ask for at most {kept}"
            f"{' in all' if len(needs) > 1 else ''}"
        )


def known_rows(ensemble: str, first: int, last: int) -> FloatArray | None:
    """Schedules of kept series, of columns that are known in advance; None where there are none."""
    there = SCHEDULE in variable_names(ensemble)
    return read_rows(ensemble, SCHEDULE, first, last) if there else None


def test_series(settings: Settings, kept: int) -> int:
    """Number of test series: ``case.test_series``, or all kept series after the training series."""
    wanted = settings["case.test_series"]
    # none is left: one is asked for, so that the check says how many there are
    return int(wanted or max(1, kept - settings["case.training.series"]))


def density_edges(settings: Settings, ensemble: str) -> FloatArray:
    """Edges of the bins of the observable's density: over all the data where no range is said."""
    density = settings["case.density"]
    if density["range"] is not None:
        low, high = density["range"]
        return bin_edges(low, high, density["bins"])
    return edges_over(read_netcdf(ensemble, "observable")["observable"], density["bins"])


def observed_rows(
    settings: Settings, ensemble: str, first: int, states: FloatArray, kind: str = ""
) -> FloatArray:
    """Observations of kept series: states with noise, or the channels of encoded series.

    ``first`` is the row of the first series in the ensemble, ``states`` are ``(series, time,
    dimension)``. Series with a ``kind`` are others than the ensemble's: their noise is their own.
    """
    if not kind and OBSERVED in variable_names(ensemble):
        return read_rows(ensemble, OBSERVED, first, first + len(states))
    training = read_rows(ensemble, "state", 0, settings["case.training.series"])
    return observed_series(
        states,
        first,
        settings["case.training.noise"],
        component_scales(training),
        settings["random_seed"],
        f"{settings['case']} {kind}".rstrip(),
    )


def training_states(settings: Settings, ensemble: str) -> FloatArray:
    """True states of the training series, ``(series, time, dimension)``."""
    series = settings["case.training.series"]
    check_kept_series(kept_series(ensemble), {"training.series": series})
    return read_rows(ensemble, "state", 0, series)

"""Data of a case for its jobs: training series and observations.

It imports neither systems nor networks: what is observed does not depend on their code.
"""

from collections.abc import Mapping
from typing import Any

from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_netcdf, read_rows, variable_names
from burstcast.base.series_lengths import numbers_of
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.ensemble_files import SCHEDULE
from burstcast.statistics.densities import bin_edges, edges_over
from burstcast_workflow.harness.settings import JobSettings, at

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


class Training(JobSettings):
    """The first of the kept series, which forecasters are trained on."""

    training_series: int = at("case.training.series")

    def check_series(self, kept: int, **needs: int) -> None:
        """Check that as many series were kept as the training, and other uses, need."""
        check_kept_series(kept, {str(Training.training_series): self.training_series, **needs})

    def training_states(self, ensemble: str) -> FloatArray:
        """True states of the training series, ``(series, time, dimension)``."""
        self.check_series(kept_series(ensemble))
        return read_rows(ensemble, "state", 0, self.training_series)


class Tested(Training):
    """The series after them, which forecasters are tested on."""

    wanted_test_series: int | None = at("case.test_series")

    def test_series(self, kept: int) -> int:
        """Number of test series: as many as wanted, or all kept series after the training series.

        Where none is left, one is asked for, so that the check says how many there are.
        """
        return int(self.wanted_test_series or max(1, kept - self.training_series))

    def test_rows(self, ensemble: str) -> range:
        """Rows of the test series in the ensemble."""
        kept, first = kept_series(ensemble), self.training_series
        series = self.test_series(kept)
        self.check_series(kept, test_series=series)
        return range(first, first + series)


class Observed(Training):
    """Observations of the series."""

    random_seed: int = at("random_seed")
    noise: float = at("case.training.noise")

    def observed_rows(
        self, ensemble: str, first: int, states: FloatArray, kind: str = ""
    ) -> FloatArray:
        """Observations of kept series: states with noise, or the channels of encoded series.

        ``first`` is the row of the first series in the ensemble, ``states`` are ``(series, time,
        dimension)``. Series with a ``kind`` are others than the ensemble's: their noise is their
        own.
        """
        if not kind and OBSERVED in variable_names(ensemble):
            return read_rows(ensemble, OBSERVED, first, first + len(states))
        training = read_rows(ensemble, "state", 0, self.training_series)
        return observed_series(
            states,
            first,
            self.noise,
            component_scales(training),
            self.random_seed,
            f"{self.case} {kind}".rstrip(),
        )


class Density(JobSettings):
    """Density of the observable."""

    density: dict[str, Any] = at("case.density")

    def edges(self, ensemble: str) -> FloatArray:
        """Edges of its bins: over all the data where no range is said."""
        bins = self.density["bins"]
        if self.density["range"] is not None:
            low, high = self.density["range"]
            return bin_edges(low, high, bins)
        return edges_over(numbers_of(read_netcdf(ensemble, "observable")["observable"]), bins)

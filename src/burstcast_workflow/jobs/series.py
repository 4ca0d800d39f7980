"""Series of a job: training and test series, their observations, actuation at random."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.base import random_streams
from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_attributes, read_netcdf, read_rows, variable_names
from burstcast.control.actuated_series import RandomlyActuated
from burstcast.control.actuation import actuated_system
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.ensemble_files import SCHEDULE
from burstcast.data.scheduled_series import RandomActuation, TrainingSet
from burstcast.systems.parameters import SHARE, Parameters, SystemParameters
from burstcast_workflow.harness.settings import JobSettings, at
from burstcast_workflow.jobs.cases import Clock, Sampling, System
from burstcast_workflow.jobs.origins import origins

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

    series: int = at("case.training.series")

    def check_series(self, kept: int, **needs: int) -> None:
        """Check that as many series were kept as the training, and other uses, need."""
        check_kept_series(kept, {str(Training.series): self.series, **needs})

    def states(self, ensemble: str) -> FloatArray:
        """True states of the training series, ``(series, time, dimension)``."""
        self.check_series(kept_series(ensemble))
        return read_rows(ensemble, "state", 0, self.series)


class Tested(JobSettings):
    """The series after them, which forecasters are tested on."""

    training: Training
    wanted: int | None = at("case.test_series")

    def series(self, kept: int) -> int:
        """Number of test series: as many as wanted, or all kept series after the training series.

        Where none is left, one is asked for, so that the check says how many there are.
        """
        return int(self.wanted or max(1, kept - self.training.series))

    def rows(self, ensemble: str) -> range:
        """Rows of the test series in the ensemble."""
        kept, first = kept_series(ensemble), self.training.series
        series = self.series(kept)
        self.training.check_series(kept, test_series=series)
        return range(first, first + series)


class Observed(JobSettings):
    """Observations of the series."""

    training: Training
    random_seed: int = at("random_seed")
    noise: float = at("case.training.noise")

    def rows(self, ensemble: str, first: int, states: FloatArray, kind: str = "") -> FloatArray:
        """Observations of kept series: states with noise, or the channels of encoded series.

        ``first`` is the row of the first series in the ensemble, ``states`` are ``(series, time,
        dimension)``. Series with a ``kind`` are others than the ensemble's: their noise is their
        own.
        """
        if not kind and OBSERVED in variable_names(ensemble):
            return read_rows(ensemble, OBSERVED, first, first + len(states))
        training = read_rows(ensemble, "state", 0, self.training.series)
        return observed_series(
            states,
            first,
            self.noise,
            component_scales(training),
            self.random_seed,
            f"{self.case} {kind}".rstrip(),
        )


def read_scheduled(paths: Sequence[str], case: str) -> TrainingSet:
    """Read the scheduled series of several cases, for a forecaster of one (`TrainingSet`)."""
    parts = [read_netcdf(path, "state", "observed", "parameter") for path in paths]
    free = [
        number
        for number, origin in enumerate(origins(paths))
        if origin.identity["case"] == case and not int(read_attributes(origin.path)["actuated"])
    ]
    return TrainingSet.of_parts(parts, free[0] if free else None)


class Switched(JobSettings):
    """An actuator that switches at random, and what forecasters know about it."""

    system: System
    sampling: Sampling
    clock: Clock
    observed: Observed
    random_seed: int = at("random_seed")
    switching: dict[str, Any] | None = at("case.training.actuation")
    actuation: dict[str, Any] | None = at("case.actuation")
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")
    names: list[str] = at("job.parameters")

    @property
    def known_parameters(self) -> Parameters:
        """Parameters that forecasters are given, with the case's own values."""
        return self.system.forecaster_parameters(self.names, self.actuation)

    def series(
        self, ensemble: str, rows: range, purpose: str
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """States of series under an actuator that switches at random; observations; schedules.

        ``purpose``: "training" or "test": the random streams are called after it.
        """
        switching, actuation = self.switching, self.actuation
        assert switching is not None
        assert actuation is not None
        system, parameters = self.system.equations, self.known_parameters
        on: tuple[float, ...] = (switching["strength"],)
        if self.names != [SHARE]:
            actuated = actuated_system(
                system, actuation["parameters"], actuation["force"], switching["strength"]
            )
            on = SystemParameters.of(actuated, self.names).defaults
        interval_lt = switching["interval_lt"]
        interval = self.clock.positive_steps(interval_lt, f"{Switched.switching}.interval_lt")
        flow = RandomlyActuated(
            system,
            parameters,
            on,
            RandomActuation(
                interval,
                switching["mean_on_lt"] / interval_lt,
                switching["mean_off_lt"] / interval_lt,
            ),
            time_step=self.sampling.time_step,
            sampling_stride=self.sampling.stride,
            laminarisation_threshold=self.laminarisation_threshold,
        )
        stream = random_streams.stream(self.random_seed, f"{purpose} actuation", self.case)
        states, schedules = flow.series(read_rows(ensemble, "state", rows.start, rows.stop), stream)
        observed = self.observed.rows(ensemble, rows.start, states, "actuated")
        return states, observed, schedules

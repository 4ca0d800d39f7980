"""Take an ensemble in another order, so that other series of it are trained on."""

from typing import Any

import numpy as np

from burstcast.base import random_streams
from burstcast.base.files.netcdf import read_netcdf
from burstcast.data.ensemble_files import ensemble_variables, schedule_variable
from burstcast.data.training_realisations import (
    realisation_of,
    rows_of_drawn_series,
    rows_of_realisation,
)
from burstcast_workflow.harness.job import JobSettings, at, job, write_json, write_netcdf
from burstcast_workflow.jobs.cases import Sampling, System
from burstcast_workflow.jobs.series import Tested, check_kept_series, known_rows


class Realisation(JobSettings):
    """A choice of the training series."""

    system: System
    sampling: Sampling
    tested: Tested
    random_seed: int = at("random_seed")
    calibration_series: int = at("probability.calibration_series")
    realisation: int = at("case.realisation")
    drawn: dict[str, Any] | None = at("job.drawn_shares")


@job
def choose_training_series(
    *, source: str, ensemble: str, summary: str, settings: Realisation
) -> None:
    """Write the same series; the first are others, the test series are equal."""
    training, realisation = settings.tested.training.series, settings.realisation
    data = read_netcdf(source, "series", "lifetime", "state", "observable")
    kept = len(data["series"])
    held = {
        "test_series": settings.tested.series(kept),
        str(Realisation.calibration_series): settings.calibration_series,
    }
    needs = {"training.series x realisations": training * (realisation + 1), **held}
    check_kept_series(kept, needs)
    if drawn := settings.drawn:
        base, _ = realisation_of(settings.case)
        rows = rows_of_drawn_series(
            (data["observable"] >= drawn["threshold"]).sum(axis=1)
            / (~np.isnan(data["observable"])).sum(axis=1),
            training,
            sum(held.values()),
            drawn["shares"],
            [
                random_streams.stream(settings.random_seed, "training series", base, number)
                for number, _ in enumerate(drawn["shares"], 1)
            ],
        )
    else:
        rows = rows_of_realisation(kept, training, realisation)
    variables, of_all = ensemble_variables(
        data["state"][rows],
        data["observable"][rows],
        settings.system.space.observable_name,
        data["series"][rows],
        data["lifetime"],
        settings.sampling.interval,
    )
    if (schedules := known_rows(source, 0, len(rows))) is not None:
        variables |= schedule_variable(schedules[rows])
    write_netcdf(ensemble, variables, settings.provenance)
    write_json(summary, of_all, settings.provenance)

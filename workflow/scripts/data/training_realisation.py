"""Take an ensemble in another order, so that other series of it are trained on."""

import numpy as np

from burstcast import random_streams
from burstcast.arrays import FloatArray, IntArray
from burstcast.data.ensemble_files import ensemble_variables, schedule_variable
from burstcast.data.training_realisations import (
    draw_training_series,
    realisation_of,
    rows_of_realisation,
    trained_first,
)
from burstcast.files.netcdf import read_netcdf
from burstcast_workflow.harness.job import Settings, job, write_json, write_netcdf
from burstcast_workflow.jobs.data import check_kept_series, known_rows, test_series
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import sampling_interval


def _drawn(observable: FloatArray, settings: Settings) -> IntArray:
    """Order in which the drawn series come first, and the test series keep their places."""
    drawn, training, kept = settings["drawn"], settings["case.training.series"], len(observable)
    held = test_series(settings, kept) + settings["probability.calibration_series"]
    candidates = np.delete(np.arange(kept), np.s_[training : training + held])
    happens = (observable >= drawn["threshold"]).mean(axis=1)
    base, _ = realisation_of(settings["case"])
    chosen = draw_training_series(
        happens,
        candidates,
        training,
        [happens.mean() if share == "all" else share for share in drawn["shares"]],
        [
            random_streams.stream(settings["random_seed"], "training series", base, number)
            for number, _ in enumerate(drawn["shares"], 1)
        ],
    )
    return trained_first(kept, chosen[-1])


@job
def choose_training_series(*, source: str, ensemble: str, summary: str, settings: Settings) -> None:
    """Write the same series; the first are others, the test series are equal."""
    training, realisation = settings["case.training.series"], settings["realisation"]
    data = read_netcdf(source, "series", "lifetime", "state", "observable")
    check_kept_series(
        len(data["series"]),
        {
            "training.series x realisations": training * (realisation + 1),
            "test_series": test_series(settings, len(data["series"])),
            "probability.calibration_series": settings["probability.calibration_series"],
        },
    )
    if settings["drawn"]:
        rows = _drawn(data["observable"], settings)
    else:
        rows = rows_of_realisation(len(data["series"]), training, realisation)
    variables, of_all = ensemble_variables(
        data["state"][rows],
        data["observable"][rows],
        system_of(settings).observable_name,
        data["series"][rows],
        data["lifetime"],
        sampling_interval(settings),
    )
    if (known := known_rows(source, 0, len(rows))) is not None:
        variables |= schedule_variable(known[rows])
    write_netcdf(ensemble, variables, settings.provenance)
    write_json(summary, of_all, settings.provenance)

"""Take an ensemble in another order, so that other series of it are trained on."""

from burstcast import random_streams
from burstcast.data.ensemble_files import ensemble_variables, schedule_variable
from burstcast.data.training_realisations import (
    realisation_of,
    rows_of_drawn_series,
    rows_of_realisation,
)
from burstcast.files.netcdf import read_netcdf
from burstcast_workflow.harness.job import Settings, job, write_json, write_netcdf
from burstcast_workflow.jobs.data import check_kept_series, known_rows, test_series
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import sampling_interval


@job
def choose_training_series(*, source: str, ensemble: str, summary: str, settings: Settings) -> None:
    """Write the same series; the first are others, the test series are equal."""
    training, realisation = settings["case.training.series"], settings["realisation"]
    data = read_netcdf(source, "series", "lifetime", "state", "observable")
    kept = len(data["series"])
    held = {
        "test_series": test_series(settings, kept),
        "probability.calibration_series": settings["probability.calibration_series"],
    }
    needs = {"training.series x realisations": training * (realisation + 1), **held}
    check_kept_series(kept, needs)
    if drawn := settings["drawn"]:
        base, _ = realisation_of(settings["case"])
        rows = rows_of_drawn_series(
            (data["observable"] >= drawn["threshold"]).mean(axis=1),
            training,
            sum(held.values()),
            drawn["shares"],
            [
                random_streams.stream(settings["random_seed"], "training series", base, number)
                for number, _ in enumerate(drawn["shares"], 1)
            ],
        )
    else:
        rows = rows_of_realisation(kept, training, realisation)
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

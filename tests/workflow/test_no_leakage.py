"""Nothing of the test series enters a choice: with noise in their place all that is chosen stays.

Chosen are hyperparameters, readouts and fits, calibrations and the thresholds of alarms.
"""

import netCDF4
import numpy as np
import pytest
from helpers_rebuilds import RESULTS, digests

from burstcast_workflow.harness.storage import read_netcdf

TRAINING, TEST = 3, 12  # series of the tiny preset
CHOSEN = (
    "scan/*.csv",
    "*/hyperparameters.json",
    "*/search.csv",
    "*/forecaster.nc",
    "calibration_set.nc",
    "*/calibration_forecast.nc",
    "calibration.json",
)
FURTHER = {"probability": {"calibration_series": 2}}


def replace_by_noise(ensemble, rows):
    """Put noise of the size of the data into series of an ensemble."""
    generator = np.random.default_rng(0)
    with netCDF4.Dataset(ensemble, "r+") as file:
        for name in ("state", "observable"):
            values = file[name][:]
            spread = values.std()
            values[rows] = generator.uniform(0, 2 * spread, values[rows].shape)
            file[name][:] = values


def chosen(case):
    """Files of all that is chosen, below the directory of the case."""
    return sorted(str(path.relative_to(case)) for pattern in CHOSEN for path in case.glob(pattern))


@pytest.fixture(scope="module")
def with_noise(finished, tmp_path_factory):
    """The tiny preset with noise in place of its test series, and what was chosen removed."""
    project = finished.project.copy(tmp_path_factory.mktemp("noise") / "project")
    case = project.results / "Re400"
    names = chosen(case)
    assert len(names) > 20
    replace_by_noise(case / "ensemble.nc", slice(TRAINING, TRAINING + TEST))
    for name in [*names, "evaluation_set.nc"]:
        (case / name).unlink()
    targets = [f"{RESULTS}/Re400/{name}" for name in [*names, "evaluation_set.nc"]]
    outcome = project.snakemake(*targets)
    assert outcome.status == 0, outcome.text[-3000:]
    return project


def test_what_is_chosen_stays_bit_for_bit(finished, with_noise):
    before, after = (
        digests(project.results / "Re400") for project in (finished.project, with_noise)
    )
    names = chosen(finished.project.results / "Re400")
    assert {name: after[name] for name in names} == {name: before[name] for name in names}
    # while the test set is another one
    assert after["evaluation_set.nc"] != before["evaluation_set.nc"]


def test_further_calibration_series_are_neither_training_nor_test(finished, with_noise, tmp_path):
    name = "Re400/calibration_set.nc"
    copies = [
        project.copy(tmp_path / folder)
        for project, folder in ((finished.project, "true"), (with_noise, "noise"))
    ]
    for project in copies:
        outcome = project.snakemake(f"{RESULTS}/{name}", overlay=FURTHER)
        assert outcome.status == 0, outcome.text[-3000:]
    files = [project.results / name for project in copies]
    assert files[0].read_bytes() == files[1].read_bytes()
    # they are those that follow: noise there changes the set
    assert set(read_netcdf(files[0], "series")["series"]) == {0, 1}
    first = TRAINING + TEST
    replace_by_noise(copies[1].results / "Re400/ensemble.nc", slice(first, first + 2))
    files[1].unlink()
    assert copies[1].snakemake(f"{RESULTS}/{name}", overlay=FURTHER).status == 0
    assert files[0].read_bytes() != files[1].read_bytes()

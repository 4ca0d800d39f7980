"""Nothing of the test series enters a choice: with noise in their place all that is chosen stays.

Chosen are hyperparameters, readouts and fits, calibrations and the thresholds of alarms.
"""

import pytest
from helpers_rebuilds import RESULTS, Project, digests, jobs_since, rules_of

from burstcast.files.netcdf import read_netcdf

TRAINING, TEST = 3, 12  # series of the tiny preset
CHOSEN = (
    "scan/*",
    "*/hyperparameters.json",
    "*/search.csv",
    "*/forecaster.nc",
    "calibration_set.nc",
    "*/calibration_forecast.nc",
    "calibration.json",
)
FURTHER = {"probability": {"calibration_series": 2}}
SIMULATE = "workflow/scripts/data/simulate.py"
OBSERVABLE = "    observable = np.stack("


def put_noise(project: Project, first: int, stop: int) -> None:
    """Let the ensemble have noise of the size of its states in place of some of its series."""
    rows = f"states[{first}:{stop}]"
    noise = f"np.random.default_rng({first}).uniform(-0.3, 0.3, {rows}.shape)"
    project.edit(SIMULATE, OBSERVABLE, f"    {rows} = {noise}\n{OBSERVABLE}")


def chosen(project: Project) -> list[str]:
    """Files of all that is chosen, below the directory of the results."""
    return sorted(
        str(path.relative_to(project.results))
        for pattern in CHOSEN
        for path in project.results.glob(f"Re400/{pattern}")
    )


def make(project: Project, names: list[str], overlay: dict | None = None) -> dict[str, str]:
    """Make files, and tell their digests."""
    outcome = project.snakemake(*(f"{RESULTS}/{name}" for name in names), overlay=overlay)
    assert outcome.status == 0, outcome.text[-3000:]
    made = digests(project.results)
    return {name: made[name] for name in names}


@pytest.fixture
def with_noise(finished, tmp_path):
    """The tiny preset, with noise in place of its test series once the ensemble is made anew."""
    project = finished.project.copy(tmp_path / "noise")
    put_noise(project, TRAINING, TRAINING + TEST)
    return project


@pytest.mark.long
def test_what_is_chosen_stays_bit_for_bit(finished, with_noise):
    names, test_set = chosen(finished.project), "Re400/evaluation_set.nc"
    assert len(names) > 20
    before, logs = digests(finished.project.results), with_noise.logs()
    after = make(with_noise, [*names, test_set])
    assert {name: after[name] for name in names} == {name: before[name] for name in names}
    # while the test set is another one, and all was made anew
    assert after[test_set] != before[test_set]
    assert rules_of(jobs_since(logs, with_noise.logs())) >= {
        *("simulate", "scan", "search", "train", "fit"),
        *("calibration_set", "calibration_forecast", "calibrate", "evaluation_set"),
    }


@pytest.mark.long
def test_further_calibration_series_are_neither_training_nor_test(finished, with_noise, tmp_path):
    name = "Re400/calibration_set.nc"
    beyond = finished.project.copy(tmp_path / "beyond")
    put_noise(beyond, TRAINING + TEST, TRAINING + TEST + 2)
    before = make(finished.project.copy(tmp_path / "true"), [name], FURTHER)
    assert make(with_noise, [name], FURTHER) == before
    # they are those that follow: noise there changes the set
    assert make(beyond, [name], FURTHER) != before
    assert set(read_netcdf(beyond.results / name, "series")["series"]) == {0, 1}

"""A record with dates and gaps through the jobs of the data, and its mistakes before a job."""

import re

import numpy as np
import pandas as pd
import pytest
import yaml
from helpers_rebuilds import Project

from burstcast.files.netcdf import read_netcdf

DATA = {
    "files": ["plant.csv"],
    "time_step": "1 hour",
    "observable": "load",
    "gaps": "cut",
    "blocks": {"duration": 24},
}
CASE = {
    "data": DATA,
    "event_threshold": 2,
    "lyapunov": {"published_exponent": 1},
    "training": {"series": 4},
}
LOST = (100, 101, 500)


def table():
    time = pd.date_range("2010-03-20", periods=1000, freq="h", tz="Europe/Berlin", name="time")
    values = np.random.default_rng(1).normal(size=(1000, 2))
    return pd.DataFrame(values, columns=["load", "heat"], index=time)


@pytest.fixture(scope="module")
def project(tmp_path_factory, job_server):
    """A record by a clock that is put forward on 28 March, with its offsets from UTC."""
    project = Project.create(
        tmp_path_factory.mktemp("record") / "project", job_server, "plant.yaml"
    )
    forecasters = {"persistence": {}, "linear_inverse": {}}
    config = {
        "results": "results/plant",
        "campaign": [{"cases": ["plant"], "forecasters": forecasters}],
        "washout_lt": 2,
        "cases": {"plant": CASE},
    }
    (project.directory / "plant.yaml").write_text(yaml.safe_dump(config))
    rows = table()
    rows.drop(index=rows.index[list(LOST)]).to_csv(project.directory / "plant.csv")
    return project


def test_series_of_a_record(project):
    outcome = project.snakemake("results/plant/plant/ensemble.nc")
    assert outcome.status == 0, outcome.text[-3000:]
    assert "gaps leave 3 parts of the record" not in outcome.text  # each is longer than a block
    found = read_netcdf(project.directory / "results/plant/plant/ensemble.nc")
    # 100, 398 and 499 hours make 4, 15 and 19 blocks of 25 samples
    assert found["state"].shape == (4 + 15 + 19, 25, 2)
    begin = pd.Timestamp("2010-03-20", tz="Europe/Berlin").timestamp() / 3600
    assert found["start"][[0, 1, 4, 19]].tolist() == [begin, begin + 25, begin + 102, begin + 501]
    np.testing.assert_array_equal(found["state"][4], table().to_numpy()[102:127])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "time,load,heat\n2010-03-28T02:00,1,2\n2010-03-28T02:00,1,2\n",
            r"plant.csv, row 2: column 'time' stays at the time of row 1",
        ),
        (
            "time,load,heat\n2010-03-20T00:00,1,2\n2010-03-20T05:00,1,2\n2010-03-20T03:00,1,2\n",
            r"plant.csv, row 3: .* goes back by 2 from the time of row 2.*write times in UTC",
        ),
    ],
)
def test_a_clock_that_jumps_fails_with_file_and_row(project, text, message):
    copy = project.copy(project.directory.parent / "copy")
    (copy.directory / "plant.csv").write_text(text)
    outcome = copy.snakemake("results/plant/plant/ensemble.nc")
    assert outcome.status != 0
    assert re.search(message, outcome.text), outcome.text[-2000:]

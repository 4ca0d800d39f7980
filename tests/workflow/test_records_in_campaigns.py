"""Records with dates and gaps through the jobs of the data, and every message before a job."""

import re
from datetime import datetime
from zoneinfo import ZoneInfo

import numpy as np
import pytest
import yaml
from helpers_rebuilds import Project

from burstcast.files.netcdf import read_netcdf
from burstcast_workflow.config.loading import ConfigError, load

BERLIN = ZoneInfo("Europe/Berlin")
HOURS = 1000
DATA = {
    "files": ["march.csv", "april.csv"],
    "joined": True,
    "time": "time",
    "time_unit": "hour",
    "time_zone": "Europe/Berlin",
    "time_step": 1,
    "observable": "load",
    "gaps": "cut",
    "blocks": {"duration": 24},
    "cycle": {"period": "1 day", "removed_from": ["heat"]},
}
CASE = {
    "data": DATA,
    "event_threshold": 2,
    "lyapunov": {"published_exponent": 1},
    "training": {"series": 4},
}


@pytest.fixture(scope="module")
def project(tmp_path_factory, job_server):
    """Two files of one record by local clocks, which are put forward on 28 March."""
    project = Project.create(
        tmp_path_factory.mktemp("record") / "project", job_server, "plant.yaml"
    )
    write_config(project, {})
    generator = np.random.default_rng(1)
    begin = datetime(2010, 3, 20, tzinfo=BERLIN).timestamp()
    rows = []
    for hour in range(HOURS):
        there = datetime.fromtimestamp(begin + 3600 * hour, BERLIN).replace(tzinfo=None)
        load, heat = generator.normal(), np.sin(2 * np.pi * hour / 24)
        rows.append((there, f"{there.isoformat()},{load:.17g},{heat:.17g}"))
    lost = {100, 101, 500}
    kept = [(there, text) for hour, (there, text) in enumerate(rows) if hour not in lost]
    for name, month in (("march", 3), ("april", 4)):
        lines = [text for there, text in kept if (there.month == 3) == (month == 3)]
        (project.directory / f"{name}.csv").write_text("\n".join(["time,load,heat", *lines, ""]))
    return project


def write_config(project, changes):
    forecasters = {"persistence": {}, "linear_inverse": {}}
    config = {
        "results": "results/plant",
        "campaign": [{"cases": ["plant"], "forecasters": forecasters}],
        "washout_lt": 2,
        "cases": {"plant": {**CASE, "data": {**DATA, **changes}}},
    }
    (project.directory / "plant.yaml").write_text(yaml.safe_dump(config))


def test_series_of_a_record(project):
    outcome = project.snakemake("results/plant/plant/ensemble.nc")
    assert outcome.status == 0, outcome.text[-3000:]
    assert "gaps leave 3 parts of the record" not in outcome.text  # each is longer than a block
    found = read_netcdf(project.directory / "results/plant/plant/ensemble.nc")
    # 100, 398 and 499 hours make 4, 15 and 19 blocks of 25 samples
    assert found["state"].shape == (4 + 15 + 19, 25, 4)
    begin = datetime(2010, 3, 20, tzinfo=BERLIN).timestamp() / 3600
    hours = [begin + 25 * number for number in range(4)]
    np.testing.assert_allclose(found["start"][:4], hours, rtol=1e-15)
    assert found["start"][4] == begin + 102
    assert found["start"][19] == begin + 501
    heat = found["state"][:, :, 1]
    np.testing.assert_allclose(heat, 0, atol=1e-9)  # it was all cycle
    phase = 2 * np.pi * (found["start"][:, np.newaxis] + np.arange(25)) / 24
    np.testing.assert_allclose(found["state"][:, :, 2], np.cos(phase), atol=1e-9)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (
            ["2010-03-28T02:30:00"],
            r"march.csv, line 3: column 'time' has '2010-03-28T02:30:00', wh",
        ),
        (["2010-03-20T05:00", "2010-03-20T03:00"], r"march.csv, row 3: .* goes back by 2 hours"),
    ],
)
def test_a_clock_that_jumps_fails_with_file_and_row(project, lines, message):
    copy = project.copy(project.directory.parent / "copy")
    rows = ["2010-03-20T00:00:00,1,2", *(f"{line},1,2" for line in lines)]
    (copy.directory / "march.csv").write_text("\n".join(["time,load,heat", *rows, ""]))
    outcome = copy.snakemake("results/plant/plant/ensemble.nc")
    assert outcome.status != 0
    assert re.search(message, outcome.text), outcome.text[-2000:]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"time_zone": "Europe/Berln"}, "data.time_zone is Europe/Berln, which is no time zone"),
        ({"time_unit": "month"}, "data.time_unit is the text 'month'; it must be "),
        ({"time_unit": None, "time_zone": None}, "data.cycle.period: '1 day' takes a unit of time"),
        ({"time_unit": None}, "data.time_zone needs time_unit beside it"),
        ({"blocks": None}, "data.gaps needs blocks beside it"),
        ({"blocks": {"duration": 5}}, "or data.blocks.duration: series of 6 samples"),
        ({"gaps": None, "longest_interpolation": 3}, "longest_interpolation needs gaps beside it"),
        ({"gaps": "fill"}, "data.gaps is the text 'fill'; it must be cut"),
        ({"longest_interpolation": 0}, "longest_interpolation is 0; it must be a number above 0"),
        ({"cycle": {"period": "1 fortnight"}}, "cycle.period is the text '1 fortnight'; it must"),
        ({"cycle": {"period": -1}}, "data.cycle.period is -1; it must be a number above 0"),
        ({"cycle": {}}, "data.cycle.period is missing"),
        ({"cycle": {"period": "1 day", "harmonics": 12}}, "take more than 24 samples in it"),
    ],
)
def test_mistakes_in_the_config(project, monkeypatch, changes, message):
    monkeypatch.chdir(project.directory)
    write_config(project, changes)
    try:
        config = yaml.safe_load((project.directory / "config.yaml").read_text(encoding="utf-8"))
        overlay = yaml.safe_load((project.directory / "plant.yaml").read_text(encoding="utf-8"))
        with pytest.raises(ConfigError) as caught:
            load({**config, **overlay})
    finally:
        write_config(project, {})
    assert any(message in one for one in caught.value.problems), caught.value.problems

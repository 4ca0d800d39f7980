"""The frozen cases, their data, and the files that they are exported to."""

import gzip
import re
import subprocess
import sys
from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
import pytest

from burstcast.benchmark import data as benchmark_data
from burstcast.benchmark.cases import CASES, case_named
from burstcast.benchmark.data import make_case
from burstcast.benchmark.export import export
from burstcast.benchmark.records import MissingRecordError, glucose
from burstcast.files.netcdf import read_attributes, read_netcdf
from burstcast_workflow.commands import benchmark as commands

BLOCK = 144

LARGE = ("Kolmogorov",)
"""Cases whose data take minutes."""


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.long] * (name in LARGE)) for name in CASES],
)
def test_the_data_of_each_case_are_frozen(name):
    """A change of anything that data depend on must raise the version of the case."""
    case = CASES[name]
    try:
        found = make_case(case)  # compares the digest
    except MissingRecordError as error:
        pytest.skip(str(error))
    assert re.fullmatch("[0-9a-f]{16}", case.digest)
    assert found.digest == case.digest
    assert len(found.training) == case.training_series
    assert len(found.observable) == case.test_series


def record(directory, rows):
    """An installed package that holds rows of time, glucose and current."""
    metadata = directory / "bokeh_sampledata-1.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: bokeh-sampledata\nVersion: 1\n"
    )
    path = directory / "bokeh_sampledata" / "_data" / "CGM.csv.gz"
    path.parent.mkdir(parents=True)
    with gzip.open(path, "wt", encoding="utf-8") as file:
        file.write("isig,datetime,glucose\n")
        file.writelines(
            f"{current},{time.isoformat(' ')},{value}\n" for time, value, current in rows
        )


def test_a_record_is_cut_where_it_has_gaps(tmp_path, monkeypatch):
    """Twice written samples are left out; gaps and unknown values end a series."""
    monkeypatch.setattr(sys, "path", [str(tmp_path)])
    day, step = datetime(2010, 3, 24), timedelta(minutes=5)
    whole = [(day + number * step, 100 + number, 20) for number in range(2 * BLOCK + 7)]
    twice = (whole[5][0] + timedelta(minutes=1), 999, 20)
    later = [(time + timedelta(days=3), value, 30) for time, value, _ in whole[:BLOCK]]
    unknown = [(time + timedelta(days=6), value, 40) for time, value, _ in whole]
    unknown[BLOCK - 1] = (*unknown[BLOCK - 1][:2], "nil")
    record(tmp_path, [*whole[:6], twice, *whole[6:], *later, *unknown])
    found = glucose()
    counted = 100.0 + np.arange(2 * BLOCK + 7)
    expected = [counted[:BLOCK], counted[BLOCK : 2 * BLOCK]]
    expected += [counted[:BLOCK], counted[BLOCK : 2 * BLOCK]]
    assert np.array_equal(found[..., 0], np.stack(expected))
    assert found[:, :, 1].min(axis=1).tolist() == [20, 20, 30, 40]


def test_a_record_that_is_not_installed_is_left_out(data, tmp_path, monkeypatch, capsys):
    """A case that is asked for is an error, which says what to install."""
    monkeypatch.setattr(sys, "path", [])
    with pytest.raises(MissingRecordError, match=r"case Glucose: .* pip install bokeh-sampledata"):
        make_case(CASES["Glucose"])
    monkeypatch.setattr(commands, "CASES", {"Glucose": CASES["Glucose"], "small": data.case})
    monkeypatch.setitem(CASES, "small", data.case)
    commands.export_cases(tmp_path, None, 1)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["README.md", "small.nc"]
    assert "left out: the case Glucose: its record comes with" in capsys.readouterr().err
    assert commands.main("export", directory=tmp_path, case=["Glucose"], seed=None) == 2


def test_another_digest_is_an_error():
    other = replace(CASES["Re1000"], digest="0123456789abcdef")
    with pytest.raises(ValueError, match="digest 48acc8106c52ce12"):
        make_case(other)
    assert make_case(other, seed=1).digest != make_case(other, seed=2).digest


def test_an_unknown_case_is_one_message():
    with pytest.raises(ValueError, match=r"no case 'Re40'.*Re400"):
        case_named("Re40")


def test_too_many_laminar_series_are_one_message(data):
    few = replace(data.case, series=10)
    with pytest.raises(ValueError, match="series of the case small do not laminarise, and it"):
        make_case(few)


def test_rounding_errors_do_not_change_the_digest(data):
    nearly = replace(data, training=data.training * (1 + 1e-15))
    assert nearly.digest == data.digest
    assert replace(data, training=data.training + 1e-5).digest != data.digest


def test_points_of_the_horizon_are_those_that_the_search_asks_for(data):
    """Each lead time of each event, once, and in an order that is not that of the lead times."""
    event, step = data.horizon_starts
    wanted = set()
    for row, (series, begin) in enumerate(
        zip(data.event_points.series, data.event_points.step, strict=True)
    ):
        for lead in data.search.lead_times_lt:
            start = begin - data.case.steps(lead)
            wanted.add((series, start))
            assert start - data.search.washout + 1 >= 0, row
    before = data.before_events.shape[1] - 1
    found = [
        (data.event_points.series[e], data.event_points.step[e] - before + s)
        for e, s in zip(event, step, strict=True)
    ]
    assert sorted(found) == sorted(wanted)
    assert len(data.event_points) == data.case.horizon_events
    assert (np.diff(step) > 0).any()
    assert (np.diff(step) < 0).any()


def test_an_export_has_what_forecasts_need_and_no_truth(data, tmp_path):
    export(tmp_path, [data.exported])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["README.md", "small.nc"]
    found, facts = read_netcdf(tmp_path / "small.nc"), read_attributes(tmp_path / "small.nc")
    assert np.array_equal(found["training"], data.training)
    assert np.array_equal(found["washout"], data.test.washouts)
    energy = 0.5 * (found["washout"] ** 2).sum(axis=2)
    np.testing.assert_allclose(found["washout_observable"], energy, rtol=1e-14)
    assert facts["forecast_steps"] == data.task.steps == found["window_last_step"][-1]
    assert facts["components"].split() == [f"a{number}" for number in range(1, 10)]
    assert facts["digest"] == data.digest
    # nothing reaches beyond a starting point, and nothing true is there
    assert found["washout"].shape[1] == found["horizon_washout"].shape[1] == data.search.washout
    truth = data.true_states.ravel()
    for array in found.values():
        assert not np.isin(truth, array).any()


def test_the_page_names_everything_in_the_file(data, tmp_path):
    export(tmp_path, [data.exported])
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    for name in read_netcdf(tmp_path / "small.nc"):
        assert f"`{name}`" in page, name
    for name in read_attributes(tmp_path / "small.nc"):
        # the last ones are for whoever compares two exports
        assert f"`{name}`" in page or name in ("digest", "about", "observable"), name
    assert "$" not in page
    assert page.count("# case=small case_version=3 seed=2026") == 1


def test_the_script_of_the_page_runs_without_burstcast(data, tmp_path):
    export(tmp_path, [data.exported])
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    (script,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert "burstcast" not in script
    assert len([line for line in script.splitlines() if line]) <= 24
    (tmp_path / "persistence.py").write_text(script, encoding="utf-8")
    subprocess.run([sys.executable, "persistence.py"], cwd=tmp_path, check=True)
    found = read_netcdf(tmp_path / "persistence.nc")
    assert (found["observable"] == data.test.seen[:, -1:]).all()


def test_another_seed_has_other_data(data):
    other = benchmark_data.make_case(data.case, 1)
    assert not np.array_equal(other.training, data.training)
    assert len(other.test.points) == len(data.test.points)

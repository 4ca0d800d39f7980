"""Campaigns with forecasts that other programs have made, in files."""

import copy
import re

import netCDF4
import numpy as np
import pandas as pd
import pytest
import yaml
from helpers_rebuilds import Project, jobs_since, rules_of

RESULTS, CASE = "results/external", "Re400"
TIMES, UNIT, THRESHOLD = (1, 2, 3), 61, 0.07
OVERLAY = yaml.safe_load("""
results: results/external
campaign:
  - reynolds: [400]
    forecasters: {persistence: {}, analogues: {}}
control: {forecasters: {esn: null, equations: null}, strategies: []}
statistics: {forecasters: {esn: null, equations: null}}
bootstrap: {resamples: 20}
""")
EXTERNAL = {
    "same": {"files": ["forecasts/{case}_same.nc"]},
    "members": {"files": ["forecasts/members.nc"], "alarm_threshold": 0.3},
    "given": {"files": ["forecasts/given.csv"], "alarm_threshold": 0.3},
}
NAMES = (
    *("classification", "classification_intervals", "horizon", "horizon_intervals"),
    *("probability_scores", "lead_times"),
)
TARGETS = [f"{RESULTS}/{CASE}/tables/{name}.csv" for name in NAMES]


def overlay(external=None):
    """The campaign of these tests, with forecasts from files."""
    found = copy.deepcopy(OVERLAY)
    if external is not None:
        found["campaign"][0]["forecasters"]["external"] = external
    return found


@pytest.fixture(scope="module")
def project(tmp_path_factory, job_server):
    """The washouts of the campaign, exported, and forecasts of other programs."""
    project = Project.create(tmp_path_factory.mktemp("external") / "project", job_server)
    project.made(f"{RESULTS}/{CASE}/forecast_task.nc", overlay=overlay())
    assert not (project.directory / RESULTS / CASE / "persistence").exists()
    directory = project.directory / "forecasts"
    directory.mkdir()
    with netCDF4.Dataset(project.directory / RESULTS / CASE / "forecast_task.nc") as task:
        facts = {name: task.getncattr(name) for name in ("case", "case_version", "seed")}
        now, before = (task[f"{name}_observable"][:, -1] for name in ("washout", "horizon_washout"))
        steps = {"step": task.forecast_steps, "horizon_step": task.horizon_steps}
    sizes = {"point": len(now), "horizon_point": len(before), "member": 4, **steps}
    write(directory / f"{CASE}_same.nc", facts, sizes, now, before)
    generator = np.random.default_rng(4)
    trajectories = np.full((4, len(now), sizes["step"]), 0.05)
    for time in TIMES:  # a peak in the middle of some windows
        peaks = generator.random((4, len(now))) < 0.3
        trajectories[..., time * UNIT + 20] += 0.03 * peaks
    write(directory / "members.nc", facts, sizes, trajectories)
    # what the members say, told as probabilities
    votes = [
        np.mean(
            [
                (one[:, time * UNIT - 1] < THRESHOLD)
                & (one[:, time * UNIT - 1 : (time + 1) * UNIT].max(axis=1) >= THRESHOLD)
                for one in trajectories
            ],
            axis=0,
        )
        for time in TIMES
    ]
    lines = [
        f"{point},{time},{float(votes[row][point])!r}"
        for point in reversed(range(len(now)))
        for row, time in enumerate(TIMES)
    ]
    head = "# " + " ".join(f"{name}={value}" for name, value in facts.items())
    text = "\n".join([head, "point,prediction_time_lt,probability", *lines])
    (directory / "given.csv").write_text(text, encoding="utf-8")
    return project


def write(path, facts, sizes, forecasts, horizon=None):
    """Forecasts of the observable; those of one number for each point stay at it."""
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(facts)
        for name, length in sizes.items():
            file.createDimension(name, length)
        ahead = ("point", "step") if forecasts.ndim == 1 else ("member", "point", "step")
        values = forecasts[:, np.newaxis] if forecasts.ndim == 1 else forecasts
        file.createVariable("observable", "f8", ahead)[:] = values
        if horizon is not None:
            dimensions = ("horizon_point", "horizon_step")
            file.createVariable("horizon_observable", "f8", dimensions)[:] = horizon[:, np.newaxis]


@pytest.fixture(scope="module")
def tables(project):
    project.made(*TARGETS, overlay=overlay(EXTERNAL))
    directory = project.directory / RESULTS / CASE / "tables"
    return {name: pd.read_csv(directory / f"{name}.csv") for name in NAMES}


def rows(table, forecaster):
    """Rows of a forecaster, without its name."""
    found = table[table["forecaster"] == forecaster]
    return found.drop(columns=["forecaster", "alarm"], errors="ignore").reset_index(drop=True)


@pytest.mark.parametrize("name", NAMES[:4])
def test_the_same_forecasts_have_the_same_rows(tables, name):
    """Persistence in plain NumPy, from the exported washouts, is the workflow's own."""
    expected = rows(tables[name], "persistence")
    assert len(expected)
    pd.testing.assert_frame_equal(rows(tables[name], "external_same"), expected, check_exact=True)


def test_probabilities_are_taken_as_they_are(tables):
    """Shares of members, or the same numbers as probabilities, have the same scores."""
    scores = tables["probability_scores"]
    assert rows(scores, "external_same").query("metric == 'alarm_threshold'")["value"].eq(0.5).all()
    found = rows(scores, "external_members")
    assert found.query("metric == 'alarm_threshold'")["value"].eq(0.3).all()
    assert set(found["probability"]) == {"calibrated", "votes"}
    for name in NAMES:
        one, other = (rows(tables[name], f"external_{label}") for label in ("members", "given"))
        pd.testing.assert_frame_equal(one, other, check_exact=True)
    raw = rows(scores, "persistence").query("probability == 'votes'").set_index("metric")
    same = rows(scores, "external_same").query("probability == 'votes'").set_index("metric")
    for metric in ("brier_score", "brier_skill", "roc_area"):
        assert raw.loc[metric, "value"].tolist() == same.loc[metric, "value"].tolist()


def test_alarms_are_raised_from_the_threshold_on(tables, project):
    """A share of 0.25 raises none at the threshold 0.3, one of 0.5 does."""
    text = (project.directory / "forecasts" / "given.csv").read_text().splitlines()[2:]
    given = np.array([[float(part) for part in line.split(",")] for line in text])
    with netCDF4.Dataset(project.directory / RESULTS / CASE / "evaluation_set.nc") as points:
        quiet = np.flatnonzero(points["washout_maximum"][:] < THRESHOLD)
    found = rows(tables["classification"], "external_given")
    for time, row in zip(TIMES, found.itertuples(), strict=True):
        here = given[(given[:, 1] == time) & np.isin(given[:, 0], quiet)]
        assert row.true_positive + row.false_positive == (here[:, 2] >= 0.3).sum() > 0
        assert row.true_negative + row.false_negative == (here[:, 2] < 0.3).sum() > 0


def test_forecasts_without_the_horizon_have_no_row_there(tables):
    assert set(tables["horizon"]["forecaster"]) == {"persistence", "analogues", "external_same"}


def test_an_exchanged_file_runs_again_what_depends_on_it(project, tables, tmp_path):
    """Its forecasts are read again, and the tables made; a new time stamp alone does nothing."""
    changed = project.copy(tmp_path / "changed")
    path = changed.directory / "forecasts" / "given.csv"
    path.touch()
    assert changed.dry_run(*TARGETS, overlay=overlay(EXTERNAL)) == {}
    lines = path.read_text().splitlines()
    lines[2] = re.sub(r",[^,]*$", ",1", lines[2])
    path.write_text("\n".join(lines))
    before = changed.logs(RESULTS)
    changed.made(*TARGETS, overlay=overlay(EXTERNAL))
    ran = jobs_since(before, changed.logs(RESULTS))
    assert {name for name in ran if "external_forecasts" in name} == {
        f"external_forecasts/{CASE}/external-given.log"
    }
    made = {"classification_table", "probability_scores", "lead_times"}
    assert made <= rules_of(ran) <= made | {"external_forecasts", "horizon_table"}


def test_forecasts_of_other_washouts_are_named(project, tables, tmp_path):
    """Data that have changed have another version: old forecasts are not scored with them."""
    changed = project.copy(tmp_path / "changed")
    other = overlay(EXTERNAL)
    other["case_defaults"] = {"training": {"noise": 0.02}}
    target = f"{RESULTS}/{CASE}/external-given/forecast.nc"
    outcome = changed.snakemake(target, overlay=other)
    assert outcome.status != 0
    assert re.search(
        r"given\.csv is of version [0-9a-f]{16} of the case Re400, and version [0-9a-f]{16} is "
        r"scored: export the case again, and forecast from the new washouts",
        outcome.text,
    )

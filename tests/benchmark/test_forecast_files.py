"""Files of forecasts: what is right is read, whatever is wrong is one message."""

import re
import tracemalloc

import netCDF4
import numpy as np
import pytest

from burstcast.benchmark.forecast_files import ForecastFileError, facts_of, read_forecasts
from burstcast.benchmark.task import ForecastTask
from burstcast.forecast.windows import summarise, window_boundaries
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.state_space import component_names

HEAD = "# case=small case_version=3f seed=2026"


def write_netcdf(path, facts, **variables):
    """Write arrays with their dimensions: name = (dimensions, array)."""
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(facts)
        for name, (dimensions, array) in variables.items():
            for dimension, length in zip(dimensions, np.shape(array), strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, length)
            kind = np.asarray(array).dtype
            file.createVariable(name, kind, dimensions, fill_value=False)[...] = array
    return path


def write_csv(path, header, rows, head=HEAD, separator=","):
    lines = [separator.join(f"{value:.17g}" for value in row) for row in rows]
    path.write_text("\n".join([head, header, *lines, ""]), encoding="utf-8")
    return path


def table(array, first=(0, 0)):
    """Rows of a CSV file: all indices, then the value."""
    indices = np.indices(array.shape).reshape(array.ndim, -1).T
    offsets = [0] * (array.ndim - 2) + list(first)
    return np.column_stack([indices + offsets, array.ravel()])


@pytest.fixture(scope="module")
def task():
    """Forty points, forecast for three Lyapunov times; ten of the horizon."""
    return ForecastTask(
        case="small",
        version="3f",
        seed=2026,
        space=MoehlisFaisstEckhardt(400.0),
        points=40,
        boundaries=window_boundaries(0.5, 5, 61),
        prediction_times_lt=(1.0, 2.0),
        window_lt=1.0,
        resolution_lt=0.5,
        horizon_points=10,
        horizon_steps=122,
    )


@pytest.fixture(scope="module")
def facts(task):
    """Attributes of a file of forecasts."""
    return {"case": "small", "case_version": "3f", "seed": task.seed}


@pytest.fixture
def generator():
    return np.random.default_rng(0)


def trajectories(task, generator, members=()):
    return generator.uniform(0, 0.1, (*members, task.points, task.steps))


@pytest.mark.parametrize("suffix", ["nc", "csv"])
def test_trajectories_of_members_are_read(task, facts, generator, tmp_path, suffix):
    """Rows of a table come in any order."""
    values, path = trajectories(task, generator, (3,)), tmp_path / f"a.{suffix}"
    if suffix == "nc":
        write_netcdf(path, facts, observable=(("member", "point", "step"), values))
    else:
        rows = generator.permutation(table(values, (0, 1)))
        write_csv(path, "member,point,step,observable", rows)
    assert facts_of(path) == ("small", "3f", 2026)
    found = read_forecasts([path], task)
    assert len(found.members) == 3
    assert found.probability is None
    assert found.horizon is None
    for member, one in zip(found.members, values, strict=True):
        expected = summarise(one.T, task.boundaries)
        assert np.array_equal(member.first, expected.first)
        assert np.array_equal(member.largest, expected.largest)


def test_the_observable_is_computed_from_components(task, facts, generator, tmp_path):
    states = generator.uniform(-0.2, 0.2, (task.points, task.steps, 9))
    path = write_netcdf(tmp_path / "a.nc", facts, state=(("point", "step", "component"), states))
    energy = 0.5 * np.square(states).sum(axis=2)
    (found,) = read_forecasts([path], task).members
    expected = summarise(energy.T, task.boundaries)
    np.testing.assert_allclose(found.largest, expected.largest, rtol=1e-14)
    names = ",".join(component_names(task.space))
    indices = table(energy, (0, 1))[:, :2]
    rows = np.column_stack([indices, states.reshape(-1, 9)])
    path = write_csv(tmp_path / "b.csv", f"point,step,{names}", rows)
    (same,) = read_forecasts([path], task).members
    assert np.array_equal(same.largest, found.largest)


def test_coordinates_of_components_and_horizon_steps_are_read(task, facts, generator, tmp_path):
    states = generator.uniform(-0.2, 0.2, (task.points, task.steps, 9))
    state = {"state": (("point", "step", "component"), states)}
    steps = np.arange(1.0, task.horizon_steps + 1)
    path = write_netcdf(tmp_path / "a.nc", facts, **state, component=(("component",), np.arange(9)))
    assert len(read_forecasts([path], task).members) == 1
    for wrong in (np.arange(9)[::-1], np.zeros(9, int)):
        path = write_netcdf(tmp_path / "a.nc", facts, **state, component=(("component",), wrong))
        with pytest.raises(ForecastFileError, match=r"component must be a1, a2, .*, in this order"):
            read_forecasts([path], task)
    for wrong in (steps[::-1], steps - 1):
        path = write_netcdf(
            tmp_path / "a.nc", facts, **state, horizon_step=(("horizon_step",), wrong)
        )
        with pytest.raises(ForecastFileError, match="horizon_step must count 1, 2"):
            read_forecasts([path], task)


def test_probabilities_and_a_horizon_are_scored_together(task, facts, generator, tmp_path):
    values = generator.uniform(0, 1, (task.points, 2))
    rows = [
        (point, time, values[point, column])
        for point in range(len(values))
        for column, time in enumerate((1, 2))
    ]
    path = write_csv(tmp_path / "p.csv", "point,prediction_time_lt,probability", rows)
    shape = task.horizon_points, task.horizon_steps
    horizon = generator.uniform(0, 0.1, shape).astype(np.float32)
    name = "horizon_observable"
    other = write_netcdf(
        tmp_path / "h.nc", facts, **{name: (("horizon_point", "horizon_step"), horizon)}
    )
    found = read_forecasts([path, other], task)
    assert np.array_equal(found.probability, values)
    assert np.array_equal(found.horizon, horizon.astype(np.float64))


def test_forecasts_are_given_once(task, facts, generator, tmp_path):
    values = (("point", "step"), trajectories(task, generator))
    one, two = (
        write_netcdf(tmp_path / name, facts, observable=values) for name in ("a.nc", "b.nc")
    )
    for paths in ([one, two], [one, one]):
        with pytest.raises(ForecastFileError, match=r"windows \(observable\), and so has .*a"):
            read_forecasts(paths, task)
    probability = (("point", "prediction_time"), np.zeros((task.points, 2)))
    path = write_netcdf(tmp_path / "c.nc", facts, observable=values, probability=probability)
    with pytest.raises(ForecastFileError, match="give one of them"):
        read_forecasts([path], task)


def said(paths, task):
    with pytest.raises(ForecastFileError) as caught:
        read_forecasts([paths], task)
    text = str(caught.value)
    assert text.startswith(str(paths))
    assert "\n" not in text
    return text


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda rows: np.delete(rows, 700, axis=0), "no row for point 3, step 152: 1 of"),
        (lambda rows: rows[:-1], "no row for point {last}, step 183: 1 of"),
        (lambda rows: np.vstack([rows, rows[4]]), "gives point 0, step 5 again, after line 7"),
        (lambda rows: np.vstack([rows, [0, 184, 0.1]]), "step is 184; expected are whole numbers"),
        (lambda rows: np.vstack([rows, [999, 1, 0.1]]), "point is 999; expected are whole"),
        (
            lambda rows: rows + np.array([0, 0.5, 0]),
            "line 3: step is 1.5; expected are whole numbers",
        ),
        (
            lambda rows: rows - np.array([0, 1, 0]),
            "line 3: step is 0; expected are whole numbers from 1",
        ),
        (lambda rows: np.where(rows == rows[9, 2], np.nan, rows), "line 12 .* nan; expected is a"),
        (lambda rows: np.where(rows == rows[9, 2], np.inf, rows), "line 12 .* inf; expected is a"),
        (lambda rows: rows[:0], "has a header, but no rows"),
    ],
    ids=lambda value: "" if callable(value) else value,
)
def test_wrong_rows_are_named(task, generator, tmp_path, change, expected):
    rows = change(table(trajectories(task, generator), (0, 1)))
    path = write_csv(tmp_path / "a.csv", "point,step,observable", rows)
    text = said(path, task)
    assert re.search(expected.format(last=task.points - 1), text), text


def test_members_must_not_differ(task, generator, tmp_path):
    rows = table(trajectories(task, generator, (2,)), (0, 1))
    header = "member,point,step,observable"
    text = said(write_csv(tmp_path / "a.csv", header, rows[:-5]), task)
    last = task.points - 1
    assert f"no row for member 1, point {last}, step 179: 5 of" in text
    rows[rows[:, 0] == 1, 0] = 2
    text = said(write_csv(tmp_path / "b.csv", header, rows), task)
    assert "member is 2; expected are members 0, 1, ... without a gap" in text


@pytest.mark.parametrize("wrong", [-0.1, 1.5, float("nan")])
@pytest.mark.parametrize("suffix", ["csv", "nc"])
def test_probabilities_lie_between_0_and_1(task, facts, generator, tmp_path, wrong, suffix):
    values = generator.uniform(0, 1, (task.points, 2))
    values[1, 0] = wrong
    path = tmp_path / f"a.{suffix}"
    if suffix == "nc":
        write_netcdf(path, facts, probability=(("point", "prediction_time"), values))
    else:
        rows = table(values, (0, 1))
        write_csv(path, "point,prediction_time_lt,probability", rows)
    text = said(path, task)
    assert "point 1, prediction_time_lt 1" in text
    assert f"probability is {wrong:g}; expected is a" in text
    assert suffix == "nc" or "line 5" in text


def test_other_prediction_times_are_named(task, generator, tmp_path):
    rows = table(generator.uniform(0, 1, (task.points, 2)), (0, 2))
    path = write_csv(tmp_path / "a.csv", "point,prediction_time_lt,probability", rows)
    assert "line 4: prediction_time_lt is 3; expected are 1, 2" in said(path, task)


@pytest.mark.parametrize(
    ("header", "separator", "expected"),
    [
        ("point;step;observable", ";", r"'point;step;observable' \(fields are separated by comma"),
        ("point,step,observable", ";", r"line 3 has 1 fields \(fields are separated by commas\)"),
        ("point,step,energy", ",", "expected is one of point,step,observable"),
        ("step,point,observable", ",", "the header is 'step,point,observable'"),
        ("point,step,observable,x", ",", "the header is"),
    ],
)
def test_another_layout_of_a_table_is_named(task, generator, tmp_path, header, separator, expected):
    rows = table(trajectories(task, generator), (0, 1))
    path = write_csv(tmp_path / "a.csv", header, rows, separator=separator)
    assert re.search(expected, said(path, task))


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("0,1,0.05,7", "line 5 has 4 fields; expected are 3"),
        ("", "line 5 has no fields; expected are 3"),
        ("0,1,much", "line 5: observable is 'much'; expected is a number"),
        ("0,1,", "line 5: observable is ''; expected is a number"),
    ],
)
def test_a_damaged_line_is_named(task, generator, tmp_path, line, expected):
    rows = table(trajectories(task, generator), (0, 1))
    path = write_csv(tmp_path / "a.csv", "point,step,observable", rows)
    lines = path.read_text().splitlines()
    lines[4] = line
    path.write_text("\n".join(lines), encoding="utf-8")
    assert expected in said(path, task)


@pytest.mark.parametrize(
    ("dimensions", "cut", "expected"),
    [
        (
            ("point", "step"),
            (slice(1, None), slice(None)),
            r"dimensions \(point 39, step 183\); expected is \(point 40, step 183\)",
        ),
        (
            ("point", "step"),
            (slice(None), slice(0, 9)),
            r"dimensions \(point 40, step 9\); expected",
        ),
        (("step", "point"), (slice(None), slice(None)), r"dimensions \(step .*expected is \(point"),
        (("row", "step"), (slice(None), slice(None)), r"dimensions \(row"),
    ],
)
def test_another_shape_is_named(task, facts, generator, tmp_path, dimensions, cut, expected):
    values = trajectories(task, generator)[cut]
    path = write_netcdf(tmp_path / "a.nc", facts, observable=(dimensions, values))
    assert re.search(expected, said(path, task))


def test_a_value_that_is_not_finite_is_named(task, facts, generator, tmp_path):
    values = trajectories(task, generator, (2,))
    values[1, 3, 4] = np.nan
    path = write_netcdf(tmp_path / "a.nc", facts, observable=(("member", "point", "step"), values))
    text = said(path, task)
    assert "observable of member 1, point 3, step 5: observable is nan; expected is a" in text


def test_a_point_that_was_never_written_is_named(task, facts, tmp_path):
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(facts)
        file.createDimension("point", task.points)
        file.createDimension("step", task.steps)
        variable = file.createVariable("observable", "f4", ("point", "step"))
        variable[:7] = 0.05
        variable[8:] = 0.05
    text = said(path, task)
    assert "observable of point 7, step 1: observable is nan; expected is a" in text


@pytest.mark.parametrize("name", ["point", "component", "observable"])
@pytest.mark.parametrize("kind", ["f8", str])
def test_what_a_file_declares_is_not_allocated(name, kind, task, facts, tmp_path):
    """745 GiB in a file of some kB; numbers that are texts."""
    path = write_netcdf(tmp_path / "a.nc", facts)
    with netCDF4.Dataset(path, "a") as file:
        file.createDimension("long", 10**11)
        file.createVariable(name, kind, ("long",), chunksizes=[1024])
    tracemalloc.start()
    said(path, task)
    assert tracemalloc.get_traced_memory()[1] < 50e6
    tracemalloc.stop()


def test_variables_that_are_unknown_or_count_otherwise_are_named(task, facts, generator, tmp_path):
    right = (("point", "step"), trajectories(task, generator))
    path = write_netcdf(tmp_path / "a.nc", facts, observables=right)
    assert "unknown variable 'observables' (did you mean 'observable'?)" in said(path, task)
    path = write_netcdf(
        tmp_path / "b.nc", facts, observable=right, step=(("step",), np.arange(task.steps))
    )
    assert "step must count 1, 2, ..., 183" in said(path, task)
    steps = (("step",), 1 + np.arange(task.steps))
    path = write_netcdf(tmp_path / "c.nc", facts, observable=right, step=steps)
    assert len(read_forecasts([path], task).members) == 1


def test_a_file_without_forecasts_of_the_windows_is_not_scored(task, facts, tmp_path):
    shape = task.horizon_points, task.horizon_steps
    path = write_netcdf(
        tmp_path / "h.nc", facts, horizon_observable=(("horizon_point", "step"), np.zeros(shape))
    )
    assert "must have forecasts of the windows" in said(path, task)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"case_version": 2}, "of version 2 .* and version 3f is scored: export the case again"),
        ({"case_version": "new"}, "of version new .* and version 3f is scored"),
        ({"seed": "first"}, "seed must be a whole number, not first"),
    ],
)
def test_another_version_is_named(task, facts, tmp_path, change, expected):
    told = {**facts, **change}
    paths = [write_netcdf(tmp_path / "a.nc", told), tmp_path / "a.csv"]
    paths[1].write_text(f"# {' '.join(f'{name}={value}' for name, value in told.items())}\n")
    for path in paths:
        with pytest.raises(ForecastFileError, match=expected):
            read_forecasts([path], task)


def test_files_that_do_not_say_their_case_are_named(facts, tmp_path):
    path = write_netcdf(tmp_path / "a.nc", {"case": "small"})
    with pytest.raises(ForecastFileError, match="no global attribute 'case_version'"):
        facts_of(path)
    (tmp_path / "a.csv").write_text("point,step,observable\n")
    with pytest.raises(ForecastFileError, match="line 1: expected is the line # case=NAME"):
        facts_of(tmp_path / "a.csv")
    (tmp_path / "b.nc").write_text("no file of NetCDF")
    for name, expected in (("b.nc", "cannot be read"), ("c.nc", "No such file"), ("d.txt", "end")):
        with pytest.raises(ForecastFileError, match=expected):
            facts_of(tmp_path / name)

"""Files of event forecasters by whoever wrote them: nothing runs, nothing large is allocated."""

import json
import sys
import tracemalloc

import netCDF4
import numpy as np
import pytest
from test_event_forecaster import SMALL, lorenz
from test_event_forecaster_classifiers import settings

import burstcast
from burstcast.event_forecaster.files import _digest
from burstcast.systems.lorenz63 import Lorenz63

KINDS = {
    "analogues": {},
    "esn": {"members": 1, "options": {"backend": "scipy"}},
    "quadratic": {"event_threshold": {"quantile": 0.9}},
    "precursor": settings("precursor"),
}


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """A file of each kind."""
    directory, training = tmp_path_factory.mktemp("saved"), lorenz(4, 900, 1)
    for kind, changes in KINDS.items():
        given = {**SMALL, "options": None, "kind": kind} | changes
        burstcast.EventForecaster(**given).fit(training).save(directory / f"{kind}.nc")
    return directory


def tampered(path, target, change):
    """A copy with changed contents and the right digest."""
    with netCDF4.Dataset(path) as file:
        found = {name: file.getncattr(name) for name in file.ncattrs()}
        arrays = {name: np.asarray(variable[...]) for name, variable in file.variables.items()}
    parameters, fitted = (json.loads(found[name]) for name in ("parameters", "fitted"))
    change(parameters, fitted, arrays)
    attributes = {
        "event_forecaster": 2,
        "parameters": json.dumps(parameters),
        "fitted": json.dumps(fitted),
    }
    attributes["digest"] = _digest(attributes, arrays)
    with netCDF4.Dataset(target, "w") as file:
        file.setncatts(attributes)
        for name, array in arrays.items():
            axes = [f"{name}_{axis}" for axis in range(array.ndim)]
            for axis, length in zip(axes, array.shape, strict=True):
                file.createDimension(axis, length)
            file.createVariable(name, array.dtype, axes)[...] = array
    return target


def refused(path, most=50e6):
    """Message of the refusal, which takes little memory."""
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=path.name) as error:
            burstcast.EventForecaster.load(path)
        assert tracemalloc.get_traced_memory()[1] < most
    finally:
        tracemalloc.stop()
    return str(error.value)


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_what_is_copied_unchanged_is_loaded(kind, saved, tmp_path):
    path = tampered(saved / f"{kind}.nc", tmp_path / "copy.nc", lambda *_: None)
    series = lorenz(2, 300, 3)
    expected = burstcast.EventForecaster.load(saved / f"{kind}.nc").predict_proba(series)
    np.testing.assert_array_equal(
        burstcast.EventForecaster.load(path).predict_proba(series), expected
    )


@pytest.mark.parametrize("name", ["this:X", "antigravity:X", "json.tool:main", "os.path:join"])
def test_a_module_that_a_file_names_is_not_imported(name, saved, tmp_path):
    def change(parameters, fitted, arrays):
        parameters["observable"] = {"system": name, "parameters": {}}

    before = set(sys.modules)
    message = refused(tampered(saved / "analogues.nc", tmp_path / "bad.nc", change))
    assert f"names the system {name}, which is not one of burstcast's" in message
    assert name.partition(":")[0] not in set(sys.modules) - before


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "os"},
        {"kind": "../esn"},
        {"kind": "_filtered"},
        {"kind": "base"},
        {"kind": "external"},
        {"kind": ["esn"]},
        {"observable": {"system": "../base", "parameters": {}}},
        {"observable": {"system": "lorenz63", "parameters": {"sigma": [1]}}},
        {"observable": {"system": "kolmogorov", "parameters": {"largest_wavenumber": 1e9}}},
        {"observable": {"parameters": {}}},
        {"observable": [[]]},
        {"observable": None},
        {"nonsense": 1},
        {"prediction_times": 3},
        {"prediction_times": [0.5]},
        {"lyapunov_time": -1},
        {"sampling_interval": "a"},
        {"sampling_stride": 0},
        {"options": [1]},
        {"options": {"nonsense": 1}},
        {"tikhonov": None},
        {"sampling_stride": 10**9},
        {"prediction_times": [0.5, 1e9]},
        {"washout": 1e9},
        {"options": {"neighbours": 10**9}},
    ],
    ids=str,
)
def test_parameters_that_are_none(change, saved, tmp_path):
    refused(tampered(saved / "analogues.nc", tmp_path / "bad.nc", lambda p, *_: p.update(change)))


@pytest.mark.parametrize(
    "change",
    [
        {"event_threshold": float("nan")},
        {"event_threshold": None},
        {"components": 10**9},
        {"components": "x"},
        {"reference_states": [["a"]]},
        {"reference_states": []},
        {"reference_observable": None},
        {"members": []},
        {"members": [[]]},
        {"members": 3},
        {"alarms": []},
        {"alarms": [{"prediction_time": 0.5}]},
        {"stream": {"latest": [[1.0]], "time": None}},
        {"stream": {"latest": [[1.0, 2.0, 3.0]], "time": "noon"}},
        {"stream": 5},
    ],
    ids=str,
)
def test_a_fit_that_is_none(change, saved, tmp_path):
    refused(tampered(saved / "analogues.nc", tmp_path / "bad.nc", lambda p, f, a: f.update(change)))


@pytest.mark.parametrize(
    "change",
    [
        {"values": [0.0]},
        {"values": [1.0, 0.0, 0.5], "probabilities": [0.0, 0.5, 1.0]},
        {"probabilities": [2.0], "values": [0.0]},
        {"probabilities": [float("nan")], "values": [0.0]},
        {"threshold": float("nan")},
        {"threshold": "0.5"},
        {"prediction_time": 7.0},
    ],
    ids=str,
)
def test_alarms_that_are_none(change, saved, tmp_path):
    path, bad = saved / "analogues.nc", tmp_path / "bad.nc"
    refused(tampered(path, bad, lambda p, f, a: f["alarms"][0].update(change)))


@pytest.mark.parametrize(
    ("kind", "change"),
    [
        ("esn", {"neurons": 10**9}),
        ("esn", {"neurons": 61}),
        ("esn", {"neurons": -5}),
        ("esn", {"connectivity": 1e9}),
        ("esn", {"connectivity": float("nan")}),
        ("esn", {"connectivity": -1.0}),
        ("esn", {"readout": "pickle"}),
        ("esn", {"spectral_radius": "large"}),
        ("esn", {"seed": None}),
    ],
    ids=str,
)
def test_networks_that_the_arrays_do_not_hold(kind, change, saved, tmp_path):
    path, bad = saved / f"{kind}.nc", tmp_path / "bad.nc"
    refused(tampered(path, bad, lambda p, f, a: f["members"][0].update(change)))


@pytest.mark.parametrize("degree", [50, 10**6, 10**18])
def test_polynomials_that_the_arrays_do_not_hold(degree, saved, tmp_path):
    def change(parameters, fitted, arrays):
        parameters["options"] = {"degree": degree}

    refused(tampered(saved / "quadratic.nc", tmp_path / "bad.nc", change))


def test_arrays_that_are_missing_or_of_another_shape(saved, tmp_path):
    for change in (
        lambda p, f, a: a.clear(),
        lambda p, f, a: a.update(member0_weights=a["member0_weights"][:-1]),
        lambda p, f, a: a.update(member0_weights=a["member0_weights"] * np.nan),
        lambda p, f, a: a.update(member0_input_range=a["member0_input_range"][:1]),
    ):
        refused(tampered(saved / "esn.nc", tmp_path / "bad.nc", change))


def test_deeply_nested_json(saved, tmp_path):
    path = tampered(saved / "analogues.nc", tmp_path / "bad.nc", lambda *_: None)
    with netCDF4.Dataset(path, "a") as file:
        found = {name: file.getncattr(name) for name in ("event_forecaster", "parameters")}
        arrays = {name: np.asarray(variable[...]) for name, variable in file.variables.items()}
        attributes = {**found, "event_forecaster": 2, "fitted": "[" * 10**5}
        file.setncatts({**attributes, "digest": _digest(attributes, arrays)})
    assert "RecursionError" in refused(path)


def declared(path, **how):
    """A file of some kB that declares 745 GiB and has the right words beside them."""
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts({"event_forecaster": 2, "parameters": "{}", "fitted": "{}", "digest": "x"})
        file.createDimension("row", 10**11)
        file.createVariable("member0_training", "f8", ("row",), **how)
    return path


@pytest.mark.parametrize("how", [{"chunksizes": [1024]}, {"zlib": True, "chunksizes": [1024]}])
def test_a_file_that_declares_more_than_it_holds(how, tmp_path):
    path = declared(tmp_path / "large.nc", **how)
    assert path.stat().st_size < 1e6
    assert "is no plain array" in refused(path)


def test_types_that_are_no_numbers(tmp_path):
    path = tmp_path / "texts.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("row", 1)
        file.createVariable("member0_training", str, ("row",))[0] = "x"
    assert "is no plain array" in refused(path)


def test_a_pickle_is_no_forecaster(tmp_path):
    """What it would do is not done."""
    path, mark = tmp_path / "forecaster.nc", tmp_path / "mark"
    path.write_bytes(b"cos\nsystem\n(S'touch " + str(mark).encode() + b"'\ntR.")
    assert "is damaged" in refused(path)
    assert not mark.exists()


def test_a_system_of_the_package_is_loaded(saved):
    found = burstcast.EventForecaster.load(saved / "precursor.nc")
    assert found.observable == Lorenz63()

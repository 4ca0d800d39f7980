"""Files of event forecasters by whoever wrote them: nothing runs, nothing large is allocated."""

import json
import sys
import tracemalloc
from fractions import Fraction
from types import MappingProxyType

import netCDF4
import numpy as np
import pytest
from test_event_forecaster import fit, lorenz
from test_event_forecaster_classifiers import OPTIONS, settings

import burstcast
from burstcast.event_forecaster.files import _digest
from burstcast.systems.lorenz63 import Lorenz63

NAN = float("nan")
QUANTILE = {"event_threshold": {"quantile": 0.9}}
LEAKY = {"backend": "scipy", "readout": "quadratic", "leak_rate": [1, 0.6]}
KINDS = {
    "analogues": {},
    "esn": {"members": 2, "calibrate": False, "options": LEAKY},
    "nvar": {"options": {"lags": 3}},
    "quadratic": QUANTILE,
    "quadratic_filtered": {},
    **{kind: settings(kind) for kind in OPTIONS},
}


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """A fitted forecaster of each kind, and its file."""
    directory, training, forecasters = tmp_path_factory.mktemp("saved"), lorenz(6, 900, 1), {}
    for kind, changes in KINDS.items():
        forecasters[kind] = fit(training, **{"kind": kind, **changes}), directory / f"{kind}.nc"
        forecasters[kind][0].save(forecasters[kind][1])
    return forecasters


def tampered(path, target, change):
    """A copy with changed contents and the right digest."""
    with netCDF4.Dataset(path) as file:
        attributes = {name: file.getncattr(name) for name in file.ncattrs()}
        arrays = {name: np.asarray(variable[...]) for name, variable in file.variables.items()}
    parameters, fitted = (json.loads(attributes[name]) for name in ("parameters", "fitted"))
    fitted = change(parameters, fitted, arrays) or json.dumps(fitted)
    attributes = {"event_forecaster": 2, "parameters": json.dumps(parameters), "fitted": fitted}
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


@pytest.mark.parametrize("kind", KINDS)
def test_a_saved_forecaster_forecasts_the_same_bits(kind, saved, tested, tmp_path):
    forecaster, path = saved[kind]
    loaded = burstcast.EventForecaster.load(path)
    copied = burstcast.EventForecaster.load(tampered(path, tmp_path / "copy", lambda *_: None))
    assert loaded.get_params() == copied.get_params() == forecaster.get_params()
    seen = tested[:, :200]
    for time in (0.5, 1.0):
        expected = forecaster.predict_proba(seen, time)
        for forecaster_again in (loaded, copied):
            np.testing.assert_array_equal(forecaster_again.predict_proba(seen, time), expected)
    for time in forecaster.alarms_:
        expected = forecaster.scores(tested, time)
        assert loaded.scores(tested, time) == pytest.approx(expected, nan_ok=True)
    several = forecaster.scores(tested)
    assert len(forecaster.alarms_) == 1 or list(several) == list(forecaster.alarms_)
    if kind not in OPTIONS:  # classifiers have no trajectories
        np.testing.assert_array_equal(loaded.forecast(seen), forecaster.forecast(seen))
        loaded.save(tmp_path / "again.nc")
        assert (tmp_path / "again.nc").read_bytes() == path.read_bytes()
    for sample in seen[0, -40:]:
        loaded.update(sample)
    # sums over the points of a batch are rounded otherwise
    assert loaded.probability() == pytest.approx(forecaster.predict_proba(seen)[0, 1], rel=1e-12)


FORMS = [
    {"prediction_times": 1},
    {"prediction_times": (1, 1.0, 0.5)},
    {"prediction_times": range(1, 3)},
    {"prediction_times": np.array([0.5, 1.0])},
    {"prediction_times": np.float32(0.5), "window": Fraction(1, 2)},
    {"event_threshold": MappingProxyType({"quantile": np.float64(0.9)}), "observable": np.int8(0)},
    {"options": {"lags": np.int64(3)}, "calibrate": np.bool_(False), "case": "ä"},
    {"options": MappingProxyType({"ridge": Fraction(1, 1000)}), "random_seed": np.int64(3)},
    {"lyapunov_time": None, "washout": 20.0, "calibration_spacing": 5, "prediction_times": 20}
    | {"window": np.int32(9), "start_spacing": 10},
]
NETWORK_FORMS = [
    {"tikhonov": 1e-9},
    {"tikhonov": np.array([1e-9, 1e-9]), "grid": 2.0},
    {"spectral_radius": np.array([0.1, 1]), "input_scaling": [1, 10], "members": np.int64(1)},
    {"validation_series": 2, "intervals_per_series": 3.0, "neurons": Fraction(60)},
    {"options": {"backend": "scipy", "leak_rate": [np.float64(1), 0.5]}},
    {"options": {"backend": "scipy", "leak_rate": range(1, 2), "connectivity": np.float32(9)}},
]


@pytest.mark.parametrize(
    "parameters",
    [{"kind": "nvar", **form} for form in FORMS]
    + [{"members": 1, **form} for form in NETWORK_FORMS],
)
def test_what_can_be_fitted_can_be_loaded(parameters, tmp_path):
    forecaster = fit(lorenz(4, 500, 1), **parameters)
    forecaster.save(tmp_path / "saved.nc")
    loaded = burstcast.EventForecaster.load(tmp_path / "saved.nc")
    seen = lorenz(5, 200, 2)
    assert {type(time) for time in forecaster.alarms_} == {float}
    for time in forecaster.alarms_:
        expected = forecaster.predict_proba(seen, time)
        np.testing.assert_array_equal(loaded.predict_proba(seen, time), expected)
    # and saved again
    loaded.save(tmp_path / "again.nc")
    again = burstcast.EventForecaster.load(tmp_path / "again.nc")
    assert again.get_params() == loaded.get_params()


# -- observables that are no component -------------------------------------------------------------
@pytest.mark.parametrize("observable", [0, lambda states: states[..., 0], Lorenz63()])
def test_an_observable_that_is_given_is_that_of_the_fit(observable, training, tested, tmp_path):
    """A function is not saved but given again; a system of the package is found."""
    path, load = tmp_path / "forecaster.nc", burstcast.EventForecaster.load
    forecaster = fit(training, kind="persistence", observable=observable, **QUANTILE)
    forecaster.save(path)
    same = [observable]
    if callable(observable):
        with pytest.raises(ValueError, match="give it as load"):
            load(path)
    else:
        assert load(path).observable == observable
        same.append(None)
    if observable != Lorenz63():
        same += [0, lambda states: states.sum(axis=-1) - states[..., 1:].sum(axis=-1)]
    for given in same:
        time = next(iter(forecaster.alarms_))
        scores = load(path, given).scores(tested, time)
        assert scores == pytest.approx(forecaster.scores(tested, time), nan_ok=True)
    for other in (1, lambda states: states[..., 0] + 1e-6, lambda states: -states[..., 0]):
        with pytest.raises(ValueError, match=r"load was given differs from .*forecaster\.nc"):
            load(path, other)


# -- damage ----------------------------------------------------------------------------------------
def test_a_damaged_file_is_no_forecaster(saved, tmp_path):
    """A byte changed anywhere is found, or it is one that nobody reads."""
    damaged, seen = tmp_path / "damaged.nc", lorenz(5, 200, 2)
    forecaster, path = saved["analogues"]
    content, refusals = path.read_bytes(), 0
    expected = forecaster.forecast(seen, duration=0.1)
    for place in np.random.default_rng(29).choice(len(content), 50, replace=False):
        changed = bytearray(content)
        changed[place] ^= 0x10
        damaged.write_bytes(changed)
        try:
            loaded = burstcast.EventForecaster.load(damaged)
        except ValueError:
            refusals += 1
        else:
            np.testing.assert_array_equal(loaded.forecast(seen, duration=0.1), expected)
            assert loaded.get_params() == forecaster.get_params()
    assert refusals > 30


TEXTS = {"event_forecaster": 2, "parameters": "{}", "fitted": "{}"}


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({}, "holds no event forecaster"),
        ({"event_forecaster": 1}, "holds no event forecaster"),
        ({"event_forecaster": 2}, "holds no event forecaster"),
        ({"event_forecaster": [2, 2]}, "holds no event forecaster"),
        ({**TEXTS, "fitted": [1.5, 2]}, "is not what was saved"),
        ({**TEXTS, "digest": [1.5, 2]}, "is not what was saved"),
        (None, "is damaged"),
    ],
)
def test_another_file_is_no_forecaster(attributes, message, tmp_path):
    path, mark = tmp_path / "forecaster.nc", tmp_path / "mark"
    # a pickle, which would make the file
    path.write_bytes(b"cos\nsystem\n(S'touch " + str(mark).encode() + b"'\ntR.")
    if attributes is not None:
        with netCDF4.Dataset(path, "w") as file:
            file.setncatts(attributes)
    assert f"{path} {message}" in refused(path)
    assert not mark.exists()
    with pytest.raises(FileNotFoundError, match=r"another\.nc"):
        burstcast.EventForecaster.load(tmp_path / "another.nc")


@pytest.mark.parametrize(
    "how",
    [
        {"datatype": "f8", "chunksizes": [1024]},
        {"datatype": "f8", "chunksizes": [1024], "zlib": True},
        {"datatype": str},
    ],
    ids=str,
)
def test_arrays_that_lie_not_in_the_file_or_are_no_numbers(how, tmp_path):
    """A file of some kB may declare 745 GiB, and have the right words beside them."""
    path = tmp_path / "large.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts({**TEXTS, "digest": "x"})
        file.createDimension("row", 1 if how["datatype"] is str else 10**11)
        file.createVariable("member0_training", dimensions=("row",), **how)
    assert path.stat().st_size < 1e6
    assert "is no plain array" in refused(path)


# -- contents that nobody has saved, with the right digest -----------------------------------------
@pytest.mark.parametrize("name", ["this:X", "antigravity:X", "json.tool:main", "os.path:join"])
def test_a_module_that_a_file_names_is_not_imported(name, saved, tmp_path):
    def change(parameters, fitted, arrays):
        parameters["observable"] = {"system": name, "parameters": {}}

    before = set(sys.modules)
    message = refused(tampered(saved["analogues"][1], tmp_path / "bad.nc", change))
    assert f"names the system {name}, which is not one of burstcast's" in message
    assert name.partition(":")[0] not in set(sys.modules) - before


WRONG = {
    "parameters": {
        "kind": ["os", "../esn", "_filtered", "base", "json.tool:main", ["esn"]],
        "observable": [
            {"system": "../base", "parameters": {}},
            {"system": "lorenz63", "parameters": {"sigma": [1]}},
            *({"parameters": {}}, [[]], None),
        ],
        "nonsense": [1],
        "prediction_times": [3, [0.5], [0.5, 1e9]],
        "lyapunov_time": [-1],
        "sampling_interval": ["a"],
        "sampling_stride": [0, 10**9],
        "options": [[1], {"nonsense": 1}, {"neighbours": 10**9}],
        "tikhonov": [None],
        "washout": [1e9],
    },
    "fitted": {
        "event_threshold": [NAN, None],
        "components": [10**9, "x"],
        "reference_states": [[["a"]], []],
        "reference_observable": [None],
        "members": [[], [[]], 3],
        "alarms": [[], [{"prediction_time": 0.5}]],
        "stream": [
            {"latest": [[1.0]], "time": None},
            {"latest": [[1.0, 2.0, 3.0]], "time": "noon"},
            5,
        ],
    },
    "alarms": {
        # one knot for several probabilities, knots that do not rise, and chances that are none
        "values": [[0.0], [1.0, 0.0]],
        "probabilities": [[2.0, 2.0], [NAN, NAN]],
        "threshold": [NAN, "0.5"],
        "prediction_time": [7.0],
    },
    "members": {
        "neurons": [10**9, 61, -5],
        "connectivity": [1e9, NAN, -1.0],
        "readout": ["pickle"],
        "spectral_radius": ["large"],
        "seed": [None],
    },
}


@pytest.mark.parametrize(
    ("place", "name", "value"),
    [
        (place, name, value)
        for place, names in WRONG.items()
        for name, values in names.items()
        for value in values
    ],
    ids=str,
)
def test_what_nobody_has_saved_is_refused(place, name, value, saved, tmp_path):
    def change(parameters, fitted, arrays):
        if place == "alarms":  # two knots, to which one wrong thing is added
            fitted["alarms"][0] |= {"values": [0.0, 1.0], "probabilities": [0.0, 1.0]}
        whole = {"parameters": parameters, "fitted": fitted}
        (whole.get(place) or fitted[place][0])[name] = value

    _, path = saved["esn" if place == "members" else "analogues"]
    refused(tampered(path, tmp_path / "bad.nc", change))


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        *(("quadratic", {"degree": degree}) for degree in (50, 10**6, 10**18)),
        *(("nvar", {"lags": lags}) for lags in (6, 10**4, 10**18)),
    ],
)
def test_polynomials_that_the_arrays_do_not_hold(kind, options, saved, tmp_path):
    def change(parameters, fitted, arrays):
        parameters["options"] = options

    refused(tampered(saved[kind][1], tmp_path / "bad.nc", change))


@pytest.mark.parametrize(
    "change",
    [
        lambda p, f, a: a.clear(),
        lambda p, f, a: a.update(member0_weights=a["member0_weights"][:-1]),
        lambda p, f, a: a.update(member0_weights=a["member0_weights"] * np.nan),
        lambda p, f, a: a.update(member0_input_range=a["member0_input_range"][:1]),
        lambda p, f, a: a.update(member0_input_offset=a["member0_input_offset"][:1]),
    ],
)
def test_arrays_that_are_missing_or_of_another_shape(change, saved, tmp_path):
    refused(tampered(saved["esn"][1], tmp_path / "bad.nc", change))


@pytest.mark.parametrize("kind", ["analogues", "quadratic", "nvar"])
def test_files_without_an_array_are_refused(kind, saved, tmp_path):
    def change(parameters, fitted, arrays):
        arrays.pop(next(iter(arrays)))

    refused(tampered(saved[kind][1], tmp_path / "bad.nc", change))


def test_deeply_nested_json(saved, tmp_path):
    path = tampered(saved["analogues"][1], tmp_path / "bad.nc", lambda *_: "[" * 10**5)
    assert "RecursionError" in refused(path)

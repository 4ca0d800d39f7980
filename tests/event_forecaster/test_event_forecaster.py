"""The library's face in a notebook: `burstcast.EventForecaster`."""

import dataclasses
import math
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
import xarray
from numpy.testing import assert_array_equal
from threadpoolctl import threadpool_info, threadpool_limits

import burstcast
from burstcast.data.delay_coordinates import delay_coordinates
from burstcast.data.series_layout import labelled_series
from burstcast.event_forecaster.forecaster import DURATIONS
from burstcast.forecasters.base import fitted as fitted_field
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasters.nvar import NVAR
from burstcast.forecasters.persistence import Persistence
from burstcast.forecasts.scores import ratio
from burstcast.statistics.neighbour_divergence import neighbour_divergence
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63

LYAPUNOV_TIME = 1 / 0.9056


def as_series(data):
    return labelled_series(data).states


SMALL = {
    "observable": 0,
    "event_threshold": 12.0,
    "prediction_times": (0.5, 1.0),
    "lyapunov_time": LYAPUNOV_TIME,
    "sampling_interval": 0.02,
    "members": 3,
    "neurons": 60,
    "grid": 2,
    "bayesian_points": 0,
    "options": {"backend": "scipy"},
}


def lorenz(series, steps, seed):
    start = np.array([[1.0, 1.0, 20.0]] * series).T
    start += np.random.default_rng(seed).uniform(-5, 5, start.shape)
    states = integrate(Lorenz63(), start, 0.01, 2 * steps + 1000, stride=2)
    return states[501:].transpose(2, 0, 1)


def fit(series, **changes):
    """A small forecaster with changed parameters: networks, or a kind that takes no options."""
    plain = {} if changes.get("kind", "esn") == "esn" else {"options": None}
    return burstcast.EventForecaster(**{**SMALL, **plain, **changes}).fit(series)


@pytest.fixture(scope="module")
def fitted(training):
    return fit(training)


# -- habits ----------------------------------------------------------------------------------------
def test_parameters_are_set_by_name_and_the_repr_has_those_that_differ():
    forecaster = burstcast.EventForecaster(neurons=50)
    assert forecaster.set_params(neurons=70, members=2) is forecaster
    assert (forecaster.neurons, forecaster.members) == (70, 2)
    with pytest.raises(ValueError, match=r"no parameter 'neuron' \(did you mean 'neurons'\?\)"):
        forecaster.set_params(members=3, neuron=1)
    assert repr(forecaster) == "EventForecaster(members=2, neurons=70)"


# -- the layout ------------------------------------------------------------------------------------
def test_series_are_found_by_the_names_of_dimensions_and_columns():
    data = np.arange(24.0).reshape(2, 3, 4)
    array = xarray.DataArray(data, dims=("series", "time", "component"))
    turned = array.transpose("time", "component", "series")
    frames = [pd.DataFrame(states, columns=[*"wxyz"]).convert_dtypes() for states in data]
    timed = [frame.assign(time=pd.date_range("2020", periods=3)) for frame in frames]
    for form in (
        *(turned, turned.to_dataset("component"), turned.assign_coords(time=[0.0, 0.1, 0.2])),
        turned.assign_coords(time=pd.date_range("2020", periods=3)),
        *(frames, [frames[0], frames[1][[*"zxyw"]]], [timed[0], timed[1].set_index("time")]),
    ):
        assert_array_equal(as_series(form), data)
    assert_array_equal(as_series(turned.sel(series=1, component=2)), data[1:, :, 2:3])
    assert_array_equal(as_series(frames[0]), data[:1])
    with pytest.raises(ValueError, match="have different components: w, x, y, z and x, y"):
        as_series([frames[0], frames[1][[*"xy"]]])
    for falling in (turned.assign_coords(time=[0.2, 0.1, 0.0]), [timed[0][::-1]]):
        with pytest.raises(ValueError, match="times must rise"):
            as_series(falling)
    frames[1].iloc[1, 2] = pd.NA
    with pytest.raises(ValueError, match="series 1 is nan at step 1, component 2"):
        as_series(frames)


NO_SERIES = {
    ValueError: [
        (np.zeros((5, 3)), r"not \(5, 3\): a single series is series\[np.newaxis\]"),
        (np.zeros(5), r"not \(5,\): a single series is series\[np.newaxis, :, np.newaxis\]"),
        (np.zeros((0, 5, 3)), "empty"),
        (np.array([[[0.0], [np.nan]]]), "series 0 is nan at step 1, component 0"),
        (xarray.DataArray(np.zeros((1, 2)), dims=("run", "time")), r"has c1 \(run, time\): rename"),
        ([np.zeros((5, 1)), np.zeros((4, 2))], r"\(time, component\) with the same components"),
        ([np.zeros((5, 1)), np.zeros((0, 1))], "series 1 has no sample"),
        ([np.zeros((5, 1)), np.full((4, 1), np.nan)], "series 1 is nan at step 0, component 0"),
    ],
    TypeError: [
        ([[["1.5"]]], "must consist of real numbers"),
        (np.full((1, 2, 3), 1 + 0j), "must consist of real numbers"),
        (np.full((1, 2, 3), 1.0, dtype=object), "must consist of real numbers"),
        (np.zeros((1, 2, 3), "M8[s]"), "must consist of real numbers"),
        ([[[1.0], [2.0, 3.0]]], "must consist of real numbers"),
    ],
}


@pytest.mark.parametrize(
    ("error", "data", "message"),
    [(error, *row) for error, rows in NO_SERIES.items() for row in rows],
)
def test_other_layouts_and_what_is_no_array_of_numbers_are_refused(error, data, message):
    with pytest.raises(error, match=message):
        as_series(data)


RESAMPLED = {"resamples": 9, "confidence": 0.9}
NOT_WRITTEN = 9.969209968386869e36
"""What netCDF stores where nothing was written, which lies below the masks of netCDF4."""


@pytest.mark.parametrize(
    "convert", [np.ma.asarray, list, lambda data: [list(series) for series in data], np.asarray]
)
def test_masked_series_are_refused(convert, fitted):
    """Of `list`, masked arrays in lists; of `asarray`, what numpy's functions leave of a mask."""
    data = np.ma.array(lorenz(2, 300, 3))
    assert_array_equal(as_series(convert(data)), data.data)
    data[1, 290, 2] = np.ma.masked
    data.data[1, 290, 2] = NOT_WRITTEN
    message = r"\[1, 290, 2\] is \(1 in all\)|series 1 is 9.96921e\+36 at step 290, component 2"
    for call in (as_series, fitted.fit, fitted.predict, fitted.forecast, fitted.scores):
        with pytest.raises(ValueError, match=message):
            call(convert(data))


@pytest.mark.parametrize("value", [1j, np.ma.masked, "1.0"])
def test_an_observable_must_be_a_real_number(value, training):
    def observable(states):
        values = np.ma.array(states[..., 0], dtype=type(value) if value == 1j else object)
        values[...] = value
        return values if value is not np.ma.masked else np.ma.masked_all(values.shape)

    with pytest.raises(
        (TypeError, ValueError), match=r"the observable must (not be masked|consist)"
    ):
        fit(training, observable=observable)


def test_functions_for_notebooks_refuse_the_same():
    masked, generator = np.ma.masked_all((2, 9, 1)), np.random.default_rng(0)
    with pytest.raises(ValueError, match="the series must not be masked"):
        delay_coordinates(masked, [1])
    with pytest.raises(ValueError, match="the series must not be masked"):
        neighbour_divergence(masked, 0.1, generator, **RESAMPLED)


@pytest.mark.parametrize(
    ("value", "interval", "message"),
    [
        (None, 0.0, "sampling interval must be positive, not 0"),
        (1.0, 0.1, "no component of the series may be"),
        (np.nan, 0.1, "must be finite"),
    ],
)
def test_what_says_nothing_of_an_exponent_is_refused(value, interval, message):
    generator = np.random.default_rng(0)
    series = generator.normal(size=(1, 99, 2))
    if value is not None:
        series[:, :, 1] = value
    with pytest.raises(ValueError, match=message):
        neighbour_divergence(series, interval, generator, **RESAMPLED)


# -- forecasts and probabilities -------------------------------------------------------------------
def test_probabilities_are_those_of_votes_calibrated(fitted, tested):
    seen = tested[:, :300]
    for time in (0.5, 1.0):
        start, end = (int(duration * LYAPUNOV_TIME / 0.02) for duration in (time, time + 1))
        value = fitted.forecast(seen)[..., 0]
        before, after = value[:, :, start - 1], value[:, :, start - 1 : end].max(axis=2)
        votes = ((before < 12) & (after >= 12)).mean(axis=0)
        alarm = fitted.alarms_[time]
        probability = np.interp(votes, alarm.calibration.values, alarm.calibration.probabilities)
        probabilities = fitted.predict_proba(seen, time)
        np.testing.assert_allclose(probabilities[:, 1], probability, rtol=1e-12)
        np.testing.assert_allclose(probabilities.sum(axis=1), 1, rtol=1e-15)
        assert_array_equal(fitted.predict(seen, time), probability >= alarm.threshold)
    assert_array_equal(fitted.classes_, [False, True])


def test_scores_are_those_of_alarms_counted_one_by_one(fitted, tested):
    unit, washout = int(LYAPUNOV_TIME / 0.02), int(0.5 * LYAPUNOV_TIME / 0.02)
    start, end = unit // 2, int(1.5 * LYAPUNOV_TIME / 0.02)
    hits = alarms = events = forecasts = 0
    for series in tested:
        for now in range(washout - 1, len(series) - 2 * unit, unit):  # the end of the last window
            if series[now - washout + 1 : now + 1, 0].max() >= 12:
                continue
            window = series[now + start : now + end + 1, 0]
            event = window[0] < 12 <= window.max()
            alarm = fitted.predict(series[np.newaxis, : now + 1])[0]
            forecasts, events, alarms = forecasts + 1, events + event, alarms + alarm
            hits += event and alarm
    scores = fitted.scores(tested, next(iter(fitted.alarms_)))
    assert 5 < events < forecasts
    assert (scores["forecasts"], scores["events"]) == (forecasts, events)
    assert scores["alarm_recall"] == pytest.approx(hits / events)
    assert scores["alarm_precision"] == pytest.approx(float(ratio(hits, alarms)), nan_ok=True)
    assert fitted.score(tested) == pytest.approx(2 * hits / (alarms + events))


def test_test_series_without_an_event_are_named(fitted, tested):
    unit = int(LYAPUNOV_TIME / 0.02)
    pieces = tested[:, : 3 * unit]
    time = next(iter(fitted.alarms_))
    quiet = [n for n in range(len(pieces)) if not fitted.outcomes(pieces[n : n + 1], time)[0].any()]
    with pytest.warns(
        UserWarning, match=r"no event follows any of the \d+ starting points"
    ) as told:
        scores = fitted.scores(pieces[quiet], time)
    assert f"{scores['forecasts']} starting" in str(told[0].message)
    assert "event_threshold (12)" in str(told[0].message)
    assert scores["events"] == 0
    assert np.isnan([scores["alarm_recall"], scores["brier_skill"]]).all()


@pytest.mark.parametrize(("kind", "sees_truth"), [("quadratic", False), ("equations", True)])
def test_noise_is_added_to_what_is_observed(kind, sees_truth, training, tested):
    changes = {"observable": Lorenz63(), "event_threshold": {"quantile": 0.9}, "calibrate": False}
    changes |= {"kind": kind, "sampling_stride": 2}
    plain, noisy = (fit(training, noise=noise, **changes) for noise in (0.0, 0.1))
    seen = tested[:, :200]
    assert np.array_equal(plain.forecast(seen), noisy.forecast(seen)) == sees_truth


def test_options_are_laid_over_the_defaults_of_the_kind(training):
    options = {"connectivity": 3, "input_bias": 1, "backend": "scipy", "leak_rate": [0.6]}
    (member,) = fit(training, members=1, options=options).members_
    reservoir = member.network.dynamics.reservoir
    assert 2 < reservoir.recurrent.nnz / 60 < 4
    assert reservoir.input_bias == 1
    assert member.divergence_bound == NetworkForecaster().divergence_bound
    dynamics = member.network.dynamics
    assert (dynamics.readout, dynamics.leak_rate) == ("quadratic", 0.6)


def test_networks_without_a_search_of_their_own_take_the_others_hyperparameters(training):
    alone = fit(training, calibrate=False)
    shared = fit(training, calibrate=False, searches=2)
    first, second, third = alone.hyperparameters_
    assert first != third
    assert shared.hyperparameters_ == [first, second, first]
    for member, shared_member in zip(alone.members_[:2], shared.members_[:2], strict=True):
        assert_array_equal(member.network.readout.weights, shared_member.network.readout.weights)
    last = shared.members_[2]
    assert last.seed == alone.members_[2].seed  # a reservoir of its own
    assert last.network.dynamics.spectral_radius == first["spectral_radius"]
    assert last.network.readout.tikhonov == first["tikhonov"]


@dataclasses.dataclass(frozen=True)
class ThreadsOfFit(Persistence):
    """Persistence that keeps how many threads libraries have in `fit`."""

    threads: int = fitted_field()

    def fit(self, training, case):
        return self.with_fitted(threads=max(pool["num_threads"] for pool in threadpool_info()))


def test_one_thread_fits(training):
    with threadpool_limits(limits=2):
        assert max(pool["num_threads"] for pool in threadpool_info()) == 2
        forecaster = fit(training, kind=ThreadsOfFit)
        assert max(pool["num_threads"] for pool in threadpool_info()) == 2
    assert [member.threads for member in forecaster.members_] == [1]


def test_durations_are_in_samples_without_a_lyapunov_time(training, fitted):
    unit = int(LYAPUNOV_TIME / 0.02)
    in_samples = {
        name: int(default * LYAPUNOV_TIME / 0.02) for name, (default, _) in DURATIONS.items()
    }
    times = tuple(int(time * LYAPUNOV_TIME / 0.02) for time in (0.5, 1.0))
    in_sample_units = fit(training, lyapunov_time=None, prediction_times=times, **in_samples)
    assert unit == 55
    for member, expected in zip(in_sample_units.members_, fitted.members_, strict=True):
        assert_array_equal(member.network.readout.weights, expected.network.readout.weights)


# -- mistakes --------------------------------------------------------------------------------------
MISTAKES = {
    ValueError: [
        ({"lyapunov_time": None}, "is 0.5, which is 0 samples; .* unless lyapunov_time"),
        ({"searches": 0}, "searches must be 1 at least, not 0"),
        ({"observable": "z"}, "observable is 'z', but the series have no labels"),
        ({"observable": lambda s: s[0]}, r"must make \(\.\.\.\) of states \(\.\.\., component\)"),
        ({"kind": "equations", "options": None}, "measured series have no equations"),
        ({"lyapunov_time": -1.0}, "lyapunov_time must be positive"),
        ({"prediction_times": ()}, "one entry at least"),
        ({"prediction_times": (0.001,)}, "a prediction time is 0.001, which is 0 samples"),
        ({"window": 0.001}, "not a single sample"),
        ({"washout": 17.0}, "of 900 samples leave no room for a washout of 935 steps"),
        ({"event_threshold": 1e3}, "no event to learn from"),
        ({"grid": 0}, "grid must be 1 at least, not 0"),
        ({"noise": -0.1}, "noise must be 0 at least, not -0.1"),
        ({"event_threshold": {"quantil": 0.9}}, "a number or {'quantile': q}"),
        ({"event_threshold": {"quantile": 1.5}}, "a quantile lies between 0 and 1, not at 1.5"),
        ({"observable": 3}, "observable is component 3, but the series have 3: 0 to 2"),
        ({"kind": "ens"}, "unknown kind of forecaster 'ens'"),
        ({"validation": "RVV"}, "unknown validation strategy"),
        ({"members": 0}, "members must be 1 at least"),
        ({"options": {"conectivity": 3}}, r"no option 'conectivity' \(did you mean 'connectivity'"),
        ({"intervals_per_series": 99}, "99 validation intervals"),
        ({"washout": math.inf}, "washout must be finite"),
        ({"prediction_times": (1.0, math.inf)}, "prediction_times must be finite"),
        ({"noise": math.nan}, "noise must be finite"),
        ({"calibration_spacing": 1e20}, "calibration_spacing must be finite, and below"),
        ({"sampling_stride": 0}, "sampling_stride must be 1 at least, not 0"),
        ({"kind": NVAR(lags=3)}, "options are those of the forecaster that kind is"),
    ],
    TypeError: [
        ({"observable": None}, "observable must be the number of a component"),
        ({"neurons": 30.5}, "neurons must be a whole number, not 30.5"),
        ({"neurons": "30"}, "neurons must be a whole number, not '30'"),
        ({"members": None}, "members must be a whole number, not None"),
        ({"grid": float("nan")}, "grid must be a whole number, not nan"),
        ({"window": "1"}, "window must be a number, not '1'"),
        ({"lyapunov_time": True}, "lyapunov_time must be a number, not True"),
        ({"prediction_times": ("1", 2)}, "prediction_times must be a number, not '1'"),
        ({"spectral_radius": 0.5}, r"spectral_radius must be two numbers, \(low, high\), not 0.5"),
        ({"kind": 3}, "a class of forecasters or a forecaster, not 3"),
        ({"kind": dict}, "kind must be the name of a kind, a class of .* not <class 'dict'>"),
        ({"event_threshold": "high"}, "event_threshold must be a number, not 'high'"),
    ],
}


@pytest.mark.parametrize(
    ("error", "change", "message"),
    [(error, *row) for error, rows in MISTAKES.items() for row in rows],
)
def test_a_mistake_is_told_by_the_parameters_name(error, change, message, training):
    with pytest.raises(error, match=message):
        burstcast.EventForecaster(**{**SMALL, **change}).fit(training)


def test_what_cannot_be_done_is_said(training, fitted, tested):
    with pytest.raises(ValueError, match=r"leaves out one 5th of a single series .* or calib"):
        burstcast.EventForecaster(**SMALL).fit(training[:1, :600])
    unfitted = burstcast.EventForecaster()
    calls = [lambda call=call: call(tested) for call in (unfitted.predict, unfitted.update)]
    for call in (*calls, unfitted.rule):
        with pytest.raises(RuntimeError, match="not fitted yet"):
            call()
    with pytest.raises(ValueError, match="do not know the parameters: leave them out"):
        fitted.what_if(tested[:, :200], {"push": {"reynolds": 400.0}})
    with pytest.raises(ValueError, match=r"fitted were the prediction_times 0\.5, 1"):
        fitted.predict(tested, 2.0)
    with pytest.raises(ValueError, match=r"time of an observation must be a finite number, in the"):
        fitted.update(tested[0, 0], np.datetime64("2020-01-01"))
    with pytest.raises(ValueError, match="have 2 components, the training series had 3"):
        fitted.predict(tested[..., :2])


# -- what importing costs --------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("import burstcast", {"numpy", "scipy", "burstcast_workflow"}),
        (
            "import burstcast; burstcast.EventForecaster()",  # without what only a fit needs
            {"skopt", "sklearn", "pandas", "matplotlib", "netCDF4", "llvmlite"},
        ),
    ],
)
def test_importing_burstcast_loads_nothing_that_is_not_needed(code, absent):
    timed = f"start = time.process_time(); {code}; print(time.process_time() - start, *sys.modules)"
    command = [sys.executable, "-c", f"import sys, time; {timed}"]
    output = subprocess.run(command, capture_output=True, text=True, check=True)
    seconds, *modules = output.stdout.split()
    assert "numpy" in modules or float(seconds) < 0.3  # it takes 0.001 s
    assert not absent & set(modules)
    assert "EventForecaster" in dir(burstcast)
    with pytest.raises(AttributeError, match="has no attribute 'Forecaster'"):
        _ = burstcast.Forecaster

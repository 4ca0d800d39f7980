"""What series, times and parameters say to a forecaster is heard, or refused."""

import re
import sys
import threading
import time
import warnings
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray
from test_event_forecaster import lorenz
from threadpoolctl import threadpool_info

from burstcast.base.threads import single_threaded
from burstcast.event_forecaster import progress
from burstcast.event_forecaster.committee import search_edges
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.event_forecaster.shared_rows import MOST_REFITS, shared_rows
from burstcast.systems.lorenz63 import Lorenz63
from helpers_library import said_by

ROOT = Path(__file__).parents[2]

SERIES = lorenz(8, 700, 1)
SECONDS = 0.02 * np.arange(SERIES.shape[1])
pytestmark = pytest.mark.filterwarnings("ignore:signs of a weak forecaster")


def forecaster(**changes):
    given = {"observable": 2, "event_threshold": 35.0, "kind": "analogues", "window": 1.0}
    given |= {"lyapunov_time": 1.1, "sampling_interval": 0.02, "prediction_times": (0.5,)}
    return EventForecaster(**{**given, **changes})


def frames(series=SERIES, index=None):
    return [pd.DataFrame(states, columns=[*"xyz"], index=index) for states in series]


# -- units of time ---------------------------------------------------------------------------------
TEN_MINUTES = pd.date_range("2020-01-01", periods=SERIES.shape[1], freq="10min")


@pytest.mark.parametrize(
    ("interval", "lyapunov_time"),
    [
        (1 / 6, 9),  # hours
        (10, 540),  # minutes
        (pd.Timedelta("10min"), pd.Timedelta("9h")),
        ("10 minutes", "9 hours"),
        (np.timedelta64(600, "s"), "0.375 days"),
        (TEN_MINUTES.freq, "9h"),
    ],
)
def test_dates_are_compared_with_the_sampling_interval(interval, lyapunov_time, tmp_path):
    given = frames(index=TEN_MINUTES)
    made = forecaster(sampling_interval=interval, lyapunov_time=lyapunov_time).fit(given[:6])
    plain = forecaster(sampling_interval=1 / 6, lyapunov_time=9).fit(SERIES[:6])
    expected = plain.predict_proba(SERIES[6:])
    np.testing.assert_array_equal(made.predict_proba(given[6:]), expected)
    made.save(tmp_path / "f.nc")
    loaded = EventForecaster.load(tmp_path / "f.nc")
    np.testing.assert_array_equal(loaded.predict_proba(given[6:]), expected)
    for row in (*given[6][:30].iterrows(),):
        loaded.update(row[1])
    assert loaded.probability() == loaded.predict_proba([given[6][:30]])[0, 1]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"sampling_interval": 1.0},
            "are 10 minutes apart, but sampling_interval is 1, in no unit",
        ),
        ({"sampling_interval": 0.2}, "sampling_interval='10 minutes' and lyapunov_time with its"),
        (
            {"sampling_interval": pd.Timedelta("1h"), "lyapunov_time": "9 hours"},
            "are 600 seconds apart, but sampling_interval is 3600 seconds",
        ),
        ({"sampling_interval": "10 minutes"}, "give both with a unit, or both as numbers of one"),
        *(
            ({"sampling_interval": text}, f"sampling_interval is {text}, which is no duration")
            for text in ("10 months", "600", "-10min", "0 minutes", "NaT", "ten", "1 minute 30")
        ),
        ({"lyapunov_time": "nan"}, "lyapunov_time is nan, which is no duration"),
        ({"sampling_interval": pd.offsets.MonthEnd()}, "MonthEnd>, which is no duration"),
    ],
)
def test_other_units_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        forecaster(**{"lyapunov_time": 9, **changes}).fit(frames(index=TEN_MINUTES))


def test_computed_prediction_times_are_typed_ones():
    made = forecaster(prediction_times=np.arange(0.1, 0.41, 0.1)).fit(SERIES[:6])
    at = made.predict_proba(SERIES[6:], 0.3)
    np.testing.assert_array_equal(at, made.predict_proba(SERIES[6:], 3 * 0.1))
    with pytest.raises(ValueError, match=r"fitted were the prediction_times 0\.1, 0\.2"):
        made.predict_proba(SERIES[6:], 0.31)


# -- a stream --------------------------------------------------------------------------------------
ROWS = [*range(100, 150), *range(400, 413)]


@pytest.mark.parametrize("form", ["dates", "durations", "rows", "xarray", "time", "dictionaries"])
def test_times_that_rows_carry_tell_gaps(form):
    index = {
        "dates": pd.Timestamp("2020-01-01") + pd.to_timedelta(SECONDS, unit="s"),
        "durations": pd.to_timedelta(SECONDS, unit="s"),
        "time": pd.Timestamp("2020-01-01") + pd.to_timedelta(SECONDS, unit="s"),
    }.get(form)
    given = frames(index=index)
    made = forecaster().fit(given[:6])
    table = given[7]
    array = xarray.DataArray(SERIES[7], dims=("time", "component"), coords={"time": SECONDS})
    array = array.assign_coords(component=[*"xyz"])

    def update(place):
        if form == "xarray":
            return made.update(array[place])
        if form == "dictionaries":
            return made.update({"time": SECONDS[place], **table.iloc[place].to_dict()})
        if form == "time":
            return made.update(table.iloc[place].to_numpy(), time=index[place])
        return made.update(table.iloc[place])

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        for place in ROWS:
            update(place)
    (text,) = [str(one.message) for one in told]
    assert text.startswith("row 400 does" if form == "rows" else "no observation came between")
    assert np.isnan(made.probability())
    for place in range(413, 430):
        update(place)
    assert made.probability() == made.predict_proba(SERIES[7:, :430])[0, 1]
    if form == "rows":  # another table
        with pytest.warns(UserWarning, match="row 428 does not follow row 429: the washout"):
            update(428)
        return
    with pytest.raises(ValueError, match="cannot follow one at time"):
        update(428)


def test_dates_of_a_stream_need_an_interval_with_a_unit():
    made = forecaster().fit(SERIES[:6])
    with pytest.raises(ValueError, match="the training series had no dates: for dates, give samp"):
        made.update(SERIES[7, 0], time=pd.Timestamp("2020-01-01"))
    made.update(SERIES[7, 0], time=0.0)
    with pytest.raises(ValueError, match=r"must be a finite number.* or a date, not 'now'"):
        made.update(SERIES[7, 1], time="now")


# -- parameters after the fit ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("window", 3.0),
        ("lyapunov_time", 2.2),
        ("sampling_interval", 0.04),
        ("observable", 0),
        ("prediction_times", (2.0,)),
        ("event_threshold", 36.0),
        ("kind", "quadratic"),
        ("washout", 1.0),
    ],
)
def test_a_fitted_forecaster_has_the_parameters_of_its_fit(name, value, tmp_path):
    made = forecaster().fit(SERIES[:6])
    expected = made.predict_proba(SERIES[6:])
    made.set_params(**{name: value})
    for call in (
        *(made.predict_proba, made.predict, made.forecast, made.scores, made.outcomes, made.score),
        lambda series: made.update(series[0, 0]),
        lambda series: made.probability(),
        lambda series: made.rule(),
    ):
        with pytest.raises(ValueError, match=f"{name} was .* in fit, and is .* now: call fit"):
            call(SERIES[6:])
    with pytest.warns(UserWarning, match=f"saved is what was fitted: {name} was"):
        made.save(tmp_path / "f.nc")
    saved = EventForecaster.load(tmp_path / "f.nc")
    np.testing.assert_array_equal(saved.predict_proba(SERIES[6:]), expected)
    assert getattr(saved, name) != value
    made.set_params(**{name: getattr(saved, name), "start_spacing": 2.0})
    np.testing.assert_array_equal(made.predict_proba(SERIES[6:]), expected)


def test_equal_parameters_are_no_change():
    made = forecaster(prediction_times=[0.5], event_threshold={"quantile": 0.9}).fit(SERIES[:6])
    made.set_params(prediction_times=(0.5,), event_threshold={"quantile": 0.9}, washout=None)
    made.predict(SERIES[6:])
    made.event_threshold["quantile"] = 0.8  # in place
    with pytest.raises(ValueError, match=r"event_threshold was \{'quantile': 0\.9\} in fit"):
        made.predict(SERIES[6:])


# -- series that share rows ------------------------------------------------------------------------
RECORD = lorenz(1, 2400, 4)[0]


def windows(step, length=400):
    return [RECORD[first : first + length] for first in range(0, 2401 - length, step)]


@pytest.mark.parametrize("step", [200, 40])
@pytest.mark.parametrize("order", ["in turn", "shuffled"])
def test_overlapping_windows_calibrate_as_disjoint_ones(step, order):
    given = windows(step)
    disjoint = forecaster().fit(np.stack(windows(400)))
    if order == "shuffled":  # longest first, then in their order: other windows may be chosen
        given = [*windows(400), *[w for n, w in enumerate(given) if n * step % 400]]
    made = forecaster().fit(np.stack(given))
    assert any("share rows with other series" in text for text in made.warnings_)
    for votes in (0.0, 0.5, 1.0):
        at = [f.rule().calibration(np.array([votes])) for f in (made, disjoint)]
        assert at[0] == at[1]
    assert not any("share rows" in text for text in disjoint.warnings_)


def test_one_series_many_times_is_one_series():
    many = forecaster().fit(np.stack([RECORD] * 6))
    once = forecaster().fit(RECORD[np.newaxis])
    assert "6 of 6 series share rows with other series (100% of all rows)" in many.warnings_[0]
    assert many.warnings_[1:] == once.warnings_
    np.testing.assert_array_equal(many.predict_proba(SERIES), once.predict_proba(SERIES))


@pytest.mark.parametrize("kind", ["analogues", "precursor"])
def test_series_that_overlap_in_part_are_left_out_together(kind, monkeypatch):
    """Disjoint ones leave many rows out, so that all are trained on."""
    given = np.stack(windows(240))
    shared = shared_rows(list(given))
    assert (shared.linked.sum(axis=1) >= 2).all()
    assert len(shared.needed) == len(given)
    for forecast, rows in shared.left_out():
        taken = {tuple(row) for series in given[forecast] for row in series}
        kept = np.delete(given, rows, axis=0).reshape(-1, 3)
        assert not taken & set(map(tuple, kept))
    made = forecaster(kind=kind).fit(given)
    assert "are left out together" in made.warnings_[0]


def test_equal_values_of_rounded_series_are_no_shared_rows():
    generator = np.random.default_rng(0)
    rain = np.maximum(0, generator.normal(size=(12, 500, 1))).round(0)
    cycle = np.tile(np.sin(2 * np.pi * np.arange(10) / 10)[:, np.newaxis], (50, 1))
    for series in (rain, np.zeros((3, 100, 1)), np.stack([cycle] * 1), SERIES):
        assert not shared_rows(list(series)).count
    unrelated = shared_rows(list(generator.normal(size=(5, 200, 2))))
    assert (unrelated.covered, unrelated.share) == (1.0, 0.0)
    assert np.array_equal(unrelated.linked, np.eye(5))


def test_many_series_take_few_refits():
    many = shared_rows(list(np.random.default_rng(0).normal(size=(80, 30, 1))))
    folds = many.left_out()
    assert len(folds) == MOST_REFITS
    assert sorted(row for fold in folds for row in fold.forecast) == [*range(80)]
    assert shared_rows(list(SERIES)).left_out() is None


def test_series_that_all_share_rows_cannot_be_left_out():
    with pytest.raises(ValueError, match="all 3 series share rows, so that none can be left out"):
        shared_rows([RECORD[:400], RECORD[200:600], RECORD[150:450]]).left_out()


# -- columns and thresholds ------------------------------------------------------------------------


def test_columns_that_are_no_state_are_told_by_name():
    plain = forecaster(observable="z").fit(frames()[:6])
    assert not any("no component" in text for text in plain.warnings_)
    with_columns = [
        table.assign(
            run=number,
            timestamp=1.7e9 + 600 * np.arange(len(table)),
            hour=np.arange(len(table)) // 6 % 24,
        )
        for number, table in enumerate(frames())
    ]
    made = forecaster(observable="z").fit(with_columns[:6])
    assert made.warnings_[0].startswith("run is constant in each series")
    assert made.warnings_[1].startswith("timestamp is rising")
    assert made.warnings_[2].startswith("hour is rising in equal steps and then starting again")
    as_told = [table.drop(columns=["run", "timestamp", "hour"]) for table in with_columns]
    np.testing.assert_array_equal(
        forecaster(observable="z").fit(as_told[:6]).predict_proba(as_told[6:]),
        plain.predict_proba(frames()[6:]),
    )


def test_labels_of_a_system_are_in_its_order():
    def made(columns):
        given = [table[[*columns]] for table in frames()]
        return forecaster(observable=Lorenz63(), event_threshold=20.0).fit(given[:6])

    np.testing.assert_array_equal(
        made("xyz").predict_proba(SERIES[6:]), made("xyz").predict_proba(frames()[6:])
    )
    with pytest.raises(ValueError, match=r"components z, y, x, but .* the order x, y, z: bring"):
        made("zyx")
    plain = forecaster(observable=Lorenz63(), event_threshold=20.0).fit(SERIES[:6])
    with pytest.raises(ValueError, match=r"components z, y, x, but .* the order x, y, z: bring"):
        plain.predict_proba([table[[*"zyx"]] for table in frames()[6:]])


def test_labels_that_training_had_not_are_warned_of():
    made = forecaster(observable=2).fit(SERIES[:6])
    with pytest.warns(UserWarning, match="have the labels z, y, x, and the training series had no"):
        made.predict_proba([table[[*"zyx"]] for table in frames()[6:]])


def test_quantiles_on_tied_values_name_the_tie():
    rain = SERIES.copy()
    rain[..., 2] = np.maximum(rain[..., 2] - 30, 0)
    dry = (rain[..., 2] == 0).mean()
    message = rf"is 0, the lowest value, which {dry:.0%} of the samples have; give a number above"
    with pytest.raises(ValueError, match=message):
        forecaster(event_threshold={"quantile": 0.5}).fit(rain)
    saturated = np.minimum(SERIES, 33)
    with pytest.raises(ValueError, match=r"is 33, the highest value, .* as event_threshold: 33"):
        forecaster(event_threshold={"quantile": 0.97}).fit(saturated)
    assert forecaster(event_threshold=33.0).fit(saturated).event_threshold_ == 33


def test_units_are_those_of_the_training_series(tmp_path):
    array = xarray.DataArray(SERIES, dims=("series", "time", "component"), attrs={"units": "degC"})
    made = forecaster().fit(array[:6])
    made.save(tmp_path / "f.nc")
    for each in (made, EventForecaster.load(tmp_path / "f.nc")):
        with pytest.raises(ValueError, match="has the unit 'K' in the series and 'degC' in the tr"):
            each.scores((array[6:] + 273.15).assign_attrs(units="K"))
        each.scores(SERIES[6:])


# -- threads ---------------------------------------------------------------------------------------


def test_threads_of_libraries_are_what_they_were():
    import scipy.linalg  # noqa: F401 - its BLAS is one of them

    def numbers():
        return [pool["num_threads"] for pool in threadpool_info()]

    before, inside = numbers(), threading.Barrier(2)
    first, second = threading.Event(), []

    def early():
        with single_threaded():
            inside.wait()
        first.set()

    def late():
        with single_threaded():
            inside.wait()
            first.wait()
            second.extend(numbers())

    threads = [threading.Thread(target=each) for each in (early, late)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(second) == {1}
    assert numbers() == before


def test_libraries_that_are_loaded_late_have_one_thread_too():
    """SciPy brings a BLAS of its own, which the limit does not reach before it is loaded."""
    code = """
from threadpoolctl import threadpool_info
from burstcast.base.threads import single_threaded
with single_threaded():
    import scipy.linalg
    print(*(pool["num_threads"] for pool in threadpool_info()))
"""
    several = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "2")
    numbers = said_by([sys.executable, "-c", code], ROOT, **several).split()
    assert numbers
    assert {*numbers} == {"1"}


# -- a sign of life --------------------------------------------------------------------------------


class Screen(StringIO):
    def isatty(self):
        return True


def screen_of(monkeypatch):
    """A terminal in place of stderr, which pytest replaces after all fixtures."""
    monkeypatch.setattr(sys, "stderr", Screen())
    monkeypatch.setattr(progress, "_SECONDS_BETWEEN", 0.01)
    return sys.stderr


def long_fit(monkeypatch, **arguments):
    """A fit whose work goes on until something is written, or a second is over."""
    screen, before = sys.stderr, sys.stderr.getvalue()

    def work(self, kind, series, parameters, sign):
        sign.stage("network 1 of 3")
        until = time.monotonic() + 1
        while "network" not in screen.getvalue().removeprefix(before) and time.monotonic() < until:
            time.sleep(0.01)
        self.warnings_ = []
        if arguments.get("parameters"):
            raise ValueError("no")

    monkeypatch.setattr(EventForecaster, "_fit", work)
    return forecaster().fit(SERIES, **arguments)


def test_a_long_fit_says_on_one_line_what_it_is_at(monkeypatch):
    screen = screen_of(monkeypatch)
    monkeypatch.setattr(progress, "_SECONDS_BEFORE", 0.02)
    long_fit(monkeypatch)
    said = screen.getvalue()
    assert re.fullmatch(
        r"(\rfit of analogues:( network 1 of 3,)? \d+ s *)+\r.*done, \d s +\n", said
    )
    assert "\n" not in said[:-1]
    with pytest.raises(ValueError, match="no"):
        long_fit(monkeypatch, parameters=1)
    assert re.search(r"\rfit of analogues: stopped, \d s *\n$", screen.getvalue())
    # wanted unless it is said that it is not
    with progress.SignOfLife("a count"):
        until = time.monotonic() + 5
        while "a count" not in screen.getvalue() and time.monotonic() < until:
            time.sleep(0.01)
    assert "a count: done" in screen.getvalue()


def test_quick_fits_and_files_hear_nothing_and_nobody_who_wants_nothing(monkeypatch):
    screen = screen_of(monkeypatch)
    forecaster().fit(SERIES)
    assert progress._SECONDS_BEFORE == 5
    assert screen.getvalue() == ""
    monkeypatch.setattr(progress, "_SECONDS_BEFORE", 0.02)
    long_fit(monkeypatch, verbose=False)
    monkeypatch.setattr(Screen, "isatty", lambda _: False)
    long_fit(monkeypatch)
    assert screen.getvalue() == ""


def test_edges_of_a_search_count_where_they_are_no_rounding():
    """A Tikhonov parameter that is lost in rounding has no lower bound; its neighbours have."""
    settings = {"neurons": 100, "searches": 2, "spectral_radius": (0.1, 1.0)}
    settings |= {"input_scaling": (0.5, 5.0), "tikhonov": (1e-15, 1e-6)}
    lowest = {name: settings[name][0] for name in ("spectral_radius", "input_scaling", "tikhonov")}
    told = " ".join(search_edges([lowest] * 2, settings, samples=10_000))
    assert "spectral_radius at its lower bound 0.1 in 2 of 2" in told
    assert "input_scaling at its lower bound 0.5" in told
    assert "tikhonov" not in told
    (text,) = search_edges(
        [{**lowest, "spectral_radius": 0.3, "input_scaling": 1.0, "tikhonov": 1e-6}], settings, 10
    )
    assert "tikhonov at its upper bound 1e-06 in 1 of 1" in text


# -- one series, or a batch ------------------------------------------------------------------------


def test_a_series_has_the_probability_of_the_batch_with_a_classifier():
    options = {"neurons": 60}
    made = forecaster(kind="esn_direct", options=options).fit(SERIES[:6])
    together = made.predict_proba(SERIES[:, :300])
    alone = np.concatenate([made.predict_proba(SERIES[row : row + 1, :300]) for row in range(8)])
    np.testing.assert_array_equal(alone, together)
    for sample in SERIES[7, :300]:
        made.update(sample)
    assert made.probability() == together[7, 1]


def test_more_neighbours_than_samples_are_refused():
    with pytest.raises(ValueError, match="neighbours is 100000, but the training series have"):
        forecaster(options={"neighbours": 100_000}).fit(SERIES)

"""The same record in other units or in another form gives the same forecasts, or is refused."""

import functools

import numpy as np
import pandas as pd
import pytest
import xarray
from test_event_forecaster import LYAPUNOV_TIME

from burstcast import EventForecaster
from burstcast.forecasters.registry import all_kinds, kind_class
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63

THRESHOLD = 12.0
RHO = np.repeat([26.0, 30.0], 3)
AWARE = {"parameters": ("rho",), "transform": "identity"}
OPTIONS = {
    "esn_filtered": {"members": 8, "voters": 4, "denoising_rounds": 1},
    "quadratic_hidden": {"hidden": 1, "rates_per_lt": (1.5, 3.0), "rounds": 1, "members": 8},
    "esn_direct": {"neurons": 100, "folds": 2, "input_scaling": (1.0,)},
    "precursor": {"folds": 2},
    "quadratic_filtered": {"members": 8},
    "quadratic_aware_filtered": {"members": 8, **AWARE},
    **dict.fromkeys(("esn_aware", "quadratic_aware"), AWARE),
}
# equations are equations in their own units
KINDS = [kind for kind in all_kinds() if not kind_class(kind).needs_equations]


@functools.cache
def record():
    """Series of float32 numbers, under two values of rho, and test series."""
    start = np.array([[1.0, 1.0, 20.0]] * 8).T
    start += np.random.default_rng(4).uniform(-5, 5, start.shape)
    halves = [
        integrate(Lorenz63(rho=rho), start[:, rows], 0.01, 1600, stride=2)[300:].transpose(2, 0, 1)
        for rho, rows in ((26.0, slice(4)), (30.0, slice(4, 8)))
    ]
    series = np.concatenate([half[:3] for half in halves] + [half[3:] for half in halves])
    series += np.random.default_rng(5).normal(scale=0.05, size=series.shape)
    return np.split(series.astype(np.float32).astype(float), [6])


def fit(kind, series, rho=RHO, scale=1.0, offset=0.0, observable=0, bayesian_points=0, **more):
    """A small forecaster of the record in a unit, told of rho where the kind learns it."""
    forecaster = EventForecaster(
        observable=observable,
        event_threshold=THRESHOLD * scale + offset,
        kind=kind,
        **{"prediction_times": (0.5,), "lyapunov_time": LYAPUNOV_TIME, "sampling_interval": 0.02},
        **{"members": 2, "neurons": 80, "grid": 2, "input_scaling": (1, 5)},
        bayesian_points=bayesian_points,
        tikhonov=1e-4,  # well-conditioned: rounding stays rounding
        options={**OPTIONS.get(kind, {}), **more} or None,
    )
    learns = kind_class(kind).learns_parameters
    return forecaster.fit(series, parameters=rho if learns else None)


def after(forecaster, test, form=np.asarray):
    """Probabilities after several lengths of test series."""
    ends = range(60, 500, 64)
    return np.stack([forecaster.predict_proba(form(test[:, :end]))[:, 1] for end in ends])


@functools.cache
def in_unit(kind, scale=1.0, offset=0.0, **settings):
    """A forecaster of the record in a unit, and its probabilities of the test series."""
    training, test = (series * scale + offset for series in record())
    forecaster = fit(kind, training, scale=scale, offset=offset, **settings)
    return forecaster, after(forecaster, test)


def expected(kind, **settings):
    return in_unit(kind, **settings)[1]


def assert_equal_forecasts(kind, probability, **settings):
    plain = expected(kind, **settings)
    # what forecasts no event at all would be equal in vain; persistence never does
    assert np.ptp(plain) > (-1 if kind == "persistence" else 0.3)
    # votes are counted; rounding reaches what is not
    tolerance = 1e-9 if kind == "esn_direct" else 0
    np.testing.assert_allclose(probability, plain, rtol=0, atol=tolerance)


# powers of two: others round the series themselves, and a search makes more of that
@pytest.mark.parametrize("scale", [2.0**23, 2.0**-20])
@pytest.mark.parametrize("kind", KINDS)
def test_another_unit_changes_no_forecast(kind, scale):
    search = {"bayesian_points": 1} if kind_class(kind).has_search else {}
    forecaster, probability = in_unit(kind, scale, **search)
    assert forecaster.hyperparameters_ == in_unit(kind, **search)[0].hyperparameters_
    assert_equal_forecasts(kind, probability, **search)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind.startswith("quadratic")])
def test_another_zero_changes_no_forecast(kind):
    # a sum is rounded: no point of a Gaussian process
    assert_equal_forecasts(kind, in_unit(kind, offset=1e4)[1])


@pytest.mark.parametrize("kind", KINDS)
def test_the_layout_of_numbers_changes_no_forecast(kind):
    training, test = (np.asfortranarray(array.astype(np.float32)) for array in record())
    np.testing.assert_array_equal(after(fit(kind, training), test), expected(kind))


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_of_the_caller_is_kept_or_changed(kind):
    def in_place(states):
        np.negative(states, out=states)
        return -states[..., 0]

    (training, test), rho = (array.copy() for array in record()), RHO.copy()
    forecaster = fit(kind, training, rho, observable=in_place)
    np.testing.assert_array_equal(training, record()[0])
    training[:] = rho[:] = np.nan
    np.testing.assert_array_equal(after(forecaster, test), expected(kind))
    np.testing.assert_array_equal(test, record()[1])


@pytest.mark.parametrize("kind", ["esn", "esn_direct"])
def test_networks_without_an_offset_depend_on_the_zero(kind):
    plain, moved = (in_unit(kind, offset=zero, input_offset="none")[1] for zero in (0.0, 1e4))
    assert np.abs(moved - plain).max() > 0.1


# -- labels, dimensions, clocks --------------------------------------------------------------------


def tables(columns="zxy", change=np.asarray):
    """Function that makes a table of each series, with its columns in an order and a clock."""

    def form(series):
        times = pd.Index(change(7.0 + 0.02 * np.arange(series.shape[1])), name="time")
        named = [pd.DataFrame(states, columns=[*"xyz"])[[*columns]] for states in series]
        return [table.set_index(times) for table in named]

    return form


def named_array(series):
    array = xarray.DataArray(series, dims=("series", "time", "component"))
    turned = array.assign_coords(component=[*"xyz"])[..., [1, 2, 0]]
    return turned.transpose("component", "time", "series")


def array_beside_a_table(series):
    """It has the order of the components of the first table."""
    return [*tables()(series[:1]), *series[1:, :, [2, 0, 1]]]


@pytest.mark.parametrize("kind", KINDS)
def test_components_go_by_their_labels(kind):
    training, test = record()
    forecaster = fit(kind, tables("zxy")(training), observable="x")
    assert_equal_forecasts(kind, after(forecaster, test, tables("yzx")))
    assert_equal_forecasts(kind, after(forecaster, test, named_array))
    if kind_class(kind).has_trajectories:  # forecasts have the order of the training series
        expected = in_unit(kind)[0].forecast(test)[..., [2, 0, 1]]
        np.testing.assert_array_equal(forecaster.forecast(tables("xyz")(test)), expected)
        # arrays without labels have that order, too
        np.testing.assert_array_equal(forecaster.forecast(test[..., [2, 0, 1]]), expected)


# networks are validated on the first series
@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind_class(kind).has_search])
def test_another_order_of_series_changes_no_forecast(kind):
    training, test = record()
    forecaster = fit(kind, training[::-1], RHO[::-1])
    np.testing.assert_allclose(after(forecaster, test), expected(kind), rtol=0, atol=1e-6)


@pytest.fixture(scope="module")
def labelled():
    """Analogues of labelled series, whose observable is a function of the given components."""
    return fit("analogues", tables("zxy")(record()[0]), observable=lambda states: states[..., 1])


def test_functions_have_the_components_in_the_order_of_the_training_series(labelled, tmp_path):
    by_label = fit("analogues", tables("yzx")(record()[0]), observable="x")
    for forecaster, form in (
        *((labelled, tables("xyz")), (labelled, array_beside_a_table)),
        (by_label, named_array),
    ):
        forecaster.save(tmp_path / "saved.nc")
        own = forecaster.observable if callable(forecaster.observable) else None
        loaded = EventForecaster.load(tmp_path / "saved.nc", own)
        assert loaded.observable == forecaster.observable
        for each in (forecaster, loaded):
            probability = after(each, record()[1], form)
            np.testing.assert_array_equal(probability, expected("analogues"))


def test_observations_of_a_stream_go_by_their_labels(labelled):
    series = record()[1][0]
    expected_probability = labelled.predict_proba(tables("zxy")(series[np.newaxis, :200]))[0, 1]
    for form in (
        lambda row: pd.Series(row, index=[*"xyz"])[[*"yxz"]],
        lambda row: named_array(row[np.newaxis, np.newaxis])[:, 0, 0],
        lambda row: row[[2, 0, 1]],
    ):
        for row in series[:200]:
            labelled.update(form(row))
        assert labelled.probability() == expected_probability
    with pytest.raises(ValueError, match="components of an observation are x, y, w; those of the"):
        labelled.update(pd.Series(series[0], index=[*"xyw"]))


def dated(step):
    start = pd.Timestamp("2020-01-01")
    return tables(
        change=lambda times: start + pd.to_timedelta(step * np.arange(len(times)), unit="s")
    )


REFUSED = [
    (tables(change=lambda times: 2 * times), "are 0.04 apart, but sampling_interval is 0.02"),
    (tables(change=lambda times: times[::-1]), "times must rise"),
    (
        tables(change=lambda times: times + (times > 9.5)),
        "not those at the times 9.5 and 10.52: give the runs between gaps as a list",
    ),
    (
        lambda series: [table.rename(columns={"z": "w"}) for table in tables("zxy")(series)],
        "components of the series are w, x, y; those of the training series were z, x, y",
    ),
    (
        lambda series: [tables("zxy")(series)[0], tables("xy")(series)[1]],
        "the series have different components: z, x, y and x, y",
    ),
    (
        lambda series: [tables("xyz")(series)[0], tables(change=np.exp2)(series)[1]],
        "the rate of samples changes",
    ),
    (lambda series: series[..., :2], "have 2 components, the training series had 3"),
]


@pytest.mark.parametrize(("form", "message"), REFUSED)
def test_other_components_and_clocks_are_refused(form, message, labelled):
    series = record()[1]
    for call in (labelled.predict_proba, labelled.forecast, labelled.scores, labelled.score):
        with pytest.raises(ValueError, match=message):
            call(form(series))


def test_dates_are_compared_with_those_of_the_training_series():
    training, test = record()
    forecaster = fit("analogues", dated(0.02)(training), observable="x")
    for form in (dated(0.02), tables("zxy")):
        np.testing.assert_array_equal(after(forecaster, test, form), expected("analogues"))
    with pytest.raises(ValueError, match="2 seconds apart, but the interval of the training"):
        forecaster.predict(dated(2.0)(test))


def test_a_jittering_clock_is_none_of_another_step(labelled):
    jitter = 0.004 * np.random.default_rng(0).uniform(-1, 1, 2000)
    form = tables(change=lambda times: np.round(times + jitter[: len(times)], 3))
    np.testing.assert_array_equal(after(labelled, record()[1], form), expected("analogues"))

"""`EventForecaster` with scikit-learn's tools, one observation at a time, and with parameters."""

import inspect
import math
import pickle
import sys
import time
from importlib.metadata import version
from importlib.util import module_from_spec, spec_from_file_location

import numpy as np
import pytest
from sklearn.utils import estimator_checks
from sklearn.utils.validation import check_is_fitted
from test_event_forecaster import SMALL, fit, lorenz

import burstcast
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.event_forecaster.schedules import as_schedules
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from helpers_library import ROOT

TINY = {**SMALL, "members": 2, "neurons": 30}
# networks of 30 neurons of a few hundred samples are as bad as they are told to be
pytestmark = pytest.mark.filterwarnings("ignore:signs of a weak forecaster")


def test_what_was_fitted_is_kept(watching):
    again, seen = pickle.loads(pickle.dumps(watching)), SERIES[np.newaxis]
    np.testing.assert_array_equal(again.predict_proba(seen), watching.predict_proba(seen))
    assert again.get_params() == watching.get_params()
    check_is_fitted(again)
    with pytest.raises(Exception, match="not fitted"):
        check_is_fitted(burstcast.EventForecaster())


CHECKS = """estimator_cloneable estimator_get_tags_default_keys estimator_repr set_params
estimator_tags_renamed get_params_invariance no_attributes_set_in_init valid_tag_types"""


@pytest.mark.parametrize("name", CHECKS.split())
def test_checks_of_estimators_that_need_no_table(name):
    """The others fit tables, ``(samples, features)``, or want defaults that are no dictionary."""
    check = getattr(estimator_checks, f"check_{name}", None)
    if check is None:
        pytest.skip(f"this scikit-learn has no check_{name}")
    check("EventForecaster", burstcast.EventForecaster(**TINY))


# -- parameters ------------------------------------------------------------------------------------


def test_the_signature_can_be_read():
    text = str(inspect.signature(burstcast.EventForecaster))
    assert "observable: 'Observable' = 0" in text
    assert "numpy.ndarray" not in text


def test_the_version():
    assert burstcast.__version__ == version("burstcast")
    assert "__version__" in dir(burstcast)


# -- warnings --------------------------------------------------------------------------------------
@pytest.mark.filterwarnings("default:signs of a weak")
def test_a_search_that_ended_on_its_edge_warns():
    narrow = {**TINY, "calibrate": False, "input_scaling": (9.0, 10.0)}
    with pytest.warns(UserWarning, match=r"input_scaling at its (lower|upper) bound .* beyond it"):
        burstcast.EventForecaster(**narrow).fit(lorenz(6, 500, 1))


# -- one observation at a time ---------------------------------------------------------------------

INTERVAL = 0.02


SERIES = lorenz(1, 300, 5)[0]


@pytest.fixture(scope="module")
def watching():
    return fit(lorenz(4, 900, 1), members=2, options=None)


@pytest.fixture
def forecaster(watching, tmp_path):
    """A copy of its own, which has seen nothing."""
    watching.save(tmp_path / "fresh.nc")
    return burstcast.EventForecaster.load(tmp_path / "fresh.nc")


def test_each_sample_has_the_probability_of_the_batch(forecaster, tmp_path):
    """By a clock that jitters and counts since 1970; the latest observations lie in the file."""
    washout = forecaster._samples("washout")
    probabilities = {0.5: [], 1.0: []}
    for number, sample in enumerate(SERIES[:120]):
        if number == 40:
            forecaster.save(tmp_path / "watching.nc")
            forecaster = burstcast.EventForecaster.load(tmp_path / "watching.nc")
            assert forecaster.probability() == probabilities[0.5][-1]
        forecaster.update(sample, 1.7e9 + INTERVAL * (number + 0.05 * (number % 2)))
        for lead, values in probabilities.items():
            values.append(forecaster.probability(lead))
    for lead, values in probabilities.items():
        assert np.isnan(values[: washout - 1]).all()
        windows = np.stack([SERIES[end - washout : end] for end in range(washout, 121)])
        expected = forecaster.predict_proba(windows, lead)[:, 1]
        assert np.array_equal(values[washout - 1 :], expected)
        assert len(set(values)) > 3
    assert forecaster.probability() == probabilities[0.5][-1]


@pytest.mark.parametrize("gap", ["time", "value"])
def test_a_gap_begins_the_washout_again_and_says_so(forecaster, gap):
    washout = forecaster._samples("washout")
    for number in range(washout):
        forecaster.update(SERIES[number], number * INTERVAL)
    assert not math.isnan(forecaster.probability())
    first = washout + (3 if gap == "time" else 1)
    if gap == "time":
        with pytest.warns(UserWarning, match="no observation came between the times"):
            forecaster.update(SERIES[first], first * INTERVAL)
    else:
        with pytest.warns(UserWarning, match="an observation is not finite"):
            forecaster.update([0.0, np.nan, 1.0])
        assert math.isnan(forecaster.probability())
        forecaster.update(SERIES[first])
    assert math.isnan(forecaster.probability())
    for number in range(first + 1, first + washout):
        forecaster.update(SERIES[number], number * INTERVAL)
    expected = forecaster.predict_proba(SERIES[np.newaxis, first : first + washout])[0, 1]
    assert forecaster.probability() == expected


@pytest.mark.parametrize(
    ("observation", "when", "message"),
    [
        (np.zeros(2), None, r"has the shape \(3,\).*this one has \(2,\)"),
        (np.zeros((1, 3)), None, r"this one has \(1, 3\)"),
        (np.zeros(3), 0.98, "at time 0.98 cannot follow one at time 1"),
        (np.zeros(3), 1.01, "the sampling interval is 0.02"),
        (np.zeros(3), math.nan, "time of an observation must be a finite number, in the unit of"),
        (np.zeros(3), math.inf, "in the unit of sampling_interval, not inf"),
    ],
)
def test_what_does_not_follow_is_refused(forecaster, observation, when, message):
    forecaster.update(SERIES[0], 1.0)
    with pytest.raises(ValueError, match=message):
        forecaster.update(observation, when)
    forecaster.update(SERIES[1], 1.02)  # what was refused has left nothing behind


def test_nothing_is_watched_before_the_fit_and_a_fit_forgets_the_observations(forecaster):
    assert math.isnan(forecaster.probability())
    for sample in SERIES[:40]:
        forecaster.update(sample)
    forecaster.set_params(calibrate=False).fit(lorenz(4, 900, 1))
    assert math.isnan(forecaster.probability())


def test_taking_a_sample_is_fast(forecaster):
    """An update keeps the sample, whatever the networks; less than a millisecond is allowed."""
    start = time.process_time()
    for number in range(2000):
        forecaster.update(SERIES[number % 300])
    assert (time.process_time() - start) / 2000 < 1e-3


# -- that knows parameters -------------------------------------------------------------------------

REYNOLDS = (400.0, 600.0, 1000.0)


def flows(reynolds, count, steps=300):
    system = MoehlisFaisstEckhardt(reynolds, 4 * np.pi, 2 * np.pi)
    start = np.zeros((9, count))
    start[0], start[2] = 1, 0.07066
    start[3] = -0.07076 + 0.01 * np.linspace(0, 1, count)
    return integrate(system, start, 0.25, 4 * (200 + steps), stride=4)[200:].transpose(2, 0, 1)


@pytest.fixture(scope="module")
def aware():
    """Fitted to flows of each Reynolds number."""
    series = np.concatenate([flows(reynolds, 3) for reynolds in REYNOLDS])
    forecaster = EventForecaster(
        *(MoehlisFaisstEckhardt(400.0, 4 * np.pi, 2 * np.pi), {"quantile": 0.9}),
        **{"kind": "quadratic_aware", "noise": 0.001, "calibrate": False, "sampling_stride": 4},
        **{"prediction_times": (0.7,), "window": 0.7, "washout": 0.33, "lyapunov_time": 61.0},
    )
    return forecaster.fit(series, parameters=np.repeat(REYNOLDS, 3))


def test_probabilities_depend_on_what_is_planned_and_are_saved_with_it(aware, tmp_path):
    observed = flows(500.0, 40)
    asked = aware.what_if(observed, {"actuated": 2000.0}, parameters=500.0)
    expected = aware.predict_proba(observed, parameters=500.0)[:, 1]
    np.testing.assert_array_equal(asked["none"], expected)
    assert asked["none"].sum() > asked["actuated"].sum()
    # plans may change in time
    planned = np.full((40, aware._timing.boundaries[-1]), 500.0)
    in_parts = aware.predict_proba(observed, parameters=np.full(40, 500.0), planned=planned)
    np.testing.assert_array_equal(in_parts[:, 1], expected)
    aware.save(tmp_path / "aware.nc")
    loaded = EventForecaster.load(tmp_path / "aware.nc", aware.observable)
    np.testing.assert_array_equal(loaded.predict_proba(observed), aware.predict_proba(observed))
    assert loaded.own_parameters_ == pytest.approx([np.mean(REYNOLDS)])


def test_mistakes_are_told(aware):
    observed = flows(400.0, 3)
    with pytest.raises(ValueError, match=r"the shape \(4,\); 3 series of 19 steps"):
        aware.predict_proba(observed, parameters=[400.0] * 4)
    with pytest.raises(ValueError, match="need the values of reynolds: fit"):
        EventForecaster(kind="quadratic_aware").fit(observed)
    with pytest.raises(ValueError, match="analogues do not know the parameters"):
        EventForecaster(kind="analogues").fit(observed, parameters=400.0)


def test_schedules_of_two_parameters():
    names = ["reynolds", "length_x"]
    schedules = as_schedules([400.0, 12.0], 3, 4, names)
    assert schedules.shape == (3, 4, 2)
    assert schedules[2, 3].tolist() == [400, 12]
    with pytest.raises(ValueError, match="must be finite"):
        as_schedules([400.0, np.inf], 3, 4, names)


@pytest.mark.long
def test_no_kind_fails_silently_on_a_bank_of_systems():
    """Spiky, intermittent, forced, delayed, stiff and discrete ones; small series, no networks."""
    spec = spec_from_file_location("bank", ROOT / "benchmarks" / "bank.py")
    bank = module_from_spec(spec)
    sys.modules["bank"] = bank  # where dataclasses look up their annotations
    spec.loader.exec_module(bank)
    assert len(bank.BANK) >= 25
    kinds = [kind for kind in bank.KINDS if kind != "esn"]
    won = set()
    for name in bank.BANK:
        results = bank.trials(name, kinds, 20)
        assert bank.silent(results) == [], name
        for kind, trial in results.items():
            assert np.isnan(trial.skill) or trial.invalid < 0.5 or "invalid" in trial.words, kind
        skills = {kind: trial.skill for kind, trial in results.items() if trial.skill > bank.SKILL}
        won |= {max(skills, key=skills.get)} if skills else set()
    assert len(won) > 3

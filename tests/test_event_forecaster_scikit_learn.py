"""`burstcast.EventForecaster` with scikit-learn's tools; parameters as people may give them."""

import copy
import inspect
import pickle
import re
from importlib.metadata import version
from pathlib import Path

import joblib
import numpy as np
import pytest
import yaml
from sklearn.model_selection import GridSearchCV, cross_val_score
from sklearn.utils import estimator_checks
from sklearn.utils.validation import check_is_fitted

import burstcast
from burstcast.probability.alarms import useless_votes
from burstcast.probability.outcomes import Outcomes
from test_event_forecaster import SMALL, lorenz

DOCS = Path(__file__).parents[1] / "docs"
TINY = {**SMALL, "members": 2, "neurons": 30}
# networks of 30 neurons of a few hundred samples are as bad as they are told to be
pytestmark = pytest.mark.filterwarnings("ignore:the search ended", "ignore:prediction time")


@pytest.fixture(scope="module")
def series():
    return lorenz(6, 500, 1)


@pytest.fixture(scope="module")
def fitted(series):
    return burstcast.EventForecaster(**TINY).fit(series)


def test_cross_validation_takes_series_as_samples(series):
    scores = cross_val_score(burstcast.EventForecaster(**TINY), series, cv=2, error_score="raise")
    by_hand = burstcast.EventForecaster(**TINY).fit(series[3:]).score(series[:3])
    assert scores.shape == (2,)
    assert scores[0] == pytest.approx(by_hand, abs=0, nan_ok=True)


def test_a_grid_search_sets_parameters(series):
    other = burstcast.EventForecaster(**{**TINY, "members": 1})
    search = GridSearchCV(other, {"prior_forecasts": [5.0, 50.0]}, cv=2, error_score="raise")
    search.fit(series)
    assert search.best_params_["prior_forecasts"] in (5.0, 50.0)
    assert search.best_estimator_.predict(series).shape == (6,)


@pytest.mark.parametrize(
    "kept",
    [
        lambda one, path: pickle.loads(pickle.dumps(one)),
        lambda one, path: copy.deepcopy(one),
        lambda one, path: joblib.load(joblib.dump(one, path / "forecaster.joblib")[0]),
    ],
)
def test_what_was_fitted_is_kept(kept, fitted, series, tmp_path):
    again = kept(fitted, tmp_path)
    np.testing.assert_array_equal(again.predict_proba(series), fitted.predict_proba(series))
    assert again.get_params() == fitted.get_params()


@pytest.mark.parametrize(
    "name",
    [
        "check_estimator_cloneable",
        "check_estimator_get_tags_default_keys",
        "check_estimator_repr",
        "check_estimator_tags_renamed",
        "check_get_params_invariance",
        "check_no_attributes_set_in_init",
        "check_set_params",
        "check_valid_tag_types",
    ],
)
def test_checks_of_estimators_that_need_no_table(name):
    """The others fit tables, ``(samples, features)``, or want defaults that are no dictionary."""
    check = getattr(estimator_checks, name, None)
    if check is None:
        pytest.skip(f"this scikit-learn has no {name}")
    check("EventForecaster", burstcast.EventForecaster(**TINY))


def test_scikit_learn_sees_whether_it_is_fitted(fitted):
    check_is_fitted(fitted)
    with pytest.raises(Exception, match="not fitted"):
        check_is_fitted(burstcast.EventForecaster())


# -- parameters ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"observable": "z"}, "observable must be the number of a component, counted from 0"),
        ({"observable": None}, "observable must be the number of a component"),
        ({"neurons": 30.5}, "neurons must be a whole number, not 30.5"),
        ({"neurons": "30"}, "neurons must be a whole number, not '30'"),
        ({"members": None}, "members must be a whole number, not None"),
        ({"grid": float("nan")}, "grid must be a whole number, not nan"),
        ({"window": "1"}, "window must be a number, not '1'"),
        ({"lyapunov_time": True}, "lyapunov_time must be a number, not True"),
        ({"prediction_times": ("1", 2)}, "prediction_times must be a number, not '1'"),
        ({"spectral_radius": 0.5}, r"spectral_radius must be two numbers, \(low, high\), not 0.5"),
        ({"event_threshold": "high"}, "event_threshold must be a number, not 'high'"),
    ],
)
def test_a_parameter_of_another_type(change, message, series):
    with pytest.raises(TypeError, match=message):
        burstcast.EventForecaster(**{**TINY, **change}).fit(series)


def test_whole_numbers_and_single_times_are_taken_for_what_they_are(series):
    given = {**TINY, "members": 1, "calibrate": False}
    sloppy = {"neurons": 30.0, "members": np.int64(1), "grid": 2.0, "tikhonov": 1e-6}
    one = burstcast.EventForecaster(**{**given, **sloppy, "prediction_times": 1}).fit(series)
    other = burstcast.EventForecaster(
        **{**given, "tikhonov": (1e-6,), "prediction_times": (1.0,)}
    ).fit(series)
    np.testing.assert_array_equal(one.forecast(series), other.forecast(series))
    assert list(one.alarms_) == [1.0]


def test_series_of_unequal_lengths_are_told(series):
    with pytest.raises(ValueError, match=r"unequal lengths: series 0 has 500 .* series 2 400"):
        burstcast.EventForecaster(**TINY).fit([series[0], series[1], series[2][:400]])


def test_the_signature_can_be_read():
    text = str(inspect.signature(burstcast.EventForecaster))
    assert "observable: 'Observable' = 0" in text
    assert "numpy.ndarray" not in text


def test_the_version():
    assert burstcast.__version__ == version("burstcast")
    assert "__version__" in dir(burstcast)


# -- warnings --------------------------------------------------------------------------------------


@pytest.mark.filterwarnings("default:the search ended", "default:prediction time")
def test_a_search_that_ended_on_its_edge_warns(series):
    narrow = {**TINY, "calibrate": False, "input_scaling": (9.0, 10.0)}
    with pytest.warns(UserWarning, match=r"input_scaling at its (lower|upper) bound .* beyond it"):
        burstcast.EventForecaster(**narrow).fit(series)


@pytest.mark.filterwarnings("default:prediction time")
def test_votes_that_tell_nothing_warn(series):
    noise = np.random.default_rng(0).standard_normal((6, 500, 1))
    with pytest.warns(UserWarning, match="votes do not tell the .* no better than chance"):
        burstcast.EventForecaster(**{**TINY, "event_threshold": 1.5}).fit(noise)


def test_when_votes_tell_something():
    def outcomes(points, events):
        return Outcomes(np.array([0.0, 1.0]), np.array(points), np.array(events))

    assert useless_votes(outcomes([50, 50], [5, 45])) == ""
    assert "area below the ROC curve 0.50" in useless_votes(outcomes([50, 50], [25, 25]))
    assert "no better than chance" in useless_votes(outcomes([50, 50], [45, 5]))
    assert "0 of 100 starting points" in useless_votes(outcomes([50, 50], [0, 0]))


# -- pages -----------------------------------------------------------------------------------------


def test_the_page_names_networks_that_the_demo_has():
    from snakemake.utils import update_config

    from burstcast_workflow.campaign.campaign import Campaign
    from burstcast_workflow.config.loading import load

    config, preset = (
        yaml.safe_load((DOCS.parent / name).read_text(encoding="utf-8"))
        for name in ("config.yaml", "workflow/presets/quick.yaml")
    )
    update_config(config, preset)
    demo = {one.directory for one in Campaign(load(config)).forecasters}
    text = (DOCS / "notebook.md").read_text(encoding="utf-8")
    named = re.findall(r"campaign\.networks\[\"(.*?)\"\]", text)
    assert named
    assert set(named) <= demo

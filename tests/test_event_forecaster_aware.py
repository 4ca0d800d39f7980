"""An EventForecaster that knows parameters: fit under several values, and what if."""

import numpy as np
import pytest

from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.event_forecaster.schedules import as_schedules
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt

REYNOLDS = (400.0, 600.0, 1000.0)


def flows(reynolds, count, steps=300):
    system = MoehlisFaisstEckhardt(reynolds, 4 * np.pi, 2 * np.pi)
    start = np.zeros((9, count))
    start[0], start[2] = 1, 0.07066
    start[3] = -0.07076 + 0.01 * np.linspace(0, 1, count)
    return integrate(system, start, 0.25, 4 * (200 + steps), stride=4)[200:].transpose(2, 0, 1)


@pytest.fixture(scope="module")
def fitted():
    series = np.concatenate([flows(reynolds, 3) for reynolds in REYNOLDS])
    forecaster = EventForecaster(
        MoehlisFaisstEckhardt(400.0, 4 * np.pi, 2 * np.pi),
        event_threshold={"quantile": 0.9},
        lyapunov_time=61.0,
        prediction_times=(0.7,),
        window=0.7,
        washout=0.33,
        kind="quadratic_aware",
        noise=0.001,
        sampling_stride=4,
        calibrate=False,
    )
    return forecaster.fit(series, parameters=np.repeat(REYNOLDS, 3))


def test_probabilities_depend_on_what_is_planned(fitted):
    observed = flows(500.0, 40)
    asked = fitted.what_if(observed, {"actuated": 2000.0}, parameters=500.0)
    np.testing.assert_array_equal(
        asked["none"], fitted.predict_proba(observed, parameters=500.0)[:, 1]
    )
    assert asked["none"].sum() > asked["actuated"].sum()


def test_plans_may_change_in_time(fitted):
    observed, steps = flows(400.0, 5), fitted._timing.boundaries[-1]
    never = np.full((5, steps), 400.0)
    one = fitted.predict_proba(observed, parameters=np.full(5, 400.0), planned=never)
    np.testing.assert_array_equal(one, fitted.predict_proba(observed, parameters=400.0))


def test_it_is_saved_with_what_it_knows(fitted, tmp_path):
    fitted.save(tmp_path / "aware.nc")
    loaded = EventForecaster.load(tmp_path / "aware.nc", fitted.observable)
    observed = flows(700.0, 4)
    np.testing.assert_array_equal(loaded.predict_proba(observed), fitted.predict_proba(observed))
    assert loaded.own_parameters_ == pytest.approx([np.mean(REYNOLDS)])


def test_mistakes_are_told(fitted):
    observed = flows(400.0, 3)
    with pytest.raises(ValueError, match=r"the shape \(4,\); 3 series of 19 steps"):
        fitted.predict_proba(observed, parameters=[400.0] * 4)
    with pytest.raises(ValueError, match="need the values of reynolds: fit"):
        EventForecaster(kind="quadratic_aware").fit(observed)
    with pytest.raises(ValueError, match="analogues do not know the parameters"):
        EventForecaster(kind="analogues").fit(observed, parameters=400.0)


def test_schedules_of_two_parameters():
    names = ["reynolds", "length_x"]
    found = as_schedules([400.0, 12.0], 3, 4, names)
    assert found.shape == (3, 4, 2)
    assert found[2, 3].tolist() == [400, 12]
    with pytest.raises(ValueError, match="must be finite"):
        as_schedules([400.0, np.inf], 3, 4, names)


@pytest.fixture(scope="module")
def network():
    series = np.concatenate([flows(reynolds, 4) for reynolds in REYNOLDS])
    forecaster = EventForecaster(
        MoehlisFaisstEckhardt(400.0, 4 * np.pi, 2 * np.pi),
        event_threshold={"quantile": 0.9},
        lyapunov_time=61.0,
        prediction_times=(0.3,),
        window=0.7,
        washout=0.33,
        kind="esn_aware",
        members=2,
        neurons=60,
        validation_interval=1.0,
        grid=2,
        bayesian_points=0,
        sampling_stride=4,
    )
    return forecaster.fit(series, parameters=np.repeat(REYNOLDS, 4))


def test_networks_know_the_parameter(network):
    assert len(network.members_) == len(network.hyperparameters_) == 2
    observed = flows(500.0, 30)
    asked = network.what_if(observed, {"actuated": 900.0}, parameters=500.0)
    assert not np.array_equal(asked["none"], asked["actuated"])
    # a schedule that says nothing new changes nothing
    np.testing.assert_array_equal(
        asked["none"], network.predict_proba(observed, parameters=500.0, planned=500.0)[:, 1]
    )


def test_a_network_forecasts_as_one_of_the_library_with_the_same_search(network):
    member, case = network.members_[0], network._case(9, [500.0])
    observed = flows(500.0, 3)
    washouts = np.ascontiguousarray(observed[:, -20:].transpose(1, 2, 0))
    steps = network._timing.boundaries[-1]
    schedule = np.full((steps, 1, 3), 500.0)
    outputs, _ = member.advance(member.start(washouts), steps, schedule)
    restored = type(member).restore(member.record(), case)
    again, _ = restored.advance(restored.start(washouts), steps)  # the case's own value
    np.testing.assert_array_equal(outputs, again)
    assert np.isfinite(outputs).all()


def test_series_under_different_parameters_take_turns():
    from burstcast.event_forecaster.networks import in_turns

    schedules = np.repeat(np.repeat(REYNOLDS, 2), 4).reshape(6, 4, 1)
    assert in_turns(schedules).tolist() == [0, 2, 4, 1, 3, 5]

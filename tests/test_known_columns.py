"""Columns of a record that are known in advance, and what learns from them and forecasts."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.data.records import recorded_series
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.reservoir import ReservoirSeed
from burstcast.forecast.horizon import HorizonSearch, prediction_horizons
from burstcast.forecast.window_forecasts import member_forecasts, window_forecasts
from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters._options import options_of_kind
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.esn_aware import AwareNetworkForecaster, factored_training
from burstcast.forecasters.quadratic_aware import AwareQuadraticModel
from burstcast.forecasters.registry import classifier_class
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.parameters import Parameters, SystemParameters, integrate_scheduled

RHO = SystemParameters.of(Lorenz63(), ["rho"])
OPTIONS = {**options_of_kind("quadratic_aware"), "transform": "identity", "divergence_bound": None}
SIMULATED = ForecastingCase(Lorenz63(), 0.0025, 8, 50, OPTIONS, RHO)
SPACE = MeasuredSeries(("x", "y", "z"), "z")
DATA = {
    **{"components": ["x", "y", "z"], "known": ["rho"], "time_step": 0.02},
    **{"blocks": None, "gaps": None},
}
# what is known of rho in a record: its column, and no value of the case's own
MEASURED = replace(SIMULATED, system=SPACE, parameters=Parameters(("rho",), ()))


@pytest.fixture(scope="module")
def flow():
    """States ``(6, time, 3)`` under a parameter that changes now and then, and its schedule."""
    generator = np.random.default_rng(4)
    changes = generator.random((800, 6)) < 0.05
    schedule = np.array([24.0, 28.0, 33.0])[np.cumsum(changes, axis=0) % 3][:, np.newaxis]
    start = generator.normal(size=(3, 6)) + np.array([[1.0], [1.0], [25.0]])
    states = integrate_scheduled(RHO, schedule, start, 0.0025, 8)
    return tuple(np.ascontiguousarray(one.transpose(2, 0, 1)) for one in (states, schedule))


@pytest.fixture(scope="module")
def record(flow, tmp_path_factory):
    """The same as files: a row has the value that was in force up to it."""
    directory = tmp_path_factory.mktemp("record")
    paths = []
    for number, (states, schedule) in enumerate(zip(*flow, strict=True)):
        column = np.concatenate([[99.0], schedule[:, 0]])  # of the first row nothing is used
        paths.append(str(directory / f"{number}.csv"))
        rows = np.column_stack([0.02 * np.arange(len(states)), states, column])
        header = {"delimiter": ",", "header": "time,x,y,z,rho", "comments": ""}
        np.savetxt(paths[-1], rows, fmt="%.17g", **header)
    return recorded_series(paths, DATA, SPACE)


def trained(kind, case, states, schedules):
    if kind == "quadratic_aware":
        return AwareQuadraticModel.fit(states, case, schedules)
    seed = ReservoirSeed(1, 60, 0, 4, 0.1)
    series, factors = factored_training(states, np.ptp(states, axis=(0, 1)), schedules, case)
    told = {"factors": factors, "parameters": case.parameters}
    how = {"washout": 20, "tikhonov": 1e-9, "divergence_bound": 10.0}
    dynamics = Dynamics(seed.reservoir(3), 0.3, 0.5, "scipy")
    return AwareNetworkForecaster.trained(dynamics, seed, series, **how, **told)


def test_a_record_of_a_simulated_flow_is_that_flow_with_its_schedule(flow, record):
    states, schedules = flow
    np.testing.assert_array_equal(record.states, states)
    np.testing.assert_array_equal(record.known[:, 1:], schedules)


@pytest.mark.parametrize("kind", ["quadratic_aware", "esn_aware"])
def test_forecasts_from_the_record_are_those_of_the_simulated_case(flow, record, kind):
    states, schedules = flow
    one = trained(kind, SIMULATED, states[:4], schedules[:4])
    other = trained(kind, MEASURED, record.states[:4], record.known[:4, 1:])
    for name, array in one.record().arrays.items():
        np.testing.assert_array_equal(other.record().arrays[name], array, err_msg=name)
    starts = [(row, step) for row in (4, 5) for step in range(40, 700, 60)]
    washouts = np.stack([states[row, step - 29 : step + 1] for row, step in starts])
    in_force = np.stack([schedules[row, step - 29 : step + 60] for row, step in starts])
    boundaries = (20, 40, 60)
    expected = window_forecasts(one, SPACE.observable, washouts, boundaries, in_force)
    # a batch, and one after the other
    found = window_forecasts(other, SPACE.observable, washouts, boundaries, in_force)
    each = [
        window_forecasts(other, SPACE.observable, washouts[[row]], boundaries, in_force[[row]])
        for row in range(len(starts))
    ]
    alone = np.concatenate([forecasts.largest for forecasts in each])
    np.testing.assert_array_equal(found.largest, expected.largest)
    np.testing.assert_allclose(alone, expected.largest, rtol=1e-9)
    # the forecast of another future is another one, and of none there is none
    wrong = in_force.copy()
    wrong[:, 29:] = 24.0
    elsewhere = window_forecasts(other, SPACE.observable, washouts, boundaries, wrong)
    assert not np.array_equal(elsewhere.largest, found.largest)
    with pytest.raises(ValueError, match="rho: values over the whole forecast must be given"):
        window_forecasts(other, SPACE.observable, washouts, boundaries)


def test_values_that_change_at_each_step_and_differ_between_points(flow):
    """A network's batch under different schedules is its single forecasts, to the last bit."""
    states, schedules = flow
    network = trained("esn_aware", MEASURED, states[:4], schedules[:4])
    washout = np.ascontiguousarray(states[:, 100:130].transpose(1, 2, 0))
    in_force = np.random.default_rng(2).uniform(24, 33, size=(6, 29 + 25, 1))
    together = member_forecasts(network, washout, 25, in_force)[:, :, 0]
    for row in range(6):
        one = np.ascontiguousarray(washout[..., [row]])
        alone = member_forecasts(network, one, 25, in_force[[row]])[:, :, 0]
        np.testing.assert_array_equal(alone[..., 0], together[..., row])


class Driven(AwareQuadraticModel):
    """Each step adds the value in force; nothing is learnt."""

    def __init__(self):
        pass

    def start(self, washout, parameters=None):
        assert parameters.shape == (len(washout) - 1, 1, washout.shape[2])
        # the washout's own values must be those of the same steps
        np.testing.assert_allclose(np.diff(washout, axis=0), parameters, atol=1e-12)
        return washout[-1]

    def advance(self, memory, steps, parameters=None):
        assert parameters.shape == (steps, 1, memory.shape[1])
        outputs = memory + np.cumsum(parameters, axis=0)
        return outputs, outputs[-1]


def test_horizons_under_a_schedule_end_where_it_is_wrong():
    search = HorizonSearch(4.0, 1.0, 0.5, washout=5, steps_per_lyapunov_time=10)
    generator = np.random.default_rng(3)
    schedules = generator.normal(size=(700, search.steps_before_event, 1))
    truth = np.concatenate([np.zeros((700, 1)), np.cumsum(schedules[..., 0], axis=1)], axis=1)
    observed = truth[..., np.newaxis].copy()

    def found(in_force):
        return prediction_horizons(
            Driven(), lambda states: states[0], observed, truth, search, in_force
        )

    np.testing.assert_array_equal(found(schedules), 4.0)
    wrong = schedules.copy()
    wrong[:, -15] += 1.0  # 15 steps before the event: only later starts do not pass it
    np.testing.assert_array_equal(found(wrong), 1.0)


def test_classifiers_learn_from_what_is_known():
    generator = np.random.default_rng(5)
    washouts, known = generator.normal(size=(1500, 3, 2)), generator.normal(size=(1500, 2))
    happened = (known[:, 1] + washouts[:, -1, 0] > 1.5)[:, np.newaxis]
    series = np.arange(1500) // 150
    for kind in ("precursor", "esn_direct"):
        options = {**options_of_kind(kind), "random_seed": 1, "lags_lt": [], "penalty": [1]}
        options |= {"classifier": "logistic", "neurons": 40, "connectivity": 3}
        if kind == "precursor":
            options |= {"penalty": 1, "degree": 1}
        case = replace(SIMULATED, options=options)
        scores = []
        for features in (None, known):
            points = LabelledPoints(washouts, happened, series, features).of(
                series < 7, np.array([True])
            )
            fitted = classifier_class(kind).fit(points, case)
            later = None if features is None else features[series >= 7]
            chance = fitted.probabilities(washouts[series >= 7], later)[:, 0]
            scores.append(np.mean((chance - happened[series >= 7, 0]) ** 2))
            again = classifier_class(kind).restore(fitted.record(), case)
            same = again.probabilities(washouts[series >= 7], later)[:, 0]
            np.testing.assert_array_equal(same, chance)
        assert scores[1] < 0.5 * scores[0], kind

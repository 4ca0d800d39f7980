"""Control of a user's system, beside a loop that is written out with public methods alone."""

import functools
from dataclasses import dataclass, replace

import numpy as np
import pytest

import burstcast
from burstcast.control.strategies.base import SampledStrategy
from burstcast.control.strategies.planned import Planned
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.strategies.probability_triggered import ProbabilityTriggered
from burstcast.control.strategies.reactive import Reactive
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.event_forecaster.closed_loop import SCORES
from burstcast.forecasters.base import Forecaster
from burstcast.systems.integration import integrate, integrate_switched
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.lorenz96 import Lorenz96

FREE, REDUCED = Lorenz63(rho=28.0), Lorenz63(rho=24.0)
THRESHOLD, SAMPLES = 40.0, 400  # eight of its durations, 1 for 50 samples
LOOKS = RecedingHorizon(decision_interval_lt=0.1, horizon_lt=0.6)


@functools.cache
def series():
    start = np.array([[1.0], [1.0], [20.0]]) + np.random.default_rng(0).normal(size=(3, 16))
    return integrate(FREE, start, 0.01, 2200, stride=2)[500:].transpose(2, 0, 1)


@functools.cache
def fitted(kind="nvar", **changes):
    times = {"prediction_times": (0.2,), "window": 0.4, "washout": 0.5, "lyapunov_time": 1.0}
    times |= {"sampling_interval": 0.02, "sampling_stride": 2, "calibrate": False}
    options = {
        "precursor": {"start_spacing_lt": 0.4, "folds": 2},
        "quadratic_aware": {"parameters": ["rho"], "transform": "identity"},
    }
    settings = {**times, "options": options.get(kind), **changes}
    forecaster = burstcast.EventForecaster(FREE, THRESHOLD, kind=kind, **settings)
    parameters = np.linspace(24, 30, 8) if kind == "quadratic_aware" else None
    return forecaster.fit(series()[:8], parameters=parameters)


def controlled(strategy=LOOKS, forecaster=None, observed=None, system=FREE, **changes):
    return burstcast.control_system(
        system,
        forecaster or fitted(),
        strategy,
        series()[8:, :60] if observed is None else observed,
        **{"actuation": {"rho": 24.0}, "duration": 8, **changes},
    )


@pytest.mark.parametrize("delay", [0, 3])  # samples
def test_the_loop_is_a_plain_one(delay):
    states, forecaster = series()[8:, :60], fitted()
    coming = np.zeros((8, delay), dtype=bool)  # decided, without effect yet
    actuated = np.zeros((8, 1), dtype=bool)
    while actuated.shape[1] <= SAMPLES + delay:
        alarm = (forecaster.forecast(states, 0.6)[0, :, :, 2] >= THRESHOLD).any(axis=1)
        coming = np.concatenate([coming, alarm[:, np.newaxis].repeat(5, axis=1)], axis=1)
        now, coming = coming[:, :5], coming[:, 5:]
        choice = now.T.repeat(2, axis=0).astype(np.uint8)
        further = integrate_switched((FREE, REDUCED), choice, states[:, -1].T, 0.01, stride=2)
        states = np.concatenate([states, further[1:].transpose(2, 0, 1)], axis=1)
        actuated = np.concatenate([actuated, now], axis=1)
    run = controlled(delay=0.02 * delay)
    samples = SAMPLES + delay + 1
    assert actuated.any()
    np.testing.assert_array_equal(run.actuated, actuated[:, :samples])
    np.testing.assert_array_equal(run.states, states[:, 59 : 59 + samples])
    np.testing.assert_array_equal(run.free_states, series()[8:, 59 : 59 + samples])
    np.testing.assert_array_equal(run.observable, run.states[..., 2])
    np.testing.assert_allclose(run.time, 0.02 * np.arange(samples))
    # the delay is not counted: nothing could be done yet
    counted = slice(delay + 1, None)
    force = np.abs(4.0 * run.states[:, counted, 0]) * run.actuated[:, counted]
    expected = {
        "exceedance_uncontrolled": (run.free_observable[:, counted] >= THRESHOLD).mean(),
        "exceedance_controlled": (run.observable[:, counted] >= THRESHOLD).mean(),
        "control_fraction": run.actuated[:, counted].mean(),
        "effort": force.mean(),
    }
    for name, value in expected.items():
        score = run.scores[name]
        assert score.value == pytest.approx(value, rel=1e-12)
        # an exceedance of zero has no upper bound
        assert score.low <= value <= (score.high if value > 0 else np.inf)
        assert value > 0 or np.isnan(score.high) == name.startswith("exceedance")
    assert list(run.scores) == list(SCORES)
    assert expected["exceedance_controlled"] < 0.5 * expected["exceedance_uncontrolled"]


def test_durations_are_those_of_the_forecaster():
    samples = {"washout": 25.0, "prediction_times": (10.0,), "window": 20.0}
    in_samples = fitted(lyapunov_time=None, calibration_spacing=5.0, **samples)
    counted_in_samples = controlled(RecedingHorizon(5, 30), in_samples, duration=SAMPLES)
    expected, name = controlled(), "switchings_per_lyapunov_time"
    np.testing.assert_array_equal(counted_in_samples.states, expected.states)
    rate = counted_in_samples.scores[name].value
    assert expected.scores[name].value == pytest.approx(50 * rate)


@dataclass(frozen=True)
class LastSample(SampledStrategy):
    """Records what it observes, and never acts."""

    def policy(self, experiment, forecaster):
        assert forecaster is None

        def decide(look):
            SEEN.append(look.washout.copy())
            return np.zeros(len(look.rows), dtype=bool)

        return decide


SEEN: list[np.ndarray] = []


def test_a_strategy_of_ones_own_without_forecasts_sees_the_noise():
    SEEN.clear()
    run = controlled(LastSample(0.2), noise=0.1, duration=40)
    assert not run.actuated.any()
    assert run.scores["relative_exceedance"].value == 1
    looks = np.array(SEEN)[:-1]  # (looks, steps, component, flow)
    truth = run.states[:, 10 * np.arange(len(looks))].transpose(1, 2, 0)
    deviation = (looks[:, -1] - truth).std(axis=(0, 2)) / series()[8:, :60].std(axis=(0, 1))
    np.testing.assert_allclose(deviation, 0.1, rtol=0.1)


def test_forecasters_of_each_form_control():
    aware = fitted("quadratic_aware")
    strategies = {
        Planned(0.1, 0.8, starts_lt=(0.0, 0.2), durations_lt=(0.1, 0.2, 0.4)): aware,
        replace(LOOKS, aware=True): aware,
        ProbabilityTriggered(0.1, probability=0.4, hold_lt=0.6): fitted("precursor"),
        replace(LOOKS, vote_share=0.3): fitted("analogues"),
        PredictionTriggered(0.2, 0.4): fitted(),
        Reactive(0.1, level=33.0): fitted(),
    }
    for strategy, forecaster in strategies.items():
        run = controlled(strategy, forecaster, pulse=(-0.2, 0.8))
        assert 0 < run.scores["control_fraction"].value < 0.8, strategy
        assert run.scores["relative_exceedance"].value < 0.8, strategy


def test_a_force_pushes_either_way():
    pushing = Reactive(0.1, level=30.0, push="x")
    run = controlled(pushing, actuation=None, force=[-8.0, 0, 0])
    assert run.scores["effort"].value == pytest.approx(
        8 * run.scores["control_fraction"].value, rel=1e-12
    )


@dataclass(frozen=True)
class OtherObservable(Lorenz63):
    def observable(self, state):
        return np.array(state[0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"system": OtherObservable()}, "the observable of the system differs"),
        (
            {"system": Lorenz96(variables=4)},
            "have 4 components, the series of the forecaster had 3",
        ),
        (
            {"strategy": Planned(0.1, 0.8, durations_lt=(0.1,))},
            "take a kind that learns parameters",
        ),
        ({"strategy": ProbabilityTriggered(0.1, 0.4, 0.6)}, "precursor or esn_direct"),
        ({"forecaster": "precursor"}, "classifiers do not have"),
        ({"actuation": None}, "changes a parameter of the equations or adds a force"),
        ({"actuation": {"r": 1.0}}, "its parameters are sigma, rho, beta"),
        ({"observed": np.ones((2, 7, 3))}, "the washout takes 25 samples, the series have 7"),
    ],
)
def test_what_does_not_fit_is_refused(changes, message):
    forecaster = fitted(changes.get("forecaster", "nvar"))
    with pytest.raises(ValueError, match=message):
        controlled(**{**changes, "forecaster": forecaster})


# -- forecasters that do not know ------------------------------------------------------------------


@dataclass(frozen=True)
class Exploding(Forecaster):
    """Doubles a component from step to step, whatever it has learnt: none of it is a forecast."""

    def fit(self, training, case):
        return self

    def start(self, washout):
        return np.abs(washout[-1]) + 1.0

    def advance(self, memory, steps):
        outputs = memory * 2.0 ** np.arange(1, steps + 1)[:, np.newaxis, np.newaxis]
        return outputs, outputs[-1]


def fitted_in_vain(**changes):
    with pytest.warns(UserWarning, match="invalid"):
        return burstcast.EventForecaster(
            FREE,
            THRESHOLD,
            kind=Exploding(),
            **{"prediction_times": (0.2,), "window": 0.4, "washout": 0.5, "lyapunov_time": 1.0},
            **{"sampling_interval": 0.02, "sampling_stride": 2, "calibrate": True, **changes},
        ).fit(series()[:8])


def test_a_forecaster_of_which_no_forecast_is_valid_is_told_and_the_fallback_controls():
    """The forecasts are finite all the way, and above the threshold on their way."""
    forecaster = fitted_in_vain()
    text = " ".join(forecaster.warnings_)
    assert "100.0% of the forecasts of the kept models in training series are invalid" in text
    assert "100.0% of the forecasts of series that were left out are invalid" in text
    assert "likely cause" in text
    seen = series()[8:, :60]
    with pytest.warns(UserWarning, match="100.0% of the forecasts behind 8 of 8 probabilities"):
        assert np.ptp(forecaster.predict_proba(seen)[:, 1]) == 0
    assert forecaster.valid_share(seen).tolist() == [0.0] * 8
    with pytest.warns(UserWarning, match="of the forecasts over 30 samples are invalid"):
        ahead = forecaster.forecast(seen)
    assert np.isnan(ahead[:, :, -1]).all()
    assert np.isfinite(ahead[:, :, 0]).all()
    scores = forecaster.scores(series()[8:])
    assert (scores["invalid_fraction"], scores["roc_area"]) == (1.0, 0.5)
    assert forecaster.unskilled_times_ == [0.2]
    expected = {"reactive": None, "off": 0.0, "on": 1.0}
    for fallback, share in expected.items():
        with pytest.warns(UserWarning, match="calibration") as told:
            run = controlled(replace(LOOKS, fallback=fallback), forecaster)
        texts = [str(warning.message) for warning in told]
        assert any("without skill in its own calibration (prediction times 0.2" in t for t in texts)
        assert any("100.0% of the decisions have no valid forecast" in t for t in texts)
        assert run.scores["fallback_fraction"].value == 1.0
        if share is None:  # on the observable alone, at a level halfway to the threshold
            level = 0.5 * (seen[:, -25:, 2].mean() + THRESHOLD)
            looks = run.observable[:, :SAMPLES:5] >= level
            np.testing.assert_array_equal(run.actuated[:, 1 : SAMPLES + 1 : 5], looks)
        else:
            assert run.scores["control_fraction"].value == share


def test_a_flow_that_escapes_is_counted_and_told():
    """The force takes whom it acts on out of the range of numbers; the others go on."""
    rule, force = Reactive(0.1, 40.0), {"actuation": None, "force": [1e200, 0.0, 0.0]}
    with pytest.warns(UserWarning, match="4 of 8 flows leave the range .* weaker actuation"):
        run = controlled(rule, duration=3, references=False, **force)
    lost = run.actuated.any(axis=1)
    assert lost.sum() == 4
    assert np.isnan(run.states[lost, -1]).all()
    np.testing.assert_array_equal(run.states[~lost], run.free_states[~lost])
    assert run.scores["escaped_fraction"].value == 4 / 8
    assert run.scores["control_fraction"].value == 0.0


def test_a_run_has_references_that_know_nothing():
    run = controlled()
    always, by_chance = run.references["always"], run.references["random"]
    assert always["control_fraction"].value == 1.0
    duty = run.scores["control_fraction"].value
    assert by_chance["control_fraction"].value == pytest.approx(duty, rel=0.15)
    left = run.scores["relative_exceedance"].value
    assert left < by_chance["relative_exceedance"].value
    # the state under constant actuation is another system's own
    start = series()[8:, 59].T
    free = integrate(REDUCED, start, 0.01, 2 * SAMPLES, stride=2)[1:, 2]
    expected = (free >= THRESHOLD).mean() / run.scores["exceedance_uncontrolled"].value
    assert always["relative_exceedance"].value == pytest.approx(expected, rel=1e-9)
    assert controlled(references=False).references == {}
    text = repr(run)
    assert text.count("\n") < 20
    assert "relative_exceedance" in text
    assert "actuation random: relative exceedance" in text


def test_control_that_is_no_better_than_chance_is_told():
    """Acting on a high observable comes too late, and leaves more than acting at random."""
    with pytest.warns(UserWarning, match="the decisions are no better than chance"):
        run = controlled(Reactive(0.1, level=30.0))
    chance = run.references["random"]["relative_exceedance"].value
    assert run.scores["relative_exceedance"].value > chance

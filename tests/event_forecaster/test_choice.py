"""The best kind for some series: what is tried, scored, chosen, and said."""

import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from test_event_forecaster import lorenz

from burstcast.event_forecaster.choice import (
    LeftOutForecasts,
    Trial,
    _stays_finite,
    cost,
    findings,
)
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.forecasters._options import resolved_by_samples
from burstcast.forecasters.registry import make_kind
from burstcast.forecasts.probabilities import rounded
from burstcast_workflow.commands.choose import table

pytestmark = pytest.mark.filterwarnings("ignore")
SERIES = lorenz(8, 700, 1)
KINDS = ["linear_inverse", "analogues", "quadratic"]


def automatic(kinds, **changes):
    given = {"observable": 2, "event_threshold": 35.0, "lyapunov_time": 1.1, "kind": "auto"}
    given |= {"sampling_interval": 0.02, "prediction_times": (0.5, 1.0)}
    return EventForecaster(**{**given, **changes}, options={"kinds": kinds})


@pytest.fixture(scope="module")
def chosen():
    return automatic(KINDS).fit(SERIES[:6])


def test_the_choice_is_the_kind_itself(chosen, tmp_path):
    assert chosen.kind_ == "quadratic"
    plain = EventForecaster(**{**chosen.get_params(), "kind": "quadratic", "options": None})
    expected = plain.fit(SERIES[:6]).predict_proba(SERIES[6:])
    np.testing.assert_array_equal(chosen.predict_proba(SERIES[6:]), expected)
    assert chosen.get_params()["kind"] == "auto"
    chosen.save(tmp_path / "f.nc")
    loaded = EventForecaster.load(tmp_path / "f.nc")
    assert loaded.kind == "quadratic"
    np.testing.assert_array_equal(loaded.predict_proba(SERIES[6:]), expected)
    assert chosen.forecast(SERIES[6:]).shape[1:] == (2, chosen._timing.boundaries[-1], 3)


@pytest.mark.parametrize("kind", ["analogues", "linear_inverse"])
def test_skills_are_those_of_series_that_were_left_out(kind):
    """Against probabilities that are calibrated fold by fold, and summed one by one."""
    chosen = automatic([kind]).fit(SERIES[:6])
    (trial,) = chosen.choices_
    skills = []
    for left_out in chosen.left_out_.values():
        errors, base = 0.0, 0.0
        for row in range(6):
            here = left_out.series == row
            others = LeftOutForecasts(
                **{
                    name: value[~here] if isinstance(value, np.ndarray) else value
                    for name, value in vars(left_out).items()
                }
            )
            rule = chosen_rule(others)
            happened = left_out.happened[here].astype(float)
            errors += ((rule(left_out.values[here]) - happened) ** 2).sum()
            base += ((others.happened.mean() - happened) ** 2).sum()
        skills.append(1 - errors / base)
    assert abs(trial.brier_skill) < 0.5  # without errors, the base rate would not matter
    assert trial.brier_skill == pytest.approx(np.mean(skills))
    assert trial.low <= trial.brier_skill <= trial.high


def chosen_rule(left_out):
    """Isotonic calibration with its prior, of levels counted here."""
    from burstcast.forecasts.alarms import isotonic
    from burstcast.forecasts.scores import Outcomes

    levels = np.unique(left_out.values)
    points = np.array([(left_out.values == level).sum() for level in levels])
    events = np.array([left_out.happened[left_out.values == level].sum() for level in levels])
    return isotonic(Outcomes(levels, points, events), left_out.prior)


def test_what_was_tried_is_told(chosen):
    assert [trial.kind for trial in chosen.choices_] == KINDS
    by_kind = {trial.kind: trial for trial in chosen.choices_}
    assert by_kind["quadratic"].error == 0
    assert by_kind["linear_inverse"].brier_skill < by_kind["quadratic"].low
    assert all(trial.seconds > 0 for trial in chosen.choices_)


def test_of_equal_kinds_the_cheaper_is_chosen():
    same = automatic(["quadratic", "quadratic_filtered"]).fit(SERIES[:6])
    assert same.kind_ == "quadratic"


def test_a_kind_that_cannot_be_fitted_is_told_and_left_out():
    made = automatic(["quadratic", "analogues", "equations"]).fit(SERIES[:6])
    (failed,) = [trial for trial in made.choices_ if trial.remark]
    assert failed.kind == "equations"
    with pytest.raises(ValueError, match="no kind can be fitted: equations: "):
        automatic(["equations"]).fit(SERIES[:6])


def red_noise(series, samples):
    states = np.random.default_rng(0).normal(size=(series, samples, 1))
    for step in range(1, samples):
        states[:, step] += 0.8 * states[:, step - 1]
    return states


@pytest.mark.parametrize("samples", [1, 6])
def test_coarse_samples_exclude_no_kind(samples, tmp_path):
    """The nearest durations that samples resolve are taken, said, and those of a fit by hand."""
    coarse, kinds = red_noise(8, 90), ["quadratic_filtered", "precursor", "esn_direct"]
    given = {"sampling_interval": 0.2, "lyapunov_time": 0.2 * samples, "prediction_times": (1.0,)}
    given |= {"observable": 0, "event_threshold": {"quantile": 0.8}}
    made = automatic(kinds, **given).fit(coarse[:6])
    assert not [trial.remark for trial in made.choices_ if trial.remark]
    by_kind = {trial.kind: trial for trial in made.choices_}
    washout = max(1, samples // 2)
    assert by_kind["esn_direct"].options == {"start_spacing_lt": 1 / samples}
    lags = tuple(lag / samples for lag in (1, 2) if lag < min(washout, samples))
    assert by_kind["precursor"].options["lags_lt"] == lags
    window = by_kind["quadratic_filtered"].options
    assert window == ({} if samples > 4 else {"window_lt": 1 / samples})
    chosen = by_kind[made.kind_]
    assert made.options_ == chosen.options
    assert (chosen.adapted in made.warnings_) == bool(chosen.options)
    by_hand = EventForecaster(
        **{**made.get_params(), "kind": made.kind_, "options": chosen.options or None}
    )
    expected = by_hand.fit(coarse[:6]).predict_proba(coarse[6:])
    np.testing.assert_array_equal(made.predict_proba(coarse[6:]), expected)
    made.save(tmp_path / "f.nc")
    loaded = EventForecaster.load(tmp_path / "f.nc")
    np.testing.assert_array_equal(loaded.predict_proba(coarse[6:]), expected)


def test_the_table_of_a_campaign_has_other_options_below_it():
    trials = [
        Trial("analogues", 0.25, 0.125, 0.5, seconds=2),
        Trial("precursor", 0.5, 0.25, 0.75, seconds=3, options={"lags_lt": (1 / 3, 2 / 3)}),
        Trial("esn", remark="the series are too short"),
    ]
    _, *rows, note = table(trials, "precursor")
    assert rows[0].split() == ["analogues", "0.250", "0.125", "to", "0.500", "2.0"]
    assert rows[1].split()[-1] == "chosen"
    assert rows[2].endswith("not fitted: the series are too short")
    assert note.startswith("precursor has lags_lt=[0.333, 0.667], the nearest to its defaults")


def test_lags_are_different_samples_of_the_washout():
    def lags(samples, washout, *given):
        kind = make_kind("precursor", {"lags_lt": given or (0.1, 0.2, 0.3, 0.4)})
        return resolved_by_samples(kind, samples, washout).get("lags_lt")

    assert lags(20, 10) is None
    assert lags(6, 3) == (1 / 6, 2 / 6)
    assert lags(1, 1) == ()
    assert lags(1, 3, 1.0, 2.0, 3.0, 4.0) == (1.0, 2.0)


def test_noise_has_no_best_kind():
    noise = np.random.default_rng(0).normal(size=(6, 400, 1)).cumsum(axis=1) * 0
    noise += np.random.default_rng(1).normal(size=noise.shape)
    made = automatic(
        ["linear_inverse", "analogues"], observable=0, event_threshold={"quantile": 0.98}
    )
    made.set_params(lyapunov_time=None, prediction_times=(3,), window=6, washout=5).fit(noise)
    assert made.warnings_[0].startswith("no kind beats the base rate: the best, ")
    assert list(findings([Trial("esn", 0.2, 0.1, 0.3)], "esn", 40)) == []


def test_a_washout_that_is_as_long_as_a_cycle_is_told():
    """Each washout of eleven years has a maximum of the cycle: few starting points are left."""
    years = np.arange(200.0)
    cycle = np.sin(2 * np.pi * years / 11) + 0.2 * np.random.default_rng(0).normal(size=200)
    given = {"event_threshold": {"quantile": 0.87}, "prediction_times": (2,), "window": 3}
    given |= {"kind": "analogues", "calibration_spacing": 1}
    told = EventForecaster(0, washout=11, **given).fit(cycle[np.newaxis, :, np.newaxis]).warnings_
    (found,) = [text for text in told if "shorten washout" in text]
    counts = found.split(" starting")[0].split(" of ")
    assert int(counts[0]) < 0.25 * int(counts[1])
    short = EventForecaster(0, washout=3, **given).fit(cycle[np.newaxis, :, np.newaxis]).warnings_
    assert not [text for text in short if "shorten washout" in text]


def test_the_cost_is_said_before():
    with pytest.warns(UserWarning, match="fits analogues, which takes some .* on one core"):
        automatic(["analogues"]).fit(SERIES[:6])
    sizes = {"neurons": 1000, "searches": 2, "grid": 3, "bayesian_points": 1, "members": 4}
    said = cost(["esn", "nvar"], np.zeros((10, 2000, 2)), automatic(["esn"], **sizes))
    # 24 sets of hyperparameters or networks of ten times 100 neurons; 20,000 samples
    of_networks = 2 * 0.04 * 24 * 10**1.3
    assert f"takes some {rounded(of_networks + 2 * 0.1)} on one core" in said
    assert f"{rounded(of_networks)} of them for esn" in said


def test_what_fits_of_a_trial_warn_of_is_said_of_the_chosen_kind_alone():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        # parameters of its own: what was said once for some is not repeated
        made = automatic(["linear_inverse", "analogues"], event_threshold=34.5)
        made.fit(SERIES[:6], verbose=False)
    assert len([one for one in caught if "signs of a weak forecaster" in str(one.message)]) <= 1


@pytest.mark.parametrize(("finite", "stays"), [(0.95, True), (0.85, False)])
def test_forecasts_of_a_kind_are_finite_but_for_few(finite, stays):
    forecasts = np.zeros((100, 1, 5, 2))  # (series, members, steps, components)
    forecasts[: round(100 * (1 - finite)), :, 3] = np.nan
    made = SimpleNamespace(
        members_=[None],
        kind="nvar",
        left_out_={1.0: SimpleNamespace(reach=2)},
        forecast=lambda states: forecasts,
    )
    assert _stays_finite(made, np.zeros((100, 20, 2))) == stays


@pytest.mark.parametrize(
    ("options", "changes", "message"),
    [
        ({"neighbours": 3}, {}, r"options of the kind 'auto' are kinds=\[...\]"),
        ({"kinds": "esn"}, {}, r"options of the kind 'auto' are kinds=\[...\]"),
        ({"kinds": []}, {}, r"options of the kind 'auto' are kinds=\[...\]"),
        ({}, {"calibrate": False}, "it needs calibrate=True"),
    ],
)
def test_mistakes_are_told(options, changes, message):
    with pytest.raises(ValueError, match=message):
        automatic([], **changes).set_params(options=options).fit(SERIES[:6])

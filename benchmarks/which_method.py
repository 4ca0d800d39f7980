"""Which method, when: kinds of forecasters by training events, noise, and what is observed.

::

    python benchmarks/which_method.py [--flows FLOW ...] [--kinds KIND ...] [--events EVENTS ...]
    python benchmarks/which_method.py compare

Flows: the shear flow at Re = 400, Lorenz 96 with ten variables, the Kuramoto-Sivashinsky equation
on a length of 22, and the Kolmogorov flow at Re = 40 in quantities that a shift does not change.
Each fit of `EventForecaster` adds rows to docs/results/which_method/scores.csv, one for each
prediction time; rows that are there are not made again. Training series are the first ones that
have a number of events; of noise and observed components, one is varied at a time, at `MIDDLE`
events. All kinds have the same series, starting points and noise, and their defaults but for
`SETTINGS` and `OPTIONS`.

Scores, with 95 % intervals over resampled test series: average precision of the largest observable
that is forecast for the window (of classifiers: of the probability), Brier skill of the calibrated
probabilities, and F of the alarms. Points that no event follows are thinned to one in `THINNING`,
with as many times the weight. `compare` writes best.csv, the best kind of each condition and its
paired differences from the others.
"""

import argparse
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from default_forecasters import energy
from shear_flow_starts import SYSTEM, true_series

from burstcast import EventForecaster
from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.base.threads import single_threaded
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.events import upward_crossings
from burstcast.event_forecaster.events import Events, EventTiming
from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasts.points import ObservedPoints, observed_points
from burstcast.forecasts.scores import (
    ONSET,
    Window,
    ranking_scores,
)
from burstcast.forecasts.windows import window_forecasts
from burstcast.systems.integration import integrate
from burstcast.systems.kuramoto_sivashinsky import KuramotoSivashinsky
from burstcast.systems.lorenz96 import Lorenz96

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "docs" / "results" / "which_method"
OUTCOMES = ROOT / "results" / "which_method"
"""Series of the slow flow and probabilities of each fit, from which the comparison is made."""

SEED, THINNING, RESAMPLES = 2026, 4, 1000
TIMES = (1.0, 3.0)
EVENTS, MIDDLE = (5, 10, 20, 40, 100, 300, 1000), 40
NOISE, NOISES = 0.01, (0.0, 0.1)
ALL, SHARES = "all", ("half", "few")
CALIBRATION_POINTS = 1000
"""Starting points that calibrate, about: their spacing grows with the training series."""
SETTINGS = {"neurons": 300, "members": 4, "searches": 1, "grid": 3, "bayesian_points": 3}
OPTIONS: dict[str, dict[str, Any]] = {"esn_direct": {"neurons": 300}}
LARGER = {"esn_1000": ("esn", 1000)}
"""Kinds with more neurons, as rows of their own: the kind, and how many."""
UNCALIBRATED = ("quadratic",)
"""Kinds whose leave-one-out fits take too long here: their probabilities are shares of votes."""
KINDS = {
    "quadratic_filtered": 100,
    "analogues": 1000,
    "nvar": 300,
    "esn": 1000,
    "precursor": 1000,
    "esn_direct": 1000,
    "esn_1000": 100,
    "esn_filtered": 100,
    "quadratic": 40,
}
"""Kinds, cheap ones first, and the most events that each learns from here."""


@dataclass(frozen=True)
class Flow:
    """True series of a flow, and what forecasters are told of it."""

    states: FloatArray  #: training series, then test series, ``(series, time, component)``
    observable: Callable[[FloatArray], FloatArray]  #: of states ``(..., component)``
    lyapunov_time: float
    sampling_interval: float
    tests: int
    half: list[int]  #: components
    few: list[int]
    washout: float  #: in Lyapunov times
    #: event threshold, or the quantile of the observable in all training series
    threshold: float | dict[str, float]
    #: kinds that are left out, and why
    without: dict[str, str] = field(default_factory=lambda: {"quadratic": "it has a filter"})
    most_events: int = 1000
    #: options that differ from the defaults of kinds, by kind
    options: dict[str, dict[str, Any]] = field(default_factory=dict)


def shear_flow() -> Flow:
    """The paper's flow; series of 66 Lyapunov times."""
    states = true_series(700)

    def kinetic_energy(states: FloatArray) -> FloatArray:
        return np.asarray(SYSTEM.observable(np.moveaxis(states, -1, 0)))

    half, few = [0, 2, 4, 6, 8], [0, 2]
    return Flow(states, kinetic_energy, 1 / 0.0163, 1.0, 60, half, few, 0.5, 0.1)


def lorenz96() -> Flow:
    """Ten variables at F = 8; series of 24 Lyapunov times."""
    start = 8 + np.random.default_rng(0).normal(size=(10, 800))
    states = integrate(Lorenz96(variables=10), start, 0.01, 2000 + 1996, stride=4)[500:]
    states, half, few = states.transpose(2, 0, 1), [0, 2, 4, 6, 8], [0, 2]
    return Flow(states, energy, 1 / 1.2, 0.04, 150, half, few, 1.0, {"quantile": 0.95})


def kuramoto_sivashinsky() -> Flow:
    """Eight wavenumbers on a length of 22, 83 samples in a Lyapunov time; series of 24 of these."""
    system = KuramotoSivashinsky(wavenumbers=8)
    start = system.sample_initial_states(500, np.random.default_rng(0))
    states = integrate(system, start, 0.25, 1600 + 1999, stride=1)[1600:]

    def mean_square(states: FloatArray) -> FloatArray:
        return np.asarray(system.observable(np.moveaxis(states, -1, 0)))

    odd, few = [0, 2, 4, 6, 8, 10, 12, 14], [0, 2, 8]
    states, rare = states.transpose(2, 0, 1), {"quantile": 0.98}
    without = {"quadratic_filtered": "its filter takes minutes: quadratic is in its place"}
    return Flow(states, mean_square, 1 / 0.048, 0.25, 100, odd, few, 1.0, rare, without)


def kolmogorov() -> Flow:
    """Invariants and dissipation of the Kolmogorov flow; series of 30 Lyapunov times."""
    sys.path.append(str(ROOT / "examples" / "kolmogorov"))
    from kolmogorov_flow import KolmogorovFlow

    flow, kept = KolmogorovFlow(), OUTCOMES / "kolmogorov.npy"
    if not kept.exists():
        kept.parent.mkdir(parents=True, exist_ok=True)
        start = flow.sample_initial_states(30, np.random.default_rng(0))
        amplitudes = integrate(flow, start, 0.1, 3000 + 19995, stride=5)[600:]
        seen = np.concatenate(
            [
                flow.invariants(amplitudes.swapaxes(0, 1)),
                flow.observable(amplitudes.swapaxes(0, 1))[np.newaxis],
            ]
        )
        np.save(kept, seen.transpose(2, 1, 0))
    states = np.load(kept)
    # cut into pieces of a trajectory, which lie side by side: the last ten trajectories test
    pieces = states.reshape(-1, 500, states.shape[2])
    names = [*flow.invariant_names]
    half = [*range(0, len(names), 2)]
    few = [names.index(name) for name in ("modulus_1_0", "mean_flow_real", "mean_flow_imaginary")]
    no_system = "the invariants are too many for its features, and no closed system"
    return Flow(
        pieces,
        lambda states: states[..., -1],
        1 / 0.122,
        0.5,
        80,
        half,
        few,
        1.0,
        0.195,
        without=dict.fromkeys(("quadratic", "quadratic_filtered", "nvar"), no_system),
        most_events=300,
        # as in examples/kolmogorov/campaign.yaml: with 61 components, more lags take minutes
        options={
            "precursor": {"lags_lt": (0.25, 0.5), "start_spacing_lt": 0.25},
            "esn_direct": {"start_spacing_lt": 0.25},
        },
    )


FLOWS = {
    flow.__name__: cache(flow) for flow in (shear_flow, lorenz96, kuramoto_sivashinsky, kolmogorov)
}


class Condition(NamedTuple):
    """What a forecaster learns from."""

    varied: str  #: "events", "noise" or "observed"
    events: int
    noise: float = NOISE
    observed: str = ALL


def conditions() -> Iterator[Condition]:
    """All conditions of a flow: the middle ones first."""
    few, middle, many = EVENTS[:3], MIDDLE, EVENTS[4:]
    for events in (middle, *few[::-1], *many):
        yield Condition("events", events)
    for noise in NOISES:
        yield Condition("noise", MIDDLE, noise=noise)
    for observed in SHARES:
        yield Condition("observed", MIDDLE, observed=observed)


@dataclass(frozen=True)
class Data:
    """Series of a flow under a condition; training series without noise."""

    training: FloatArray
    threshold: float
    observable: Callable[[FloatArray], FloatArray]
    events: int  #: in the training series
    points: ObservedPoints  #: starting points in the test series, thinned
    happened: dict[float, BoolArray]
    weights: IntArray  #: of the points
    timing: EventTiming
    washout: float


@cache
def data(name: str, condition: Condition) -> Data:
    """Training series with a number of events, and thinned starting points in the test series."""
    flow = FLOWS[name]()
    true = flow.observable(flow.states)
    threshold = flow.threshold
    if not isinstance(threshold, float):
        threshold = float(np.quantile(true[: -flow.tests], threshold["quantile"]))
    by_series = upward_crossings(true[: -flow.tests], threshold).sum(axis=1)
    total = by_series.cumsum()
    if total[-1] < condition.events:
        raise ValueError(f"{name}: {total[-1]} events in all training series")
    number = max(2, int(np.searchsorted(total, condition.events)) + 1)
    states, observable = flow.states, flow.observable
    if condition.observed != ALL:
        seen = states[..., getattr(flow, condition.observed)]
        states, observable = np.dstack([seen, true]), _last
    scales = component_scales(states[: -flow.tests])
    observed = observed_series(
        states[-flow.tests :], 0, condition.noise, scales, SEED, f"tests of {name}"
    )
    timing = EventTiming(flow.lyapunov_time, flow.sampling_interval, TIMES, 1.0)
    events, unit = Events(timing, threshold), timing.unit
    points = observed_points(
        observed,
        true[-flow.tests :],
        lambda batch: observable(np.moveaxis(batch, 0, -1)),
        spacing=unit,
        washout=timing.samples("washout", flow.washout),
        boundaries=timing.boundaries,
    )
    followed = np.logical_or.reduce([events.happened(points, time) for time in TIMES])
    drawn = random_streams.stream(SEED, "points without events").random(len(followed))
    taken = events.quiet(points) & (followed | (drawn < 1 / THINNING))
    points = _of_points(points, taken)
    weights = np.where(followed[taken], 1, THINNING)
    happened = {time: events.happened(points, time) for time in TIMES}
    return Data(
        states[:number],
        threshold,
        observable,
        int(total[number - 1]),
        points,
        happened,
        weights,
        timing,
        flow.washout,
    )


def _last(states: FloatArray) -> FloatArray:
    """The last component: the observable, where not all of the others are observed."""
    return np.asarray(states[..., -1])


def _of_points(points: ObservedPoints, taken: BoolArray) -> ObservedPoints:
    where, truth = points.points, points.truth
    return ObservedPoints(
        type(where)(where.series[taken], where.step[taken]),
        points.washouts[taken],
        points.seen[taken],
        type(truth)(**{name: values[taken] for name, values in vars(truth).items()}),
    )


class Fit(NamedTuple):
    """Forecasts of one forecaster from the starting points, by prediction time."""

    strength: dict[float, FloatArray]
    probability: dict[float, FloatArray]
    threshold: dict[float, float]
    invalid: dict[float, float]
    seconds: tuple[float, float]  #: of the fit with its calibration, and of the forecasts


def fitted(kind: Any, options: dict[str, Any], here: Data, condition: Condition) -> Fit:
    """Fit a kind, and forecast from all starting points."""
    timing = here.timing
    kind, neurons = LARGER.get(kind, (kind, SETTINGS["neurons"]))
    spacing = here.training.shape[0] * here.training.shape[1] / timing.unit / CALIBRATION_POINTS
    forecaster = EventForecaster(
        here.observable,
        here.threshold,
        kind=kind,
        options=options or None,
        calibrate=kind not in UNCALIBRATED,
        prediction_times=TIMES,
        lyapunov_time=timing.lyapunov_time,
        sampling_interval=timing.sampling_interval,
        noise=condition.noise,
        washout=here.washout,
        calibration_spacing=max(0.25, spacing),
        random_seed=SEED,
        **SETTINGS | {"neurons": neurons},
    )
    began = time.process_time()
    forecaster.fit(here.training)
    learnt = time.process_time()
    washouts, events = here.points.washouts, Events(timing, here.threshold)
    if isinstance(forecaster.members_[0], EventClassifier):
        shares = events.by_time(forecaster.members_[0].probabilities(washouts))
        strength, invalid = shares, dict.fromkeys(TIMES, 0.0)
    else:
        forecasts = [
            window_forecasts(
                member,
                lambda batch: here.observable(np.moveaxis(batch, 0, -1)),
                washouts,
                timing.boundaries,
            )
            for member in forecaster.members_
        ]
        votes = [each for forecast in forecasts for each in forecast.members]
        shares = events.shares(votes)
        invalid = {time: float(1 - each.mean()) for time, each in events.valid(votes).items()}
        strength = {}
        for ahead in TIMES:
            window = Window(*timing.windows(ahead), here.threshold)
            each = [window.strength(forecast, ONSET) for forecast in forecasts]
            strength[ahead] = np.mean(each, axis=0)
    rules = forecaster.alarms_
    return Fit(
        strength,
        {ahead: rules[ahead].calibration(share) for ahead, share in shares.items()},
        {ahead: rules[ahead].threshold for ahead in TIMES},
        invalid,
        (learnt - began, time.process_time() - learnt),
    )


def resampled(here: Data) -> IntArray:
    """Weights of the points: as they are, then of resampled series, ``(1 + resamples, points)``."""
    series = here.points.points.series
    count = int(series.max()) + 1
    drawn = bootstrap_weights(count, RESAMPLES, random_streams.stream(SEED, "resampled series"))
    return np.concatenate([np.ones((1, count), dtype=np.int64), drawn])[:, series] * here.weights


def samples_of_scores(
    strength: FloatArray,
    probability: FloatArray,
    threshold: float,
    happened: BoolArray,
    weights: IntArray,
) -> dict[str, FloatArray]:
    """Scores in the sample and in each resample, ``(1 + resamples,)`` each, by name."""
    raised, true = probability >= threshold, weights @ happened
    hits = weights @ (raised & happened)
    rate = true / weights.sum(axis=1)
    error = weights @ np.square(probability - happened) / weights.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        f_score, skill = 2 * hits / (weights @ raised + true), 1 - error / (rate * (1 - rate))
    ranking = ranking_scores(strength, happened, weights)
    return {
        "average_precision": ranking["average_precision"],
        "brier_skill": skill,
        "f_score": f_score,
    }


SCORES = ("average_precision", "brier_skill", "f_score")


def rows(
    kind: str, flow: str, condition: Condition, here: Data, fit: Fit
) -> Iterator[dict[str, Any]]:
    """A row for each prediction time."""
    weights = resampled(here)
    for ahead in TIMES:
        scores = samples_of_scores(
            fit.strength[ahead],
            fit.probability[ahead],
            fit.threshold[ahead],
            here.happened[ahead],
            weights,
        )
        row = {
            "flow": flow,
            **condition._asdict(),
            "kind": kind,
            "training_series": len(here.training),
            "training_events": here.events,
            "prediction_time_lt": ahead,
            "test_events": int(here.happened[ahead].sum()),
            "base_rate": float(weights[0] @ here.happened[ahead] / weights[0].sum()),
        }
        for name, samples in scores.items():
            ends = percentile_interval(samples[1:], 0.95)
            row |= {name: float(samples[0]), f"{name}_low": ends[0], f"{name}_high": ends[1]}
        row |= {"invalid_fraction": fit.invalid[ahead], "calibrated": kind not in UNCALIBRATED}
        yield row | {"fit_seconds": fit.seconds[0], "forecast_seconds": fit.seconds[1]}


def outcomes_file(kind: str, flow: str, condition: Condition) -> Path:
    """File of the forecasts of a fit."""
    parts = (flow, condition.events, condition.noise, condition.observed, kind)
    return OUTCOMES / ("-".join(map(str, parts)) + ".npz")


def made(table: pd.DataFrame, kind: str, flow: str, condition: Condition) -> bool:
    """Whether the table has rows of a fit."""
    if not len(table):
        return False
    keys = {"flow": flow, "kind": kind, **condition._asdict()}
    keys.pop("varied")
    return bool(np.logical_and.reduce([table[name] == value for name, value in keys.items()]).any())


def run(given: argparse.Namespace) -> None:
    """Make all rows that are missing."""
    kept = given.scores
    for condition in conditions():
        for flow in given.flows:
            if condition.varied not in given.varied or condition.events not in given.events:
                continue
            for kind in given.kinds:
                table = pd.read_csv(kept) if kept.exists() else pd.DataFrame()
                if made(table, kind, flow, condition) or condition.events > KINDS[kind]:
                    continue
                if kind in FLOWS[flow]().without or condition.events > FLOWS[flow]().most_events:
                    continue
                here = data(flow, condition)
                with single_threaded(), warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    options = OPTIONS.get(kind, {}) | FLOWS[flow]().options.get(kind, {})
                    fit = fitted(kind, options, here, condition)
                OUTCOMES.mkdir(parents=True, exist_ok=True)
                arrays = {
                    f"{name}_{ahead:g}": values[ahead]
                    for name, values in (
                        ("strength", fit.strength),
                        ("probability", fit.probability),
                    )
                    for ahead in TIMES
                }
                thresholds = {f"threshold_{ahead:g}": fit.threshold[ahead] for ahead in TIMES}
                np.savez(outcomes_file(kind, flow, condition), **arrays, **thresholds)
                added = pd.DataFrame(list(rows(kind, flow, condition, here, fit)))
                pd.concat([table, added]).to_csv(kept, index=False, float_format="%.4g")
                last = added.iloc[0]
                print(
                    f"{flow} {condition} {kind}: {last['average_precision']:.3f}, "
                    f"{fit.seconds[0]:.1f} + {fit.seconds[1]:.1f} s",
                    flush=True,
                )


def compared(flow: str, condition: Condition, kinds: Sequence[str]) -> Iterator[dict[str, Any]]:
    """The best kind of a condition and its lead over each other kind, by prediction time."""
    here = data(flow, condition)
    weights = resampled(here)
    for ahead in TIMES:
        samples = {}
        for kind in kinds:
            with np.load(outcomes_file(kind, flow, condition)) as kept:
                samples[kind] = samples_of_scores(
                    *(kept[f"{name}_{ahead:g}"] for name in ("strength", "probability")),
                    float(kept[f"threshold_{ahead:g}"]),
                    here.happened[ahead],
                    weights,
                )
        for score in SCORES:
            order = sorted(kinds, key=lambda kind: -np.nan_to_num(samples[kind][score][0], nan=-9))
            best = samples[order[0]][score]
            for rank, other in enumerate(order[1:], start=2):
                lead = best - samples[other][score]
                low, high = percentile_interval(lead[1:], 0.95)
                yield {
                    "flow": flow,
                    **condition._asdict(),
                    "prediction_time_lt": ahead,
                    "score": score,
                    "best": order[0],
                    "value": float(best[0]),
                    "other": other,
                    "rank": rank,
                    "lead": float(lead[0]),
                    "lead_low": low,
                    "lead_high": high,
                }


def compare(given: argparse.Namespace) -> None:
    """Write the best kind of each condition, and its leads, beside the scores."""
    table = pd.read_csv(given.scores)
    found: list[dict[str, Any]] = []
    for flow in FLOWS:
        for condition in conditions():
            kinds = [kind for kind in KINDS if made(table, kind, flow, condition)]
            if len(kinds) > 1:
                found += compared(flow, condition, kinds)
    pd.DataFrame(found).to_csv(given.scores.with_name("best.csv"), index=False, float_format="%.4g")


def main() -> None:
    """Run, or compare."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("command", nargs="?", choices=["run", "compare"], default="run")
    parser.add_argument("--flows", nargs="*", default=[*FLOWS], choices=FLOWS)
    parser.add_argument("--kinds", nargs="*", default=[*KINDS], choices=KINDS)
    parser.add_argument("--varied", nargs="*", default=["events", "noise", "observed"])
    parser.add_argument("--events", nargs="*", type=int, default=[*EVENTS], help="numbers of them")
    parser.add_argument("--scores", type=Path, default=KEPT / "scores.csv")
    given = parser.parse_args()
    {"run": run, "compare": compare}[given.command](given)


if __name__ == "__main__":
    main()

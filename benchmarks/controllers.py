"""Controllers compared in two arenas: the shear flow by return times, Lorenz 96 by events avoided.

    python benchmarks/controllers.py shear_flow lorenz96 > benchmarks/controllers.csv
    python benchmarks/controllers.py table    # of that file, for docs/controllers.md

Every controller has the same flows and the same noise, and never sees the truth.
"""

import sys
import time
from collections import Counter
from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from pathlib import Path

import numpy as np
import pandas as pd

from burstcast.base.arrays import FloatArray
from burstcast.base.poisson import poisson_interval, rate_bound
from burstcast.control.actuation import actuated_system
from burstcast.control.arenas import LargestVariable, Lorenz96Arena, run_shear_flow
from burstcast.control.controller import Controller, ControlTask
from burstcast.control.experiment import ControlExperiment
from burstcast.control.rules import (
    ForecastTriggered,
    LocalInterventions,
    NoAction,
    WhileHigh,
    WhileRising,
    fitted_model,
)
from burstcast.control.timing import Schedule
from burstcast.forecasters.base import Forecaster, fitted
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt

HEAD = (
    "arena,controller,model,time,unit,events,rate,rate_low,rate_high,effort,acting,"
    "seconds_per_decision"
)


@dataclass(frozen=True)
class RingEquations(LargestVariable):
    """Learnt equations of a ring of variables, the same at each site."""

    terms: tuple[tuple[int, ...], ...] = ()  #: shifts of the neighbours whose product a term is
    weights: tuple[float, ...] = ()

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        """Sum of the terms, ``(variables, ...)``."""
        derivative: FloatArray = 0.0 * state
        for weight, term in zip(self.weights, self.terms, strict=True):
            value: FloatArray = weight + 0.0 * state
            for shift in term:
                value = value * np.roll(state, shift, axis=0)
            derivative = derivative + value
        return derivative


@dataclass(frozen=True)
class LearntRing(Forecaster):
    """Equations of a ring of variables, learnt from noisy observations.

    The derivative of a variable is quadratic in its neighbours up to a distance. Over two sampling
    intervals it integrates to a difference of observations (Simpson's rule), which is regressed on
    terms. Moments of noisy states are corrected for the noise, whose size is known (adjusted least
    squares, Cheng & Schneeweiss, Journal of the Royal Statistical Society B 60 (1998) 189). Terms
    with weights below ``least`` are removed.
    """

    noise: float = 1.0  #: standard deviation of the observation noise
    interval: float = 0.05  #: sampling interval
    reach: int = 3
    least: float = 0.1

    system: RingEquations | None = fitted()

    def fit(self, training: FloatArray, case: object) -> "LearntRing":
        """Learn from all sites of the series, ``(series, time, component)``."""
        shifts = range(-self.reach, self.reach + 1)
        terms: list[tuple[int, ...]] = [(), *((v,) for v in shifts)]
        terms += combinations_with_replacement(shifts, 2)
        states = training.transpose(2, 0, 1)
        change = (states[..., 2:] - states[..., :-2]) / (2 * self.interval)
        before, here, after = (
            self._powers(states[..., lag : states.shape[2] - 2 + lag]) for lag in range(3)
        )
        terms_here = self._monomials(terms, here)
        # terms at the times before and after have other noise than those of the moment
        around = (self._monomials(terms, before) + self._monomials(terms, after)) / 6
        apart = terms_here @ around.T / change.size
        target = terms_here @ change.ravel() / change.size
        pairs = [[tuple(sorted(a + b)) for a in terms] for b in terms]
        keys = sorted({key for row in pairs for key in row})
        moment = {key: float(self._monomials([key], here).mean()) for key in keys}
        now = np.array([[moment[key] for key in row] for row in pairs])
        gram, kept = 4 / 6 * now + apart, np.arange(len(terms))
        for _ in range(5):
            weights = np.linalg.solve(gram[np.ix_(kept, kept)], target[kept])
            kept, weights = kept[np.abs(weights) > self.least], weights
        weights = np.linalg.solve(gram[np.ix_(kept, kept)], target[kept])
        chosen = tuple(terms[number] for number in kept)
        learnt = RingEquations(variables=len(states), terms=chosen, weights=tuple(weights.tolist()))
        return self.with_fitted(system=learnt)

    def _powers(self, states: FloatArray) -> FloatArray:
        """First to fourth powers of all neighbours, in the mean those of the true state.

        ``(4, 2 * reach + 1, samples)``.
        """
        shifts = range(-self.reach, self.reach + 1)
        x, variance = np.stack([np.roll(states, v, axis=0).ravel() for v in shifts]), self.noise**2
        square = x * x
        third, fourth = x * (square - 3 * variance), square * (square - 6 * variance)
        return np.stack([x, square - variance, third, fourth + 3 * variance**2])

    def _monomials(self, terms: list[tuple[int, ...]], powers: FloatArray) -> FloatArray:
        """Products of neighbours, ``(terms, samples)``."""
        values = np.ones((len(terms), powers.shape[2]))
        for value, term in zip(values, terms, strict=True):
            for shift, power in Counter(term).items():
                value *= powers[power - 1, shift + self.reach]
        return values

    def start(self, washout: FloatArray) -> FloatArray:
        """The last state is the memory."""
        return washout[-1]

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Integrate the learnt equations, in two steps for each sampling interval."""
        assert self.system is not None
        states = integrate(self.system, memory, self.interval / 2, 2 * steps, 2, may_diverge=True)
        return states[1:], states[-1]


@dataclass
class WithLearntRing(LocalInterventions):
    """Local interventions by forecasts of equations that are learnt from noisy observations."""

    def begin(self, task: ControlTask, flows: int) -> None:
        """Learn the equations."""
        super().begin(task, flows)
        self._model = fitted_model(LearntRing(float(task.noise[0]), task.interval), task)


def row(*values: object) -> None:
    """Print a row of the table."""
    texts = [f"{value:.4g}" if isinstance(value, float) else str(value) for value in values]
    print(",".join(texts), flush=True)


def rates(events: int, observed: float) -> tuple[float, float, float]:
    """Rate of events with its interval; the bound where none was observed."""
    if not events:
        return 0.0, 0.0, rate_bound(observed, 0.95)
    return events / observed, *poisson_interval(events, observed, 0.95)


def lorenz96() -> None:
    """A hundred years of each, and 400 of the free flow."""
    row("lorenz96", *_lorenz96(NoAction(), "no control", "", Lorenz96Arena(years=6.25)))
    for sites, limit in product((1, 2), (0.1, 0.2)):
        arena = Lorenz96Arena(sites=sites, limit=limit)
        name = f"interventions of {limit:g} at {sites} site{'s' * (sites - 1)}"
        row("lorenz96", *_lorenz96(LocalInterventions(), name, "true equations", arena))
        row("lorenz96", *_lorenz96(WithLearntRing(), name, "learnt equations", arena))


def _lorenz96(
    controller: Controller, name: str, model: str, arena: Lorenz96Arena
) -> tuple[object, ...]:
    started, decisions = time.perf_counter(), 0

    def watch(number: int) -> None:
        nonlocal started, decisions
        if number == 0:  # learning is no decision
            started = time.perf_counter()
        decisions = number

    counts = arena.run(controller, watch)
    seconds = (time.perf_counter() - started) / max(decisions * arena.flows, 1)
    years = arena.flows * counts.years
    events = int(counts.events.sum())
    acting = float(counts.interventions.sum() / (years * arena.steps_per_year))
    effort = float(counts.effort.sum() / years)
    return (name, model, years, "years", events, *rates(events, years), effort, acting, seconds)


def shear_flow(flows: int = 200, span_lt: float = 500.0) -> None:
    """A hundred thousand Lyapunov times of each, at Re = 400."""
    experiment, training, noise = _shear_flow(flows, span_lt)
    entries: dict[tuple[str, str], Controller] = {
        ("no control", ""): NoAction(),
        ("while k is high", ""): WhileHigh(level=0.06),
        ("while a1 is low or k high", ""): WhileHigh(0.06, "observable", "-a1", -0.15),
        ("while k rises", ""): WhileRising(level=0.1, ahead=30.0),
        ("forecast over 3 LT", "true equations"): ForecastTriggered(183.0),
        ("forecast over 3 LT", "learnt equations"): ForecastTriggered(183.0, "quadratic"),
    }
    steps = experiment.schedule.steps_per_lyapunov_time
    for (name, model), controller in entries.items():
        started = time.perf_counter()
        counts = run_shear_flow(
            controller,
            experiment,
            training,
            noise,
            decision_interval_lt=0.25,
            laminarisation_threshold=0.48,
        )
        seconds = (time.perf_counter() - started) / int(counts.decisions.sum())
        observed, events = float(counts.steps.sum() / steps), int(counts.events.sum())
        acting = float(counts.actuated_steps.sum() / counts.steps.sum())
        values = (name, model, observed, "LT", events, *rates(events, observed))
        row("shear_flow", *values, acting, acting, seconds)


def _shear_flow(flows: int, span_lt: float) -> tuple[ControlExperiment, FloatArray, FloatArray]:
    system, generator = MoehlisFaisstEckhardt(reynolds=400.0), np.random.default_rng(2022)
    start = np.zeros((9, flows + 40))
    start[[0, 2, 3]] = [[1.0], [0.07066], [-0.07076]]
    start[3] += 0.01 * generator.random(flows + 40)
    states = integrate(system, start, 0.25, 4 * 4200, stride=4)[200:].transpose(2, 0, 1)
    turbulent = states[system.observable(np.moveaxis(states, -1, 0)).max(axis=1) < 0.48]
    free, learnt = turbulent[10:], turbulent[:10]
    noise = 0.01 * learnt.std(axis=(0, 1))
    schedule = Schedule(
        washout=30,
        quiet_lt=20.0,
        span_lt=span_lt,
        delay_lt=0.0,
        actuation_start_lt=-1.0,
        actuation_duration_lt=1.5,
        steps_per_lyapunov_time=61,
        sampling_stride=4,
        time_step=0.25,
    )
    experiment = ControlExperiment(
        system=system,
        actuated_system=actuated_system(system, {"reynolds": 2000.0}),
        threshold=0.1,
        series=range(10, 10 + len(free)),
        washouts=np.ascontiguousarray(free[:, -30:]),
        quiet_starts=False,
        schedule=schedule,
        root_seed=2022,
        case="Re400",
    )
    return experiment, learnt + noise * generator.standard_normal(learnt.shape), noise


def table() -> str:
    """Markdown of the rows in ``controllers.csv``."""
    rows = pd.read_csv(Path(__file__).with_suffix(".csv"), keep_default_na=False)
    lines = [
        "| arena | controller | model | events | in | avoided [%] | return time (95 %) | effort | "
        "acting [%] | ms per decision |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    free = rows[rows["controller"] == "no control"].set_index("arena")["rate"]
    for run in rows.to_dict("records"):
        low, high = run["rate_low"], run["rate_high"]
        if run["events"]:
            times = f"{1 / run['rate']:.3g} ({1 / high:.3g} to {1 / low:.3g})"
        else:
            times = f"above {1 / high:.3g}"
        avoided = [100 * (1 - rate / free[run["arena"]]) for rate in (run["rate"], high, low)]
        shares = "{:.1f} ({:.1f} to {:.1f})".format(*avoided)
        cells = (
            run["arena"].replace("_", " ").replace("lorenz96", "Lorenz 96"),
            run["controller"],
            run["model"] or "none",
            run["events"],
            f"{float(run['time']):.3g} {run['unit']}",
            "" if run["controller"] == "no control" else shares,
            f"{times} {run['unit']}",
            f"{run['effort']:.3g}",
            f"{100 * run['acting']:.2g}",
            f"{1000 * run['seconds_per_decision']:.2g}",
        )
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


if __name__ == "__main__":
    if sys.argv[1:] == ["table"]:
        print(table())
    else:
        print(HEAD, flush=True)
        for chosen in sys.argv[1:]:
            {"lorenz96": lorenz96, "shear_flow": shear_flow}[chosen]()

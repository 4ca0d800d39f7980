"""Controllers compared in two arenas: the shear flow by return times, Lorenz 96 by events avoided.

    python benchmarks/controllers.py lorenz96 shear_flow >> benchmarks/controllers.csv

Every controller has the same flows and the same noise, and never sees the truth. A row is printed
after each run; docs/controllers.md has the table.
"""

import sys
import time
from dataclasses import dataclass, replace

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.poisson import poisson_interval, rate_bound
from burstcast.control.actuation import actuated_system
from burstcast.control.arenas import Lorenz96Arena, run_shear_flow
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
class LocalMap(Forecaster):
    """A map of a ring of variables, the same at each site, polynomial in the neighbours.

    The next value at a site is linear in its neighbours up to a distance, and in their products.
    """

    reach: int = 3
    ridge: float = 1e-4

    weights: FloatArray = fitted()

    def fit(self, training: FloatArray, case: object) -> "LocalMap":
        """Learn from all sites of the series, ``(series, time, component)``."""
        states = training.transpose(2, 0, 1)
        features = self._features(states[..., :-1]).reshape(self._count, -1)
        change = (states[..., 1:] - states[..., :-1]).reshape(-1)
        gram = features @ features.T / change.size
        gram += self.ridge * np.diag(np.diag(gram))
        return self.with_fitted(weights=np.linalg.solve(gram, features @ change / change.size))

    @property
    def _count(self) -> int:
        near = 2 * self.reach + 1
        return 1 + near + near * (near + 1) // 2

    def _features(self, states: FloatArray) -> FloatArray:
        near = np.stack([np.roll(states, d, axis=0) for d in range(-self.reach, self.reach + 1)])
        first, second = np.triu_indices(len(near))
        return np.concatenate([np.ones((1, *states.shape)), near, near[first] * near[second]])

    def start(self, washout: FloatArray) -> FloatArray:
        """The last state is the memory."""
        return washout[-1]

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Iterate the map; what leaves the attractor far behind stays where it is."""
        outputs = []
        for _ in range(steps):
            change = np.tensordot(self.weights, self._features(memory), axes=1)
            memory = np.clip(memory + change, -50.0, 50.0)
            outputs.append(memory)
        return np.stack(outputs), memory


@dataclass
class WithLocalMap(LocalInterventions):
    """Local interventions by a map that is learnt, twice, from noisy observations.

    A map that is fitted to noisy states is biased. The second one is fitted to the analyses of a
    filter with the first one.
    """

    passes: int = 2

    def begin(self, task: ControlTask, flows: int) -> None:
        """Learn the map, filter the training series by it, and learn it again."""
        super().begin(task, flows)
        self._model = fitted_model(LocalMap(), task)
        for _ in range(self.passes - 1):
            self._ensemble = None
            means = []
            for seen in task.training.transpose(1, 2, 0):
                self.observe(seen[np.newaxis])
                means.append(self._ensemble.mean(axis=1))
            analyses = np.ascontiguousarray(np.stack(means)[100:].transpose(2, 0, 1))
            self._model = fitted_model(LocalMap(), replace(task, training=analyses))
        self._ensemble = None


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
    for sites in (1, 2):
        arena = Lorenz96Arena(sites=sites)
        name = f"local interventions at {sites} site{'s' * (sites - 1)}"
        row("lorenz96", *_lorenz96(LocalInterventions(), name, "true equations", arena))
        row("lorenz96", *_lorenz96(WithLocalMap(), name, "learnt map", arena))


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


if __name__ == "__main__":
    print(HEAD, flush=True)
    for chosen in sys.argv[1:]:
        {"lorenz96": lorenz96, "shear_flow": shear_flow}[chosen]()

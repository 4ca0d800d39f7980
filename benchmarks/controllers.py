r"""Controllers compared in two arenas: the shear flow by return times, Lorenz 96 by events avoided.

    python benchmarks/controllers.py shear_flow shear_flow_chosen lorenz96 lorenz96_maps \
        > benchmarks/controllers.csv
    python benchmarks/controllers.py table    # of that file, for docs/controllers.md

Every controller has the same flows and the same noise, and never sees the truth.
"""

import sys
import time
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import pandas as pd
from ring_models import INFLATION, LearntRing, RingAutoregression, RingNetwork

from burstcast.control.arenas import ArenaScore, Lorenz96Arena, ShearFlowArena
from burstcast.control.controller import Controller, ControlTask
from burstcast.control.rules import (
    ClassifierTriggered,
    ForecastTriggered,
    LocalInterventions,
    NoAction,
    WhileHigh,
    WhileRising,
    fitted_model,
)
from burstcast.forecasters.base import Forecaster

ARENAS = {
    "shear_flow": "shear flow",
    "shear_flow_late": "shear flow, 1 LT late",
    "lorenz96": "Lorenz 96",
}
HEAD = (
    "arena,controller,model,time,unit,events,rate,rate_low,rate_high,effort,acting,"
    "seconds_per_decision"
)


@dataclass
class WithRing(LocalInterventions):
    """Local interventions by forecasts of a model that is learnt from noisy observations."""

    kind: type[Forecaster] = LearntRing

    def begin(self, task: ControlTask, flows: int) -> None:
        """Learn the model."""
        super().begin(task, flows)
        self._model = fitted_model(self.kind(noise=float(task.noise[0])), task)


def row(*values: object) -> None:
    """Print a row of the table."""
    texts = [f"{value:.4g}" if isinstance(value, float) else str(value) for value in values]
    print(",".join(texts), flush=True)


def lorenz96() -> None:
    """A hundred years of each, and 400 of the free flow."""
    row("lorenz96", *_lorenz96(NoAction(), "no control", "", Lorenz96Arena(years=6.25)))
    for sites, limit in product((1, 2), (0.1, 0.2)):
        arena = Lorenz96Arena(sites=sites, limit=limit)
        name = f"interventions of {limit:g} at {sites} site{'s' * (sites - 1)}"
        row("lorenz96", *_lorenz96(LocalInterventions(), name, "true equations", arena))
        row("lorenz96", *_lorenz96(WithRing(), name, "learnt equations", arena))


def lorenz96_maps() -> None:
    """Models that advance by a map: 32 years of the autoregression, 5 of the network."""
    for limit in (0.1, 0.2):
        arena = Lorenz96Arena(limit=limit, years=0.5)
        name = f"interventions of {limit:g} at 1 site"
        by_map = WithRing(inflation=INFLATION, kind=RingAutoregression)
        row("lorenz96", *_lorenz96(by_map, name, "autoregression (NVAR)", arena))
    small = Lorenz96Arena(limit=0.2, flows=16, years=0.3, settling_years=0.1)
    by_network = WithRing(inflation=INFLATION, kind=RingNetwork, scenarios=5)
    row("lorenz96", *_lorenz96(by_network, name, "network", small))


def _lorenz96(
    controller: Controller, name: str, model: str, arena: Lorenz96Arena
) -> tuple[object, ...]:
    started = time.perf_counter()

    def watch(number: int) -> None:
        nonlocal started
        if number == 0:  # learning is no decision
            started = time.perf_counter()

    score = arena.score(controller, watch)
    seconds = (time.perf_counter() - started) / score.decisions
    return (name, model, *_cells(score), seconds)


def _cells(score: ArenaScore) -> tuple[object, ...]:
    return score.time, score.unit, score.events, *score.rate, score.effort, score.acting


LATE = 1.0
"""Delay of the late actuator, in Lyapunov times."""
MOST_ACTING = 0.3
"""Largest share of the time that a chosen setting may act in."""
LYAPUNOV_TIME = 61.0


def shear_flow() -> None:
    """Forecasts and no control, a hundred thousand Lyapunov times of each, at Re = 400."""
    given = ShearFlowArena(span_lt=500.0)
    _shear_flow_row("shear_flow", NoAction(), "no control", "", given)
    for model, title in (("equations_noisy", "true equations"), ("quadratic", "learnt equations")):
        controller = ForecastTriggered(3 * LYAPUNOV_TIME, model)
        _shear_flow_row("shear_flow", controller, "forecast over 3 LT", title, given)


def shear_flow_chosen() -> None:
    """Controllers whose settings are chosen on other flows, with an actuator in time and late.

    Of each kind it is the setting with the fewest events, of those that act in at most
    `MOST_ACTING` of the time.
    """
    for arena, delay_lt, span_lt in (("shear_flow", 0.0, 250.0), ("shear_flow_late", LATE, 100.0)):
        others = ShearFlowArena(80, 100.0, delay_lt, random_seed=7)
        given = ShearFlowArena(240, span_lt, delay_lt)
        for kind, (model, candidates) in _candidates(late=delay_lt > 0).items():
            tried = [(name, each, others.run(each)) for name, each in candidates.items()]
            allowed = [
                (counts.events.sum() / counts.steps.sum(), name, controller)
                for name, controller, counts in tried
                if counts.actuated_steps.sum() <= MOST_ACTING * counts.steps.sum()
            ]
            if not allowed:
                print(f"{kind}: each setting acts for longer", file=sys.stderr)
                continue
            _, name, controller = min(allowed, key=lambda entry: entry[0])
            _shear_flow_row(arena, controller, name, model, given)


def _candidates(*, late: bool) -> dict[str, tuple[str, dict[str, Controller]]]:
    """Settings of each kind of controller, by their names in the table, and its model."""
    high: dict[str, Controller] = {
        f"while k >= {level:g}": WhileHigh(level) for level in (0.03, 0.04, 0.05, 0.06, 0.08)
    }
    two: dict[str, Controller] = {
        f"while k >= {level:g} or a1 <= {low:g}": WhileHigh(level, "observable", "-a1", -low)
        for level, low in product((0.05, 0.06, 0.08), (0.05, 0.08, 0.1, 0.12))
    }
    rising: dict[str, Controller] = {
        f"while k rises to {level:g} in {ahead / LYAPUNOV_TIME:.2g} LT": WhileRising(level, ahead)
        for level, ahead in product((0.04, 0.06, 0.08, 0.1), (15.0, 30.0, 60.0))
    }
    classifier: dict[str, Controller] = {
        f"event within {horizon:g} LT at {probability:g}": ClassifierTriggered(
            horizon * LYAPUNOV_TIME, probability
        )
        for horizon, probability in product((1.0, 2.0, 3.0), (0.02, 0.05, 0.1, 0.2))
    }
    kinds: dict[str, tuple[str, dict[str, Controller]]] = {
        "level": ("", high),
        "two quantities": ("", two),
        "slope": ("", rising),
        "classifier": ("classifier", classifier),
    }
    if late:
        forecast: dict[str, Controller] = {
            f"forecast over {horizon:g} LT": ForecastTriggered(horizon * LYAPUNOV_TIME, "quadratic")
            for horizon in (2.0, 3.0, 4.0)
        }
        kinds["forecast"] = "learnt equations", forecast
    return kinds


def _shear_flow_row(
    name: str, controller: Controller, title: str, model: str, arena: ShearFlowArena
) -> None:
    started = time.perf_counter()
    score = arena.score(controller)
    seconds = (time.perf_counter() - started) / score.decisions
    row(name, title, model, *_cells(score), seconds)


def table() -> str:
    """Markdown of the rows in ``controllers.csv``."""
    rows = pd.read_csv(Path(__file__).with_suffix(".csv"), keep_default_na=False)
    lines = [
        "| arena | controller | model | events | in | avoided [%] | return time (95 %) | effort | "
        "acting [%] | ms per decision |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    free = rows[rows["controller"] == "no control"].set_index("arena")["rate"]
    free["shear_flow_late"] = free["shear_flow"]
    for run in rows.to_dict("records"):
        low, high = run["rate_low"], run["rate_high"]
        if run["events"]:
            times = f"{1 / run['rate']:.3g} ({1 / high:.3g} to {1 / low:.3g})"
        else:
            times = f"above {1 / high:.3g}"
        avoided = [100 * (1 - rate / free[run["arena"]]) for rate in (run["rate"], high, low)]
        shares = "{:.1f} ({:.1f} to {:.1f})".format(*avoided)
        cells = (
            ARENAS[run["arena"]],
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
            {
                "lorenz96": lorenz96,
                "lorenz96_maps": lorenz96_maps,
                "shear_flow": shear_flow,
                "shear_flow_chosen": shear_flow_chosen,
            }[chosen]()

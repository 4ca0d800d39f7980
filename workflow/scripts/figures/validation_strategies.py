"""Where each strategy trains and validates, on the first training series. The network sees the
data in open loop during washout and training, and forecasts in closed loop during validation.
"""

import numpy as np
from matplotlib.figure import Figure

from burstcast.figures.validation_strategies import ValidationLayout, validation_strategies
from burstcast.netcdf import read_rows
from burstcast.tuning.strategies.base import use_of_series
from burstcast.tuning.strategies.registry import make_strategy
from burstcast_workflow.harness.figures import Settings, figure
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time
from burstcast_workflow.jobs.validation_plans import validation_plan


@figure
def draw(*, ensemble: str, time_unit: str | list[str], settings: Settings) -> Figure:
    """Draw where each strategy trains and validates."""
    unit = lyapunov_time(settings, time_unit)
    observable = read_rows(ensemble, "observable", 0, 1)[0]
    plan = validation_plan(settings, unit)
    length = len(observable)
    layouts = []
    for strategy in map(make_strategy, settings["strategies"]):
        # how many more series there are changes nothing in the first one
        folds = strategy.folds(plan, plan.series, length)
        stop, starts = use_of_series(folds, 0)
        layouts.append(
            ValidationLayout(
                validation=strategy.name,
                title=strategy.title,
                washout=(0.0, plan.washout / unit),
                training=(plan.washout / unit, stop / unit),
                intervals=np.array([(start, start + plan.interval) for start in starts]) / unit,
            )
        )
    return validation_strategies(
        np.arange(length) / unit,
        observable,
        layouts,
        settings["case.event_threshold"],
        symbol=system_of(settings).observable_symbol,
    )

"""The file of a forecasting task, and the page that explains it."""

from pathlib import Path
from string import Template
from textwrap import fill

import numpy as np

from burstcast.benchmark.task import TaskData
from burstcast.files.netcdf import Variable
from burstcast.files.units import COMPONENT, LYAPUNOV_TIMES, NUMBER, OBSERVABLE, TIME
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.state_space import component_names

_KNOWN_OF = {
    "training_known": (("training_series", "training_step"), "the training series"),
    "known": (("point", "known_step"), "a point's washout and forecast"),
    "horizon_known": (
        ("horizon_point", "horizon_known_step"),
        "a horizon point's washout and forecast; NaN after the end of the series",
    ),
}
"""Dimensions of columns that are known in advance, and what they are of."""

_TEMPLATE = Path(__file__).with_name("page.md")


def task_variables(data: TaskData) -> dict[str, Variable]:
    """Variables of the file: training series, washouts, starting points."""
    points, space = data.points, data.space
    start = "observed components up to and including"
    found = {
        "series": Variable(("point",), points.series, NUMBER, "number of the test series"),
        "start_step": Variable(("point",), points.step, NUMBER, "sample of the starting point"),
        "start_time": Variable(
            ("point",),
            points.step * data.sampling_interval,
            TIME,
            "time of the starting point in its test series",
        ),
    }
    for name, axes, states, meaning in (
        ("training", ("training_series", "time"), data.training, "observed training series"),
        ("washout", ("point", "washout_step"), data.washouts, f"{start} the starting point"),
        (
            "horizon_washout",
            ("horizon_point", "washout_step"),
            data.horizon_washouts,
            f"{start} a starting point of the prediction horizon",
        ),
    ):
        values = space.observable(states.transpose(2, 0, 1))
        of_values = f"observed {space.observable_name} of the {name.replace('_', ' ')}"
        found[name] = Variable((*axes, "component"), states, COMPONENT, meaning)
        found[f"{name}_observable"] = Variable(axes, values, OBSERVABLE, of_values)
    for name, values in data.known_columns.items():
        axes, what = _KNOWN_OF[name]
        meaning = f"columns that are known in advance, in the sample after each step of {what}"
        found[name] = Variable((*axes, "known_column"), values, None, meaning)
    found["prediction_time_lt"] = Variable(
        ("prediction_time",),
        data.prediction_times_lt,
        LYAPUNOV_TIMES,
        "time from the starting point to the first step of each prediction window",
    )
    for end, steps in zip(("first", "last"), zip(*data.window_steps, strict=True), strict=True):
        meaning = f"{end} step of each prediction window, counted from the starting point"
        found[f"window_{end}_step"] = Variable(("prediction_time",), steps, NUMBER, meaning)
    return found


def task_attributes(data: TaskData) -> dict[str, str | int | float]:
    """Attributes of the file: which case it is of, and the numbers that scores depend on."""
    task = data.task
    return {
        "case": task.case,
        "case_version": task.version,
        "seed": task.seed,
        "components": " ".join(component_names(task.space)),
        "observable": task.space.observable_name,
        "event_threshold": data.event_threshold,
        "sampling_interval": data.sampling_interval,
        "steps_per_lyapunov_time": data.search.steps_per_lyapunov_time,
        "forecast_steps": task.steps,
        "horizon_steps": task.horizon_steps,
        "noise": data.noise,
    }


def page(data: TaskData, file: str) -> str:
    """The page that explains the file of this name to readers without burstcast."""
    task, series, search = data.task, data.training.shape, data.search
    names = component_names(data.space)
    return Template(_TEMPLATE.read_text(encoding="utf-8")).substitute(
        case=task.case,
        file=file,
        version=task.version,
        seed=task.seed,
        training=f"{series[0]} of {series[1]} samples",
        points=f"{task.points} in {len(np.unique(data.points.series))} series",
        horizon_points=task.horizon_points,
        lyapunov_time=search.steps_per_lyapunov_time,
        observable=_observable(data),
        known=_KNOWN if data.known_columns else "",
        threshold=f"{data.event_threshold:g}",
        window=f"{task.window_lt:g}",
        times=", ".join(f"{time:g}" for time in task.prediction_times_lt),
        longest=f"{search.longest_lead_time_lt:g}",
        lead_step=f"{search.lead_time_step_lt:g}",
        tolerance=f"{data.tolerance:g}",
        # the first and last of many
        components=",".join(names if len(names) <= 12 else [*names[:3], "...", names[-1]]),
    )


_KNOWN = """

## What is known in advance

Columns of the record that are known in advance may be used over the whole of a forecast. They are
in the order of the setting `data.known` along the dimension `known_column`. Along the steps, each
entry holds the values in the sample after the step:

| variable | dimensions | steps |
|---|---|---|
| `training_known` | training_series, training_step, known_column | from each sample to the next |
| `known` | point, known_step, known_column | the steps of the washout, then the steps of the forecast: the last `forecast_steps` entries |
| `horizon_known` | horizon_point, horizon_known_step, known_column | the same for the prediction horizon; NaN where the series has ended |"""  # noqa: E501


def _observable(data: TaskData) -> str:
    """Name of the observable, and whether it is a component of its own."""
    space = data.space
    said = f"The observable is the {space.observable_name}."
    if isinstance(space, MoehlisFaisstEckhardt):
        said += " It is (a1^2 + ... + a9^2) / 2 of all nine modes."
    if "observable" in component_names(space):
        said += " It is the last component, which is called `observable`."
    return fill(said, 100)

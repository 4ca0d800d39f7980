"""Export of the benchmark: a NetCDF file for each case, and the page that explains them."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from string import Template
from textwrap import fill

import numpy as np

from burstcast.benchmark.task import KnownColumns, TaskData
from burstcast.files.atomic_files import atomic
from burstcast.files.netcdf import Variable, write_netcdf
from burstcast.files.units import COMPONENT, LYAPUNOV_TIMES, NUMBER, OBSERVABLE, TIME
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.state_space import component_names

PAGE = "README.md"
"""Name of the page in an export."""

_TEMPLATE = Path(__file__).with_name("page.md")


def case_variables(data: TaskData) -> dict[str, Variable]:
    """Variables of the file of a case: training series, washouts, starting points."""
    points, space, before = data.points, data.task.space, data.horizon_washouts
    in_washout = ("washout_step", "component")
    of_training = ("training_series", "time", "component")
    name = space.observable_name
    of_points = {
        "series": Variable(("point",), points.series, NUMBER, "number of the test series"),
        "start_step": Variable(("point",), points.step, NUMBER, "sample of the starting point"),
        "start_time": Variable(
            ("point",),
            points.step * data.sampling_interval,
            TIME,
            "time of the starting point in its test series",
        ),
        "washout": Variable(
            ("point", *in_washout),
            data.washouts,
            COMPONENT,
            "observed components up to and including the starting point",
        ),
        "washout_observable": Variable(
            ("point", "washout_step"),
            space.observable(data.washouts.transpose(2, 0, 1)),
            OBSERVABLE,
            f"observed {name} of the washout",
        ),
    }
    of_horizon = {
        "horizon_washout": Variable(
            ("horizon_point", *in_washout),
            before,
            COMPONENT,
            "observed components up to and including a starting point of the prediction horizon",
        ),
        "horizon_washout_observable": Variable(
            ("horizon_point", "washout_step"),
            space.observable(before.transpose(2, 0, 1)),
            OBSERVABLE,
            f"observed {name} of that washout",
        ),
    }
    return {
        "training": Variable(of_training, data.training, COMPONENT, "observed training series"),
        "training_observable": Variable(
            of_training[:2],
            space.observable(data.training.transpose(2, 0, 1)),
            OBSERVABLE,
            f"observed {name} of the training series",
        ),
        **of_points,
        **of_horizon,
        **(_known_variables(data.known) if data.known is not None else {}),
        "prediction_time_lt": Variable(
            ("prediction_time",),
            data.task.prediction_times_lt,
            LYAPUNOV_TIMES,
            "time from the starting point to the first step of each prediction window",
        ),
        **{
            f"window_{end}_step": Variable(
                ("prediction_time",),
                [steps[place] for steps in data.window_steps],
                NUMBER,
                f"{end} step of each prediction window, counted from the starting point",
            )
            for place, end in enumerate(("first", "last"))
        },
    }


def _known_variables(known: KnownColumns) -> dict[str, Variable]:
    """Variables of the columns that are known in advance."""
    meaning = "columns that are known in advance, in the sample after each step of"
    horizon = f"{meaning} a horizon point's washout and forecast; NaN after the end of the series"
    column = "known_column"
    return {
        "training_known": Variable(
            ("training_series", "training_step", column),
            known.training,
            None,
            f"{meaning} the training series",
        ),
        "known": Variable(
            ("point", "known_step", column),
            known.points,
            None,
            f"{meaning} a point's washout and forecast",
        ),
        "horizon_known": Variable(
            ("horizon_point", "horizon_known_step", column), known.horizon, None, horizon
        ),
    }


def case_attributes(data: TaskData) -> dict[str, str | int | float]:
    """Attributes of the file of a case: which it is, and the numbers that scores depend on."""
    task = data.task
    return {
        "case": task.case,
        "case_version": int(task.version) if task.version.isdecimal() else task.version,
        "seed": task.seed,
        "digest": data.digest,
        "about": data.about,
        "components": " ".join(component_names(task.space)),
        "observable": task.space.observable_name,
        "event_threshold": data.event_threshold,
        "sampling_interval": data.sampling_interval,
        "steps_per_lyapunov_time": data.search.steps_per_lyapunov_time,
        "forecast_steps": task.steps,
        "horizon_steps": task.horizon_steps,
        "noise": data.noise,
    }


def export(directory: Path, found: Sequence[TaskData]) -> list[Path]:
    """Write cases and the page into a directory, which is made."""
    directory.mkdir(parents=True, exist_ok=True)
    paths = []
    for data in found:
        paths.append(directory / f"{data.task.case}.nc")
        write_netcdf(paths[-1], case_variables(data), case_attributes(data))
    with atomic(directory / PAGE) as partial:
        Path(partial).write_text(page(found, _SCORING), encoding="utf-8")
    return [*paths, directory / PAGE]


_SCORING = "`burstcast benchmark score persistence.nc` checks and scores the file."


def page(found: Sequence[TaskData], scoring: str, file: str = "") -> str:
    """The page that explains an export to readers without burstcast.

    ``file``: Name of the file of a single case; by default the name of the case.
    """
    first = found[0]
    return Template(_TEMPLATE.read_text(encoding="utf-8")).substitute(
        cases="\n".join(_about(data, file or f"{data.task.case}.nc") for data in found),
        seed=first.task.seed,
        case=first.task.case,
        file=file or f"{first.task.case}.nc",
        version=first.task.version,
        observables=_observables(found),
        known=_KNOWN if any(data.known is not None for data in found) else "",
        threshold=_listed(f"{data.event_threshold:g}" for data in found),
        window=_listed(f"{data.task.window_lt:g}" for data in found),
        times=_listed(
            ", ".join(f"{time:g}" for time in data.task.prediction_times_lt) for data in found
        ),
        longest=_listed(f"{data.search.longest_lead_time_lt:g}" for data in found),
        lead_step=_listed(f"{data.search.lead_time_step_lt:g}" for data in found),
        tolerance=_listed(f"{data.tolerance:g}" for data in found),
        components=_named(component_names(first.task.space)),
        scoring=scoring,
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


def _observables(found: Sequence[TaskData]) -> str:
    """Names of the observables, and whether they are components of their own."""
    names = _listed(data.task.space.observable_name for data in found)
    said = f"The observable is the {names}."
    if any(isinstance(data.task.space, MoehlisFaisstEckhardt) for data in found):
        said += " The kinetic energy is (a1^2 + ... + a9^2) / 2 of all nine modes."
    own = [data for data in found if "observable" in component_names(data.task.space)]
    if own:
        cases = " and ".join(f"`{data.task.case}`" for data in own)
        said += f" In {cases} it is the last component, which is called `observable`."
    return fill(said, 100)


def _named(names: Sequence[str]) -> str:
    """Names of columns, separated by commas; the first and last of many."""
    return ",".join(names if len(names) <= 12 else [*names[:3], "...", names[-1]])


def _about(data: TaskData, file: str) -> str:
    """Row of the page's table of cases."""
    series = data.training.shape
    cells = (
        f"`{file}`",
        f"version {data.task.version}. {data.about}",
        f"{series[0]} of {series[1]} samples",
        f"{data.task.points} in {len(np.unique(data.points.series))} series",
        str(data.task.horizon_points),
        str(data.search.steps_per_lyapunov_time),
        str(data.task.steps),
        str(data.task.horizon_steps),
    )
    return f"| {' | '.join(cells)} |"


def _listed(values: Iterable[str]) -> str:
    """A value that all cases share, or each value once."""
    return " or ".join(dict.fromkeys(values))

"""Export of the benchmark: a NetCDF file for each case, and the page that explains them."""

from collections.abc import Sequence
from pathlib import Path
from string import Template

from burstcast.benchmark.cases import BenchmarkCase
from burstcast.benchmark.data import CaseData
from burstcast.files.atomic_files import atomic
from burstcast.files.netcdf import Variable, write_netcdf
from burstcast.files.units import COMPONENT, LYAPUNOV_TIMES, NUMBER, OBSERVABLE, TIME

PAGE = "README.md"
"""Name of the page in an export."""

_TEMPLATE = Path(__file__).with_name("page.md")


def case_variables(data: CaseData) -> dict[str, Variable]:
    """Variables of the file of a case: training series, washouts, starting points."""
    case, points, space = data.case, data.test.points, data.case.space
    before = data.before_horizon(data.before_events)
    in_washout = ("washout_step", "component")
    of_training = ("training_series", "time", "component")
    name = space.observable_name
    of_points = {
        "series": Variable(("point",), points.series, NUMBER, "number of the test series"),
        "start_step": Variable(("point",), points.step, NUMBER, "sample of the starting point"),
        "start_time": Variable(
            ("point",),
            points.step * case.sampling_interval,
            TIME,
            "time of the starting point in its test series",
        ),
        "washout": Variable(
            ("point", *in_washout),
            data.test.washouts,
            COMPONENT,
            "observed components up to and including the starting point",
        ),
        "washout_observable": Variable(
            ("point", "washout_step"),
            data.test.seen,
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
        "prediction_time_lt": Variable(
            ("prediction_time",),
            case.prediction_times_lt,
            LYAPUNOV_TIMES,
            "time from the starting point to the first step of each prediction window",
        ),
        **{
            f"window_{end}_step": Variable(
                ("prediction_time",),
                [steps[place] for steps in case.window_steps],
                NUMBER,
                f"{end} step of each prediction window, counted from the starting point",
            )
            for place, end in enumerate(("first", "last"))
        },
    }


def case_attributes(data: CaseData) -> dict[str, str | int | float]:
    """Attributes of the file of a case: which it is, and the numbers that scores depend on."""
    case = data.case
    return {
        "case": case.name,
        "case_version": case.version,
        "seed": data.seed,
        "digest": data.digest,
        "about": case.about,
        "components": " ".join(case.component_names),
        "observable": case.space.observable_name,
        "event_threshold": case.event_threshold,
        "sampling_interval": case.sampling_interval,
        "steps_per_lyapunov_time": case.steps_per_lyapunov_time,
        "forecast_steps": data.steps,
        "horizon_steps": data.search.longest_lead_time,
        "noise": case.noise,
    }


def export(directory: Path, found: Sequence[CaseData]) -> list[Path]:
    """Write cases and the page into a directory, which is made.

    Parameters
    ----------
    directory
        Files of the same names in it are replaced.
    found
        Data of the cases.

    Returns
    -------
    The files.
    """
    directory.mkdir(parents=True, exist_ok=True)
    paths = []
    for data in found:
        paths.append(directory / f"{data.case.name}.nc")
        write_netcdf(paths[-1], case_variables(data), case_attributes(data))
    with atomic(directory / PAGE) as partial:
        Path(partial).write_text(page(found), encoding="utf-8")
    return [*paths, directory / PAGE]


def page(found: Sequence[CaseData]) -> str:
    """The page that explains an export to readers without burstcast."""
    first = found[0]
    return Template(_TEMPLATE.read_text(encoding="utf-8")).substitute(
        cases="\n".join(map(_about, found)),
        seed=first.seed,
        example=first.case.name,
        version=first.case.version,
        steps=first.steps,
        points=len(first.test.points),
        threshold=_range([case.event_threshold for case in _cases(found)]),
        window=_range([case.window_lt for case in _cases(found)]),
        times=", ".join(f"{time:g}" for time in first.case.prediction_times_lt),
        longest=_range([case.longest_lead_time_lt for case in _cases(found)]),
        lead_step=_range([case.lead_time_step_lt for case in _cases(found)]),
        tolerance=_range([case.tolerance for case in _cases(found)]),
        components=",".join(first.case.component_names),
    )


def _cases(found: Sequence[CaseData]) -> list[BenchmarkCase]:
    return [data.case for data in found]


def _about(data: CaseData) -> str:
    """Row of the page's table of cases."""
    case, series = data.case, data.training.shape
    cells = (
        f"`{case.name}.nc`",
        f"version {case.version}. {case.about}",
        f"{series[0]} of {series[1]} samples",
        f"{len(data.test.points)} in {len(data.observable)} series",
        str(len(data.horizon_starts[0])),
        str(case.steps_per_lyapunov_time),
        str(data.steps),
        str(data.search.longest_lead_time),
    )
    return f"| {' | '.join(cells)} |"


def _range(values: Sequence[float]) -> str:
    """A number that all cases share, or each number once."""
    return " or ".join(f"{value:g}" for value in dict.fromkeys(values))

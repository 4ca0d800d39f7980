"""Rows of the leaderboard by burstcast's own forecasters.

::

    python benchmarks/leaderboard.py [--case NAME] [--only FORECASTER] [--leaderboard FILE]

The forecasters learn from the exported training series alone. The equations are bounds: they know
what nobody else knows. An hour of one core for all cases, most of it for networks.
"""

import argparse
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from burstcast.arrays import BoolArray, FloatArray
from burstcast.benchmark.cases import CASES, BenchmarkCase
from burstcast.benchmark.data import CaseData, make_case
from burstcast.benchmark.forecast_files import Forecasts
from burstcast.benchmark.leaderboard import (
    PATH,
    read_leaderboard,
    row_of,
    with_row,
    write_leaderboard,
)
from burstcast.benchmark.scores import score_forecasts
from burstcast.data.starting_points import SeriesPoints
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.forecast.observed_points import ObservedPoints, observed_points
from burstcast.forecast.window_forecasts import window_forecasts
from burstcast.forecast.windows import crosses
from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters._options import options_of_kind
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasters.registry import classifier_class, forecaster_class
from burstcast.probability.alarms import best_threshold
from burstcast.probability.out_of_sample_classifiers import out_of_sample_probabilities
from burstcast.systems.base import DynamicalSystem
from burstcast_workflow.project import source_revision

Made = Callable[[CaseData], tuple[Forecasts, float]]
"""Makes forecasts of a case, and says at which probability an alarm is raised."""
POINTS_AT_ONCE = 512
_QUADRATIC = ("precursor", "quadratic", "quadratic_filtered")
_MANY = 50
"""Components of which forecasters with all products of two have too many to learn from."""


def estimator(case: BenchmarkCase, kind: str, **more: object) -> EventForecaster:
    """A forecaster of a case, not fitted."""

    def observable(states: FloatArray) -> FloatArray:
        return case.space.observable(np.moveaxis(states, -1, 0))

    return EventForecaster(
        case.space if isinstance(case.space, DynamicalSystem) else observable,
        case.event_threshold,
        prediction_times=case.prediction_times_lt,
        window=case.window_lt,
        lyapunov_time=1 / case.lyapunov_exponent,
        sampling_interval=case.sampling_interval,
        sampling_stride=case.sampling_stride,
        washout=case.washout_lt,
        kind=kind,
        calibrate=False,
        case=case.name,
        **more,
    )


def horizon_of(forecaster: Forecaster, data: CaseData) -> FloatArray:
    """Observable that a forecaster forecasts from the points of the prediction horizon."""
    truth = forecaster.sees_truth
    space = data.case.system if truth else data.case.space
    washouts = data.before_horizon(data.before_events_true if truth else data.before_events)
    found = []
    for start in range(0, len(washouts), POINTS_AT_ONCE):
        batch = washouts[start : start + POINTS_AT_ONCE].transpose(1, 2, 0)
        memory = forecaster.start(np.ascontiguousarray(batch))
        outputs, _ = forecaster.advance(memory, data.search.longest_lead_time)
        found.append(space.observable(outputs.transpose(1, 0, 2)).T)
    return np.concatenate(found)


def of_kind(kind: str, **more: object) -> Made:
    """Forecasts by one kind of forecasters; all members vote, the first one has a horizon."""

    def made(data: CaseData) -> tuple[Forecasts, float]:
        case = data.case
        forecasters = estimator(case, kind, **more).fit(data.training).members_
        votes = [
            member
            for one in forecasters
            for member in window_forecasts(
                one, case.space.observable, data.test.washouts, case.boundaries
            ).members
        ]
        horizon = horizon_of(forecasters[0], data) if len(forecasters) == 1 else None
        return Forecasts(tuple(votes), None, horizon), 0.5

    return made


def equations(data: CaseData) -> tuple[Forecasts, float]:
    """Forecasts by the equations from the true state, whatever is observed of it."""
    case = data.case
    told = ForecastingCase(
        case.system,
        case.time_step,
        case.sampling_stride,
        case.steps_per_lyapunov_time,
        options_of_kind("equations"),
    )
    bound = forecaster_class("equations").fit(data.training, told)
    now = data.true_states[:, np.newaxis]
    found = window_forecasts(bound, case.system.observable, now, case.boundaries)
    return Forecasts((found,), None, horizon_of(bound, data)), 0.5


def always(data: CaseData) -> tuple[Forecasts, float]:
    """An alarm for each window."""
    shape = len(data.test.points), len(data.case.prediction_times_lt)
    return Forecasts((), np.ones(shape), None), 0.5


def training_points(data: CaseData) -> tuple[ObservedPoints, BoolArray]:
    """Starting points of the training series at which no event is under way; what followed."""
    case = data.case
    points = observed_points(
        data.training,
        case.space.observable(data.training.transpose(2, 0, 1)),
        case.space.observable,
        spacing=1,
        washout=case.steps(case.washout_lt),
        boundaries=case.boundaries,
    )
    quiet = points.seen.max(axis=1) < case.event_threshold
    happened = [
        crosses(points.truth, *case.windows(ahead), case.event_threshold)[quiet]
        for ahead in case.prediction_times_lt
    ]
    kept = SeriesPoints(points.points.series[quiet], points.points.step[quiet])
    return replace(points, points=kept, washouts=points.washouts[quiet]), np.stack(happened, axis=1)


def climatology(data: CaseData) -> tuple[Forecasts, float]:
    """How often events followed the starting points of the training series."""
    _, happened = training_points(data)
    return Forecasts((), np.tile(happened.mean(axis=0), (len(data.test.points), 1)), None), 0.5


def precursor(data: CaseData) -> tuple[Forecasts, float]:
    """Logistic regression on the present components, their squares and products."""
    kind, case = classifier_class("precursor"), data.case
    options = {**options_of_kind("precursor"), "classifier": "logistic", "lags_lt": []}
    told = ForecastingCase(
        case.space, case.time_step, case.sampling_stride, case.steps_per_lyapunov_time, options
    )
    points, happened = training_points(data)
    now, series = points.washouts[:, -1:], points.points.series
    learnt = LabelledPoints(now, happened, series)
    honest = out_of_sample_probabilities(kind, learnt, told, len(data.training), now, series)
    threshold = best_threshold(*np.unique(honest, return_counts=True))
    test = kind.fit(learnt, told).probabilities(data.test.washouts[:, -1:])
    return Forecasts((), test, None), threshold


FORECASTERS: Mapping[str, tuple[str, Made]] = {
    "climatology": ("the share of training points that an event follows", climatology),
    "precursor": (
        "logistic regression on the present components, their squares and products",
        precursor,
    ),
    "permanent_alarm": ("an alarm for each window", always),
    "persistence": ("the last observation stays", of_kind("persistence")),
    "analogues": (
        "the nearest states of the training series; ten of them vote",
        of_kind("analogues"),
    ),
    "quadratic": ("quadratic equations learnt from the training series", of_kind("quadratic")),
    "quadratic_filtered": (
        "learnt quadratic equations with an ensemble filter over the washout; forty members vote",
        of_kind("quadratic_filtered"),
    ),
    "equations": ("bound: the equations, from the true state", equations),
    "equations_filtered": (
        "bound: the equations, with an ensemble filter over the washout; forty members vote",
        of_kind("equations_filtered"),
    ),
    "esn_1000": (
        "an echo state network of 1000 neurons, chosen by recycle validation",
        of_kind("esn", neurons=1000, members=1),
    ),
    "esn_500_quadratic": (
        "an echo state network of 500 neurons with squares in the readout",
        of_kind("esn", neurons=500, members=1, options={"readout": "quadratic"}),
    ),
    "esn_1000_quadratic": (
        "an echo state network of 1000 neurons with squares in the readout",
        of_kind("esn", neurons=1000, members=1, options={"readout": "quadratic"}),
    ),
    "esn_500_committee": (
        "five echo state networks of 500 neurons, which vote",
        of_kind("esn", neurons=500, members=5),
    ),
}
"""Forecasters by name: what they are, and how their forecasts are made."""


def main() -> None:
    """Add a row for each forecaster and case."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--case", action="append", choices=list(CASES))
    parser.add_argument("--only", action="append", choices=list(FORECASTERS))
    parser.add_argument("--leaderboard", type=Path, default=PATH)
    chosen = parser.parse_args()
    for name in chosen.case or CASES:
        data = make_case(CASES[name])
        for forecaster in chosen.only or FORECASTERS:
            if data.case.record is not None and forecaster.startswith(("equations", "quadratic")):
                continue  # none are known, and the steps are too long to learn any
            if forecaster == "equations_filtered" and data.case.space is not data.case.system:
                continue  # it needs all modes
            if forecaster in _QUADRATIC and len(data.case.component_names) > _MANY:
                continue  # products of so many components are more than the training samples
            about, made = FORECASTERS[forecaster]
            began = time.perf_counter()
            forecasts, threshold = made(data)
            scores = score_forecasts(data, forecasts, threshold)
            row = row_of(
                data,
                scores,
                forecaster=forecaster,
                about=about,
                alarm_threshold=threshold,
                version=version("burstcast"),
                commit=source_revision(),
            )
            known = read_leaderboard(chosen.leaderboard) if chosen.leaderboard.exists() else []
            write_leaderboard(chosen.leaderboard, with_row(known, row))
            taken = time.perf_counter() - began
            print(f"{name}, {forecaster}: {taken:.0f} s", flush=True)


if __name__ == "__main__":
    main()

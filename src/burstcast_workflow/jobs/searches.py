"""What the scan and the search share: the validation of a point from a job's settings."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.esn.reservoir import Reservoir
from burstcast.netcdf import Variable, read_netcdf
from burstcast.tuning.hyperparameters import HyperparameterPoint, SearchSpace
from burstcast.tuning.validation import PointValidator, Validation
from burstcast.units import NUMBER
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.length_checks import (
    check_recycle_validation,
    check_single_shot_validation,
)
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time
from burstcast_workflow.jobs.training import reservoir_seed, training_series
from burstcast_workflow.jobs.validation_plans import validation_plan

Settings = Mapping[str, Any]


def search_space(settings: Settings) -> SearchSpace:
    """Ranges of the hyperparameters."""
    return SearchSpace(
        tuple(settings["search.spectral_radius"]), tuple(settings["search.input_scaling"])
    )


def point_validator(
    settings: Settings, identifier: str, ensemble: str, time_unit: str | Sequence[str]
) -> PointValidator:
    """What validates the points of the search of one reservoir.

    Parameters
    ----------
    settings
        Of the scan or of the search.
    identifier
        Of the network, or of the reservoir alone.
    ensemble, time_unit
        Inputs of the job.

    Raises
    ------
    ValueError
        If the validation intervals do not fit into the series.
    """
    system, steps = system_of(settings), lyapunov_time(settings, time_unit)
    training = training_series(settings, ensemble)
    # where the Lyapunov time is computed, this is the first job that can tell
    durations_lt = settings["washout_lt"], settings["search.interval_lt"]
    intervals = settings["case.recycle_validation"]["intervals_per_series"]
    check_single_shot_validation(training.length, steps, *durations_lt)
    check_recycle_validation(training.length, steps, *durations_lt, intervals)
    reservoir: Reservoir = reservoir_seed(settings, identifier).reservoir(system.dimension)
    return PointValidator(
        reservoir=reservoir,
        training=training,
        observable=system.observable,
        plan=validation_plan(settings, steps),
        tikhonov=settings["search.tikhonov"],
        backend=settings["forecasters.esn.backend"],
    )


def write_log_errors(
    path: str, validations: Sequence[Validation], provenance: Mapping[str, str]
) -> None:
    """Write the errors in each interval, in the order of the rows of the trace.

    Strategies have different numbers of intervals: a row ends with NaN where it has fewer.
    """
    width = max(len(validation.log_errors) for validation in validations)
    errors = np.full((len(validations), width), np.nan)
    for row, validation in zip(errors, validations, strict=True):
        row[: len(validation.log_errors)] = validation.log_errors
    meaning = "log10 of the mean square error of the observable in each interval"
    variable = Variable(("row", "interval"), errors, NUMBER, meaning)
    write_netcdf(path, {"log_error": variable}, provenance)


def read_log_errors(path: str) -> list[tuple[float, ...]]:
    """Errors in each interval, one tuple for each row of the trace."""
    errors: FloatArray = read_netcdf(path, "log_error")["log_error"]
    return [tuple(row[~np.isnan(row)].tolist()) for row in errors]


def trace_rows(
    number: int, source: str, point: HyperparameterPoint, validations: Sequence[Validation]
) -> list[dict[str, Any]]:
    """Rows of the search trace: one for each strategy and Tikhonov parameter of a point."""
    return [
        {
            "evaluation": number,
            "source": source,
            "validation": validation.strategy,
            "spectral_radius": point.spectral_radius,
            "input_scaling": point.input_scaling,
            "tikhonov": validation.tikhonov,
            "objective": validation.objective,
            "solver": validation.solver,
            "reciprocal_condition": validation.reciprocal_condition,
        }
        for validation in validations
    ]

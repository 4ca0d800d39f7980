"""What the scan and the search share: the validation of a point from a job's settings."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast import durations
from burstcast.esn.reservoir import Reservoir
from burstcast.forecasters.esn import ReservoirSeed
from burstcast.tuning.hyperparameters import HyperparameterPoint, SearchSpace
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.validation import PointValidator, Validation
from burstcast_workflow.identifiers import parsed
from burstcast_workflow.jobs.data import system_of
from burstcast_workflow.jobs.length_checks import (
    check_recycle_validation,
    check_single_shot_validation,
)
from burstcast_workflow.jobs.time_unit import lyapunov_time
from burstcast_workflow.jobs.training import training_series

Settings = Mapping[str, Any]


def reservoir_seed(settings: Settings, identifier: str) -> ReservoirSeed:
    """What the reservoir of a network, or of its scan, is made from."""
    name = parsed(identifier)
    assert name.neurons is not None
    assert name.seed is not None
    return ReservoirSeed(
        settings["random_seed"],
        name.neurons,
        name.seed,
        settings["forecasters.esn.connectivity"],
        settings["forecasters.esn.input_bias"],
    )


def validation_plan(settings: Settings, steps_per_lyapunov_time: int) -> ValidationPlan:
    """Parameters of the validation strategies, in steps."""
    recycle = settings["case.recycle_validation"]
    return ValidationPlan(
        washout=durations.steps(settings["washout_lt"], steps_per_lyapunov_time),
        interval=durations.steps(settings["search.interval_lt"], steps_per_lyapunov_time),
        series=recycle["series"],
        intervals=recycle["intervals_per_series"],
    )


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

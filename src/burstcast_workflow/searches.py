"""What the scan and the search share: the validation of a point from a job's settings."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.systems.registry import make_system
from burstcast.tuning.hyperparameters import HyperparameterPoint
from burstcast.tuning.validation import PointValidator, Validation
from burstcast_workflow.network_files import backend_of, reservoir, training_series
from burstcast_workflow.series_fit import check_recycle_validation, check_single_shot_validation
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time
from burstcast_workflow.validation_plans import validation_plan


def point_validator(settings: Mapping[str, Any], inputs: Any) -> PointValidator:
    """What validates the points of the search of one reservoir.

    Parameters
    ----------
    settings
        Of the scan or of the search.
    inputs
        With ``ensemble`` and ``lyapunov``.

    Raises
    ------
    ValueError
        If the validation intervals do not fit into the series.
    """
    system = make_system(settings["system"], settings["parameters"])
    lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
    training = training_series(settings, inputs.ensemble)
    # where the Lyapunov time is computed, this is the first job that can tell
    durations_lt = settings["washout_lt"], settings["interval_lt"]
    intervals = settings["recycle_validation"]["intervals_per_series"]
    check_single_shot_validation(training.length, lyapunov_time, *durations_lt)
    check_recycle_validation(training.length, lyapunov_time, *durations_lt, intervals)
    return PointValidator(
        reservoir=reservoir(settings, system.dimension),
        training=training,
        observable=system.observable,
        plan=validation_plan(settings, lyapunov_time),
        tikhonov=settings["tikhonov"],
        backend=backend_of(settings["kernel"]),
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

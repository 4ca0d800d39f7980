"""What the scan and the search share: the validation of a point from a job's settings."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast import durations
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.reservoir import Reservoir
from burstcast.esn.training import TrainingSeries
from burstcast.systems.registry import make_system
from burstcast.tuning.hyperparameters import HyperparameterPoint
from burstcast.tuning.plan import ValidationPlan
from burstcast.tuning.validation import Validation, validate
from burstcast_workflow.network_files import reservoir, training_series
from burstcast_workflow.series_fit import check_recycle_validation, check_single_shot_validation
from burstcast_workflow.time_unit import steps_per_lyapunov_time


class PointValidator:
    """Validates points of the search of one reservoir.

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

    def __init__(self, settings: Mapping[str, Any], inputs: Any) -> None:
        system = make_system(settings["system"], settings["parameters"])
        lyapunov_time = steps_per_lyapunov_time(settings, inputs.lyapunov)
        self._settings = settings
        self._observable = system.observable
        self._reservoir: Reservoir = reservoir(settings, system.dimension)
        self._training: TrainingSeries = training_series(settings, inputs.ensemble)
        # where the Lyapunov time is computed, this is the first job that can tell
        durations_lt = settings["washout_lt"], settings["interval_lt"]
        intervals = settings["recycle_validation"]["intervals_per_series"]
        check_single_shot_validation(self._training.length, lyapunov_time, *durations_lt)
        check_recycle_validation(self._training.length, lyapunov_time, *durations_lt, intervals)
        self._plan = ValidationPlan(
            washout=durations.steps(settings["washout_lt"], lyapunov_time),
            interval=durations.steps(settings["interval_lt"], lyapunov_time),
            recycle_series=settings["recycle_validation"]["series"],
            recycle_intervals=intervals,
        )

    def __call__(self, point: HyperparameterPoint, strategies: Sequence[str]) -> list[Validation]:
        """Validate a point by each strategy with each Tikhonov parameter."""
        dynamics = Dynamics(
            self._reservoir, point.spectral_radius, point.input_scaling, self._settings["kernel"]
        )
        return validate(
            dynamics,
            self._training,
            self._observable,
            self._plan,
            self._settings["tikhonov"],
            strategies,
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

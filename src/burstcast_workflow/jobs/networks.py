"""Networks from a job's settings: reservoir, training series, the search for hyperparameters."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.data.dataset import component_scales
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.reservoir import ReservoirSeed
from burstcast.esn.training import TrainingSeries
from burstcast.files.netcdf import Variable, read_netcdf
from burstcast.files.units import NUMBER
from burstcast.forecasters._names import parsed
from burstcast.tuning.hyperparameters import SearchSpace
from burstcast.tuning.scan import Evaluation
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.validation import PointValidator
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.data import observed_rows, training_states
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


def training_series(settings: Settings, ensemble: str) -> TrainingSeries:
    """Training series of a case as forecasters see them.

    Raises
    ------
    ValueError
        If the ensemble has too few series, or a component of them is constant.
    """
    states = training_states(settings, ensemble)
    observed = observed_rows(settings, ensemble, 0, states)
    return TrainingSeries(observed=observed, input_range=component_scales(states).range)


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


def dynamics_at(
    settings: Settings, seed: ReservoirSeed, dimension: int, point: Mapping[str, Any]
) -> Dynamics:
    """Reservoir with the hyperparameters of a point: its spectral_radius and input_scaling."""
    return Dynamics(
        seed.reservoir(dimension),
        point["spectral_radius"],
        point["input_scaling"],
        settings["forecasters.esn.backend"],
    )


# -- search ----------------------------------------------------------------------------------------


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
    """
    system = system_of(settings)
    return PointValidator(
        reservoir=reservoir_seed(settings, identifier).reservoir(system.dimension),
        training=training_series(settings, ensemble),
        observable=system.observable,
        plan=_validation_plan(settings, lyapunov_time(settings, time_unit)),
        tikhonov=settings["search.tikhonov"],
        backend=settings["forecasters.esn.backend"],
    )


def _validation_plan(settings: Settings, steps_per_lyapunov_time: int) -> ValidationPlan:
    """Parameters of the validation strategies, in steps."""
    recycle = settings["case.recycle_validation"]
    washout_lt, interval_lt = settings["washout_lt"], settings["search.interval_lt"]
    steps = steps_per_lyapunov_time
    return ValidationPlan(
        washout=durations.positive_steps(washout_lt, steps, "washout_lt"),
        interval=durations.positive_steps(interval_lt, steps, "search.interval_lt"),
        series=recycle["series"],
        intervals=recycle["intervals_per_series"],
    )


def write_log_errors(
    path: str, evaluations: Sequence[Evaluation], provenance: Mapping[str, str]
) -> None:
    """Write the errors in each interval, in the order of the rows of the trace.

    Strategies have different numbers of intervals: a row ends with NaN where it has fewer.
    """
    found = [one.validation.log_errors for one in evaluations]
    errors = np.full((len(found), max(map(len, found))), np.nan)
    for row, of_row in zip(errors, found, strict=True):
        row[: len(of_row)] = of_row
    meaning = "log10 of the mean square error of the observable in each interval"
    variable = Variable(("row", "interval"), errors, NUMBER, meaning)
    write_netcdf(path, {"log_error": variable}, provenance)


def read_evaluations(rows: Sequence[Mapping[Any, Any]], log_errors: str) -> list[Evaluation]:
    """Evaluations from the rows of their trace, and the file of their errors in each interval."""
    errors: FloatArray = read_netcdf(log_errors, "log_error")["log_error"]
    return [
        Evaluation.restore(row, tuple(of_row[~np.isnan(of_row)].tolist()))
        for row, of_row in zip(rows, errors, strict=True)
    ]

"""Forecasters in files: their kind, and their fitted arrays and attributes."""

import dataclasses
from collections.abc import Mapping
from typing import Any, TypeVar

from burstcast.arrays import FloatArray
from burstcast.encoders.state_maps import StateMaps
from burstcast.files.netcdf import Variable, read_attributes, read_netcdf, read_record
from burstcast.forecasters._names import parsed
from burstcast.forecasters.base import (
    Forecaster,
    ForecasterKind,
    ForecasterRecord,
    ForecastingCase,
)
from burstcast.forecasters.registry import forecaster_class
from burstcast.systems.registry import make_system
from burstcast.systems.state_space import StateSpace
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.data import observed_rows, training_states
from burstcast_workflow.jobs.systems import parameters_of, system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time

Kind = TypeVar("Kind", bound=ForecasterKind)


def forecasting_case(settings: Settings, ensemble: str | None = None) -> ForecastingCase:
    """Knowledge of a job's forecasters beside the data; with ``ensemble``, to fit them."""
    options = settings["forecaster.options"]
    source = options.get("source")
    told: Mapping[str, Any] = settings.get("forecasters.aware") or options
    names = told.get("parameters")
    return ForecastingCase(
        system=system_of(settings),
        time_step=settings["case.ensemble.time_step"],
        sampling_stride=settings["case.ensemble.sampling_stride"],
        steps_per_lyapunov_time=lyapunov_time(settings),
        options=options,
        parameters=parameters_of(settings, names) if names else None,
        source=make_system(source["system"], source["parameters"]) if source else None,
        maps=read_record(ensemble, StateMaps) if source and ensemble else None,
    )


def kind_of(identifier: str) -> type[Forecaster]:
    """Class of a forecaster, or of a controller's forecasters, by its identifier."""
    return forecaster_class(parsed(identifier).kind)


def write_forecaster(path: str, forecaster: ForecasterKind, provenance: Mapping[str, str]) -> None:
    """Write a forecaster's record (`ForecasterKind.record`)."""
    record = forecaster.record()
    variables = {
        name: Variable(
            tuple(f"{name}_{axis}" for axis in range(array.ndim)),
            array,
            None,  # the coefficients have no common unit
            name.replace("_", " "),
        )
        for name, array in record.arrays.items()
    }
    write_netcdf(path, variables, {**provenance, **record.attributes})


def read_forecaster(
    path: str, settings: Settings, divergence_bound: float | None = None
) -> Forecaster:
    """Read a job's own forecaster of trajectories.

    ``divergence_bound``: Given where diverged forecasts must be recognised.
    """
    return read_kind(kind_of(settings["forecaster"]), path, settings, divergence_bound)


def read_kind(
    kind: type[Kind],
    path: str,
    settings: Settings,
    divergence_bound: float | None = None,
    space: StateSpace | None = None,
) -> Kind:
    """Read a forecaster of a kind (see `read_forecaster`), by default of the case's states."""
    record = ForecasterRecord(read_netcdf(path), read_attributes(path))
    case = forecasting_case(settings)
    options = {**case.options, "divergence_bound": divergence_bound}
    case = dataclasses.replace(case, options=options, system=space or case.system)
    return kind.restore(record, case)


def learnt_rows(
    forecaster: Forecaster | type[Forecaster], settings: Settings, ensemble: str
) -> FloatArray:
    """Series that a forecaster learns from: with noise, or true ones for the exact equations.

    Networks with true washouts learn from noisy series: they differ in their inputs alone.
    """
    states = training_states(settings, ensemble)
    if forecaster.sees_truth and not forecaster.has_search:
        return states
    return observed_rows(settings, ensemble, 0, states)


def seen_rows(
    forecaster: Forecaster | type[Forecaster],
    settings: Settings,
    ensemble: str,
    first: int,
    states: FloatArray,
) -> FloatArray:
    """Inputs of a forecaster from kept series: `observed_rows`, or the true states."""
    if forecaster.sees_truth:
        return states
    return observed_rows(settings, ensemble, first, states)


def seen(forecaster: Forecaster, observed: FloatArray, true: FloatArray) -> FloatArray:
    """Inputs of a forecaster: observed states, or true ones if it sees the truth."""
    return true if forecaster.sees_truth else observed

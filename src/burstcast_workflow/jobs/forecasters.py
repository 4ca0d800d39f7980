"""Forecasters in files: their kind, and their fitted arrays and attributes."""

from collections.abc import Mapping
from typing import Any, TypeVar

from burstcast.base.arrays import FloatArray
from burstcast.base.exogenous import with_inputs
from burstcast.base.files.netcdf import coefficients, read_attributes, read_netcdf, read_record
from burstcast.base.names import parsed
from burstcast.data.encoders.state_maps import StateMaps
from burstcast.forecasters._limits import TrainingLimits
from burstcast.forecasters.base import Forecaster, ForecasterKind, ForecasterRecord, ForecastingCase
from burstcast.forecasters.registry import as_forecaster, kind_class, make_kind
from burstcast.systems.registry import make_system
from burstcast_workflow.harness.settings import JobSettings, at
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.cases import Clock, Sampling, System
from burstcast_workflow.jobs.series import Observed


class CaseInputs(JobSettings):
    """Noise of a case, and the bias of its networks' inputs."""

    noise: float = at("case.training.noise")
    input_bias: float = at("forecasters.esn.input_bias")


Kind = TypeVar("Kind", bound=ForecasterKind)


_LOW, _HIGH = "training_low", "training_high"
"""Variables of the ranges of the training series in the file of a forecaster."""


def write_forecaster(
    path: str,
    forecaster: ForecasterKind,
    provenance: Mapping[str, str],
    limits: TrainingLimits | None = None,
) -> None:
    """Write a forecaster's record (`ForecasterKind.record`), with the ranges of its training."""
    record = forecaster.record()
    ranges = {} if limits is None else {_LOW: limits.low, _HIGH: limits.high}
    attributes = {**provenance, **record.attributes}
    write_netcdf(path, coefficients({**record.arrays, **ranges}), attributes)


class Forecasting(JobSettings):
    """What forecasters of a kind know beside the data."""

    system: System
    sampling: Sampling
    clock: Clock
    options: dict[str, Any] = at("forecaster.options")
    divergence_bound: float | None = at("forecaster.divergence_bound")
    source: dict[str, Any] | None = at("forecaster.source", otherwise=None)
    random_seed: int = at("random_seed")

    def unfitted(self) -> ForecasterKind:
        """The job's forecaster, or its controller's, with its options alone."""
        identifier = self.identity.get("controller") or self.forecaster
        kind, options = parsed(identifier).kind, self.options
        if any(option.name == "divergence_bound" for option in kind_class(kind).option_fields()):
            options = {**options, "divergence_bound": self.divergence_bound}
        return make_kind(kind, options)

    def forecasting_case(
        self,
        ensemble: str | None = None,
        aware: Mapping[str, Any] | None = None,
        actuation: Mapping[str, Any] | None = None,
    ) -> ForecastingCase:
        """Knowledge of the job's forecasters; with ``ensemble``, to fit them.

        ``aware`` says what forecasters of any kind know of parameters, ``actuation`` of which
        actuator they know the share.
        """
        source, names = self.source, (aware or self.options).get("parameters")
        return ForecastingCase(
            system=self.system.space,
            time_step=self.sampling.time_step,
            sampling_stride=self.sampling.stride,
            steps_per_lyapunov_time=self.clock.lyapunov_time,
            random_seed=self.random_seed,
            parameters=self.system.forecaster_parameters(names, actuation) if names else None,
            source=make_system(source["system"], source["parameters"]) if source else None,
            maps=read_record(ensemble, StateMaps) if source and ensemble else None,
        )

    def read_forecaster(
        self,
        path: str,
        aware: Mapping[str, Any] | None = None,
    ) -> Forecaster:
        """Read the job's own forecaster of trajectories (`unfitted`)."""
        unfitted = as_forecaster(self.unfitted())
        return read_kind(unfitted, path, self.forecasting_case(aware=aware))


def read_kind(unfitted: Kind, path: str, case: ForecastingCase) -> Kind:
    """Read a forecaster with the options of an unfitted one (see `Forecasting.read_forecaster`)."""
    arrays = read_netcdf(path)
    low, high = arrays.pop(_LOW, None), arrays.pop(_HIGH, None)
    restored = unfitted.restore(ForecasterRecord(arrays, read_attributes(path)), case)
    if low is None or high is None or not isinstance(restored, Forecaster):
        return restored
    return restored.within(TrainingLimits(low, high))


class Observing(JobSettings):
    """What forecasters of a kind know, and what they learn from."""

    forecasting: Forecasting
    observed: Observed

    def learnt_rows(self, forecaster: Forecaster, ensemble: str) -> FloatArray:
        """Series that a forecaster learns from: with noise, or true ones for the exact equations.

        Networks with true washouts learn from noisy series: they differ in their inputs alone.
        """
        states = self.observed.training.states(ensemble)
        if forecaster.sees_truth and not forecaster.has_search:
            return states
        return self.observed.rows(ensemble, 0, states)


def seen_rows(
    forecaster: Forecaster, observed: Observed, ensemble: str, first: int, states: FloatArray
) -> FloatArray:
    """Inputs of a forecaster from kept series: as they were observed, or the true states."""
    if forecaster.sees_truth:
        return states
    return observed.rows(ensemble, first, states)


def seen(
    forecaster: Forecaster,
    observed: FloatArray,
    true: FloatArray,
    exogenous: FloatArray | None = None,
) -> FloatArray:
    """Inputs of a forecaster: observed states, or true ones if it sees the truth.

    ``exogenous``: Exogenous inputs, for forecasters that use them (`burstcast.base.exogenous`).
    """
    states = true if forecaster.sees_truth else observed
    if exogenous is None or not forecaster.aware:
        return states
    return with_inputs(states, exogenous)

"""Runs of control: what the scripts of control set up."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_netcdf, read_record, read_rows
from burstcast.control.actuation import ActuationValues, actuated_system, reversed_actuation
from burstcast.control.experiment import ControlExperiment, controlled_series, noise_of_flows
from burstcast.control.records import FlowRecords
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.strategies.registry import make_strategy
from burstcast.control.timing import Schedule
from burstcast.control.windows import WindowCounts
from burstcast.data.dataset import Scales, component_scales
from burstcast.data.encoders.channels import IDENTITY, EncodedFlow, StateChannels, encoding_case
from burstcast.data.observation.part import ObservedPart
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_space
from burstcast.systems.state_space import MEASURED
from burstcast_workflow.harness.canonical import canonical_json
from burstcast_workflow.harness.settings import JobSettings, at, computed
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.cases import Washout
from burstcast_workflow.jobs.forecasters import Forecasting, read_kind
from burstcast_workflow.jobs.series import Training

Sensor: TypeAlias = ObservedPart | EncodedFlow


def alarm_rate(flows: str) -> float:
    """Share of the forecasts of flows that raised an alarm, over flows that do not laminarise."""
    kept, counts = read_record(flows, FlowRecords).kept, read_record(flows, WindowCounts)
    forecasts = int(counts.forecasts[kept].sum())
    return int(counts.alarms[kept].sum()) / forecasts if forecasts else 0.0


class Controlled(JobSettings):
    """Runs of control: how flows are controlled, and by whom."""

    forecasting: Forecasting
    washout: Washout
    training: Training
    random_seed: int = at("random_seed")
    event_threshold: float = computed("event_threshold.event_threshold")
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")
    actuation: dict[str, Any] = at("case.actuation")
    flows: int = at("control.flows")
    plan: dict[str, Any] = at("control.run")
    kind_of_strategy: str = at("control.run.strategy")
    strategy_settings: dict[str, Any] = at("control.run.settings")
    starts: str = at("control.run.starts")
    quiet_lt: float = at("control.run.quiet_lt")
    span_lt: float = at("control.run.span_lt")
    delay_lt: float = at("control.run.delay_lt")
    strength: float = at("control.run.strength")
    noise: float = at("control.run.noise")
    observed: str | None = at("control.run.observed", otherwise=None)

    @property
    def attributes(self) -> dict[str, str]:
        """Plan of control, for the tables that are made of its records."""
        return {"plan": canonical_json(self.plan)}

    def setup(
        self,
        ensemble: str,
        summary: str,
        forecasters: Sequence[str],
        sensor: Sensor | None = None,
        aware: Mapping[str, Any] | None = None,
    ) -> tuple[ControlStrategy, ControlExperiment, list[Any], FloatArray | None]:
        """Set up the job from its inputs.

        Returns the strategy, the experiment, the forecasters that are asked, and the observation
        noise of each flow at each step, ``(flows, steps, dimension)``; None for forecasters that
        see the truth. ``aware`` says what forecasters know of parameters.
        """
        strategy, experiment, asked = self.deciding(ensemble, summary, forecasters, sensor, aware)
        noise, scales = None, self.noise_scales(ensemble, asked, sensor)
        if scales is not None:
            noise = noise_of_flows(
                experiment.series,
                strategy.timing(experiment.schedule).length,
                self.noise,
                scales,
                experiment.root_seed,
                self.observed or experiment.case,
            )
        return strategy, experiment, asked, noise

    def deciding(
        self,
        ensemble: str,
        summary: str,
        forecasters: Sequence[str],
        sensor: Sensor | None,
        aware: Mapping[str, Any] | None,
    ) -> tuple[ControlStrategy, ControlExperiment, list[Any]]:
        """Strategy, experiment and forecasters of the job (see `setup`)."""
        strategy = make_strategy(self.kind_of_strategy, self.strategy_settings)
        experiment = replace(self.experiment(ensemble, summary), sensor=sensor)
        if strategy.informed:
            assert aware is not None
            values = ActuationValues.of(
                aware["parameters"], experiment.system, experiment.actuated_system, self.strength
            )
            experiment = replace(experiment, values=values)
        asked: list[Any] = []
        if forecasters:  # the options of none concern no job
            case = self.forecasting.forecasting_case(aware=aware, actuation=self.actuation)
            case = replace(case, system=experiment.observed_space)
            unfitted = self.forecasting.unfitted()
            asked = [read_kind(unfitted, path, case) for path in forecasters]
        return strategy, experiment, asked

    def noise_scales(
        self, ensemble: str, asked: Sequence[Any], sensor: Sensor | None
    ) -> Scales | None:
        """Scales of the observation noise; None for forecasters that see the truth."""
        if any(forecaster.sees_truth for forecaster in asked):
            return None
        seen = read_rows(ensemble, "state", 0, self.training.series)
        if sensor is not None:
            seen = np.moveaxis(sensor(np.moveaxis(seen, -1, 0)), 0, -1)
        return component_scales(seen)

    def experiment(self, ensemble: str, summary: str) -> ControlExperiment:
        """Experiment of the job.

        Quiet flows begin with the first states of the kept series, unselected ones with the last:
        what follows them has had no say in what is kept.
        """
        system, of_strategy = self.forecasting.system.equations, self.strategy_settings
        washout, sampling = self.washout.steps, self.forecasting.sampling
        force, strength = self.actuation["force"], self.strength
        reverses = bool(of_strategy.get("push") or of_strategy.get("reversible"))
        kept = read_json(summary)["series_kept"]
        series = controlled_series(kept, self.training.series, self.flows)
        states = read_rows(ensemble, "state", series.start, series.stop)
        quiet = self.starts == "quiet"
        return ControlExperiment(
            system=system,
            actuated_system=actuated_system(system, self.actuation["parameters"], force, strength),
            reversed_system=(
                reversed_actuation(system, force, strength)
                if reverses and force is not None
                else None
            ),
            threshold=self.event_threshold,
            series=series,
            washouts=np.ascontiguousarray(states[:, :washout] if quiet else states[:, -washout:]),
            quiet_starts=quiet,
            schedule=Schedule(
                washout=washout,
                quiet_lt=self.quiet_lt,
                span_lt=self.span_lt,
                delay_lt=self.delay_lt,
                actuation_start_lt=self.actuation["start_lt"],
                actuation_duration_lt=self.actuation["duration_lt"],
                steps_per_lyapunov_time=self.washout.clock.lyapunov_time,
                sampling_stride=sampling.stride,
                time_step=sampling.time_step,
            ),
            root_seed=self.random_seed,
            case=self.case,
        )


def sensor_of(
    sensor: Mapping[str, Any] | None, system: DynamicalSystem, encoder: str | Sequence[str]
) -> Sensor | None:
    """Sensor of the flows, with the encoder that its case has fitted; None: all is observed."""
    if sensor is None:
        return None
    if not isinstance(encoder, str):
        return ObservedPart.of(system, sensor["components"], sensor["of"])
    options = sensor["encoder"] or {}
    case = encoding_case(system, sensor["sensors"], options)
    channels = StateChannels.restore(options.get("kind", IDENTITY), case, read_netcdf(encoder))
    return EncodedFlow(channels, system, make_space(MEASURED, sensor["parameters"]))

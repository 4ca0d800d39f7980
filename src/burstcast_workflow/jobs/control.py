"""Runs of control: what the scripts of control set up."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.control.actuation import ActuationValues, actuated_system, reversed_actuation
from burstcast.control.experiment import ControlExperiment, controlled_series, noise_of_flows
from burstcast.control.records import FlowRecords, neither
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.strategies.registry import make_strategy
from burstcast.control.timing import Schedule
from burstcast.control.windows import WindowCounts
from burstcast.data.dataset import component_scales
from burstcast.encoders.channels import IDENTITY, EncodedFlow, StateChannels, encoding_case
from burstcast.files.netcdf import read_netcdf, read_record, read_rows
from burstcast.forecasters._names import parsed
from burstcast.forecasters.registry import kind_class
from burstcast.observation.part import ObservedPart
from burstcast.systems.parameters import SHARE, SystemParameters
from burstcast.systems.registry import make_space
from burstcast.systems.state_space import MEASURED
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.forecasters import read_kind
from burstcast_workflow.jobs.systems import equations_of, parameters_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


def control_setup(
    settings: Settings,
    ensemble: str,
    summary: str,
    forecasters: Sequence[str],
    encoder: str | Sequence[str] = (),
) -> tuple[ControlStrategy, ControlExperiment, list[Any], FloatArray | None]:
    """Set up a job of control from its settings and inputs.

    Returns the strategy, the experiment, the forecasters that are asked, and the observation noise
    of each flow at each step, ``(flows, steps, dimension)``; None for forecasters that see the
    truth.
    """
    strategy = make_strategy(settings["control.run.strategy"], settings["control.run.settings"])
    experiment = control_experiment(settings, ensemble, summary)
    experiment = replace(experiment, sensor=_sensor(settings, experiment, encoder))
    if strategy.told:
        names = settings["forecasters.aware"]["parameters"]
        experiment = replace(experiment, values=_values(settings, experiment, names))
    kind = parsed(settings["controller"]).kind
    sensor = experiment.sensor
    asked: list[Any] = [
        read_kind(kind_class(kind), path, settings, space=experiment.observed_space)
        for path in forecasters
    ]
    noise = None
    if not any(forecaster.sees_truth for forecaster in asked):
        seen = read_rows(ensemble, "state", 0, settings["case.training.series"])
        if sensor is not None:
            seen = np.moveaxis(sensor(np.moveaxis(seen, -1, 0)), 0, -1)
        noise = noise_of_flows(
            experiment.series,
            strategy.timing(experiment.schedule).length,
            settings["control.run.noise"],
            component_scales(seen),
            experiment.root_seed,
            settings["control.run"].get("observed", experiment.case),
        )
    return strategy, experiment, asked, noise


def alarm_rate(flows: str) -> float:
    """Share of the forecasts of flows that raised an alarm, over flows that do not laminarise."""
    kept, counts = neither(read_record(flows, FlowRecords)), read_record(flows, WindowCounts)
    forecasts = int(counts.forecasts[kept].sum())
    return int(counts.alarms[kept].sum()) / forecasts if forecasts else 0.0


def control_experiment(settings: Settings, ensemble: str, summary: str) -> ControlExperiment:
    """Experiment of a control job, from its settings and inputs.

    Quiet flows begin with the first states of the kept series, unselected ones with the last:
    what follows them has had no say in what is kept.
    """
    system, steps = equations_of(settings), lyapunov_time(settings)
    actuation, strength = settings["case.actuation"], settings["control.run.strength"]
    of_strategy = settings["control.run.settings"]
    reverses = bool(of_strategy.get("push") or of_strategy.get("reversible"))
    washout = durations.steps(settings["washout_lt"], steps)
    training = settings["case.training.series"]
    kept = read_json(summary)["series_kept"]
    series = controlled_series(kept, training, settings["control.flows"])
    states = read_rows(ensemble, "state", series.start, series.stop)
    quiet = settings["control.run.starts"] == "quiet"
    return ControlExperiment(
        system=system,
        actuated_system=actuated_system(
            system,
            actuation["parameters"],
            actuation["force"],
            strength,
        ),
        reversed_system=(
            reversed_actuation(system, actuation["force"], strength)
            if reverses and actuation["force"] is not None
            else None
        ),
        threshold=settings["case.event_threshold"],
        series=series,
        washouts=np.ascontiguousarray(states[:, :washout] if quiet else states[:, -washout:]),
        quiet_starts=quiet,
        schedule=Schedule(
            washout=washout,
            quiet_lt=settings["control.run.quiet_lt"],
            span_lt=settings["control.run.span_lt"],
            delay_lt=settings["control.run.delay_lt"],
            actuation_start_lt=actuation["start_lt"],
            actuation_duration_lt=actuation["duration_lt"],
            steps_per_lyapunov_time=steps,
            sampling_stride=settings["case.ensemble.sampling_stride"],
            time_step=settings["case.ensemble.time_step"],
        ),
        root_seed=settings["random_seed"],
        case=settings["case"],
    )


def _sensor(
    settings: Settings, experiment: ControlExperiment, encoder: str | Sequence[str]
) -> ObservedPart | EncodedFlow | None:
    """Sensor of the flows, with the encoder that its case has fitted; None: all is observed."""
    said, system = settings.get("control.sensor"), experiment.system
    if said is None:
        return None
    if not isinstance(encoder, str):
        return ObservedPart.of(system, said["components"], said["of"])
    options = said["encoder"] or {}
    case = encoding_case(system, said["sensors"], options)
    channels = StateChannels.restore(options.get("kind", IDENTITY), case, read_netcdf(encoder))
    return EncodedFlow(channels, system, make_space(MEASURED, said["parameters"]))


def _values(
    settings: Settings, experiment: ControlExperiment, names: Sequence[str]
) -> ActuationValues:
    """Parameter values for forecasters, with the actuator off and on."""
    off = parameters_of(settings, names)
    if list(names) == [SHARE]:
        strength = settings["control.run.strength"]
        return ActuationValues(off.own, (strength,), (-strength,))
    return ActuationValues(off.own, SystemParameters.of(experiment.actuated_system, names).own)

"""What the control scripts share: the flows of a case, and the record of what control achieved."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from burstcast import durations, random_streams
from burstcast.arrays import FloatArray
from burstcast.control.accounting import Accounting, account
from burstcast.control.actuation import Actuation, actuated_system
from burstcast.control.flows import ControlledFlows, follow
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.forecast import ForecastMonitor
from burstcast.control.monitors.random import RandomMonitor
from burstcast.control.timing import Timing
from burstcast.dataset import component_scales, observe
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.equations import EquationsForecaster
from burstcast.statistics.densities import bin_edges
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_system
from burstcast_workflow.storage import (
    Variable,
    read_json,
    read_rows,
    write_json,
    write_netcdf,
)
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


@dataclass(frozen=True)
class ControlSetting:
    """A case under control at one prediction time: equations, actuation, timing, flows.

    Attributes
    ----------
    system, actuation, timing
        Of the controlled flows.
    washouts
        True states that the flows begin with, ``(flows, washout, dimension)``.
    first_series
        Row of the first flow's series in the ensemble.
    """

    settings: Mapping[str, Any]
    system: DynamicalSystem
    actuation: Actuation
    timing: Timing
    washouts: FloatArray
    training_states: FloatArray
    first_series: int

    @classmethod
    def read(cls, settings: Mapping[str, Any], inputs: Any) -> "ControlSetting":
        """Build from a job's settings and inputs (``ensemble``, ``summary``, ``lyapunov``)."""
        system = make_system(settings["system"], settings["parameters"])
        lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
        record = settings["actuation"]
        timing = Timing(
            prediction_time_lt=settings["prediction_time_lt"],
            window_lt=settings["window_lt"],
            span_lt=settings["span_lt"],
            washout=durations.steps(settings["washout_lt"], lyapunov_time),
            steps_per_lyapunov_time=lyapunov_time,
            sampling_stride=settings["sampling_stride"],
            time_step=settings["time_step"],
        )
        training = settings["training"]["series"]
        flows = min(settings["flows"], read_json(inputs.summary)["series_kept"] - training)
        states = read_rows(inputs.ensemble, "state", training, training + flows)
        return cls(
            settings=settings,
            system=system,
            actuation=Actuation(
                system=actuated_system(system, record["parameters"], record["force"]),
                start_lt=record["start_lt"],
                duration_lt=record["duration_lt"],
            ),
            timing=timing,
            washouts=np.ascontiguousarray(states[:, : timing.washout]),
            training_states=read_rows(inputs.ensemble, "state", 0, training),
            first_series=training,
        )

    def forecast_monitor(self, forecaster: Forecaster) -> ForecastMonitor:
        """Monitor that raises an alarm if a forecast crosses the event threshold."""
        return ForecastMonitor(
            forecaster, self.system.observable, self.timing, self.settings["event_threshold"]
        )

    def equations_monitor(self) -> ForecastMonitor:
        """Monitor that knows the equations."""
        return self.forecast_monitor(
            EquationsForecaster(
                self.system, self.settings["time_step"], self.settings["sampling_stride"]
            )
        )

    def random_monitor(self, alarm_rate: float) -> RandomMonitor:
        """Monitor that raises alarms at random, at a given rate."""
        occasions = self.timing.most_forecasts
        draws = np.stack(
            [
                random_streams.stream(
                    self.settings["random_seed"],
                    "random alarms",
                    self.settings["case"],
                    self.settings.get("seed", 0),
                    self.first_series + flow,
                ).random(occasions)
                for flow in range(len(self.washouts))
            ]
        )
        return RandomMonitor(alarm_rate, draws)

    def noise(self) -> FloatArray:
        """Observation noise of each flow at each step, ``(flows, steps, dimension)``."""
        scales = component_scales(self.training_states)
        silence = np.zeros((len(self.washouts), self.timing.length, self.system.dimension))
        return observe(
            silence,
            self.first_series,
            self.settings["training"]["noise"],
            scales,
            self.settings["random_seed"],
            "control noise",
            self.settings["case"],
        )

    def follow(
        self,
        monitor: Monitor,
        *,
        noisy: bool,
        rows: slice = slice(None),
        keep_states: bool = False,
    ) -> ControlledFlows:
        """Follow the flows (or some of them) with and without control."""
        return follow(
            self.system,
            self.washouts[rows],
            monitor,
            self.actuation,
            self.timing,
            self.settings["event_threshold"],
            noise=self.noise()[rows] if noisy else None,
            keep_states=keep_states,
        )

    def account(self, followed: ControlledFlows) -> Accounting:
        """Count what control achieved."""
        density = self.settings["controlled_density"]
        low, high = density["range"]
        return account(
            followed,
            self.settings["laminarisation_threshold"],
            bin_edges(low, high, density["bins"]),
        )


SCORES = (
    "exceedance_uncontrolled",
    "exceedance_controlled",
    "exceedance_free",
    "reduction",
    "control_fraction",
    "alarm_rate",
)


def write_accounting(outputs: Any, accounting: Accounting, provenance: Mapping[str, str]) -> None:
    """Write the counts and scores as JSON, the histograms as NetCDF."""
    counts = {
        field.name: getattr(accounting, field.name)
        for field in dataclasses.fields(accounting)
        if isinstance(getattr(accounting, field.name), int)
    }
    scores = {name: getattr(accounting, name) for name in SCORES}
    defined = {name: value if np.isfinite(value) else None for name, value in scores.items()}
    write_json(outputs.counts, {**counts, **defined, "provenance": dict(provenance)})
    write_netcdf(
        Path(outputs.histograms),
        {
            "edge": Variable(("edge",), accounting.edges, "1", "edges of the bins"),
            **{
                name: Variable(
                    ("bin",), getattr(accounting, f"histogram_{name}"), "1", f"steps, {description}"
                )
                for name, description in (
                    ("uncontrolled", "without control"),
                    ("controlled", "with control"),
                    ("free", "with control, outside actuation"),
                )
            },
        },
        provenance,
    )

"""What the control scripts share: the flows of a case, and the record of what control achieved."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.control.actuation import Actuation, actuated_system
from burstcast.control.experiment import controlled_series, observation_noise
from burstcast.control.flows import ControlledFlows, run_controlled_flows
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.forecast import ForecastMonitor
from burstcast.control.outcome import Outcome, count_outcome
from burstcast.control.scores import SCORES
from burstcast.control.timing import Timing
from burstcast.dataset import component_scales
from burstcast.forecasters.base import Forecaster
from burstcast.systems.base import DynamicalSystem
from burstcast_workflow.harness.storage import (
    Variable,
    read_json,
    read_rows,
    write_json,
    write_netcdf,
)
from burstcast_workflow.jobs.bins import edges_of
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


@dataclass(frozen=True)
class ControlSetting:
    """A case under control at one prediction time: equations, actuation, timing, flows.

    Attributes
    ----------
    settings
        Of the job.
    system, actuation, timing
        Of the controlled flows.
    series
        Rows of the flows' series in the ensemble.
    washouts
        True states that the flows begin with, ``(flows, washout, dimension)``.
    training_states
        Of the training series, ``(series, time, dimension)``.
    """

    settings: Mapping[str, Any]
    system: DynamicalSystem
    actuation: Actuation
    timing: Timing
    series: range
    washouts: FloatArray
    training_states: FloatArray

    @classmethod
    def read(
        cls,
        settings: Mapping[str, Any],
        ensemble: str,
        summary: str,
        time_unit: str | Sequence[str],
    ) -> "ControlSetting":
        """Build from a job's settings and inputs."""
        system, steps = system_of(settings), lyapunov_time(settings, time_unit)
        record = settings["case.actuation"]
        timing = Timing(
            prediction_time_lt=settings["prediction_time_lt"],
            window_lt=settings["control.window_lt"],
            span_lt=settings["control.span_lt"],
            washout=durations.steps(settings["washout_lt"], steps),
            steps_per_lyapunov_time=steps,
            sampling_stride=settings["case.ensemble.sampling_stride"],
            time_step=settings["case.ensemble.time_step"],
        )
        training = settings["case.training.series"]
        kept = read_json(summary)["series_kept"]
        series = controlled_series(kept, training, settings["control.flows"])
        states = read_rows(ensemble, "state", series.start, series.stop)
        return cls(
            settings=settings,
            system=system,
            actuation=Actuation(
                system=actuated_system(system, record["parameters"], record["force"]),
                start_lt=record["start_lt"],
                duration_lt=record["duration_lt"],
            ),
            timing=timing,
            series=series,
            washouts=np.ascontiguousarray(states[:, : timing.washout]),
            training_states=read_rows(ensemble, "state", 0, training),
        )

    def forecast_monitor(self, forecaster: Forecaster) -> ForecastMonitor:
        """Monitor that raises an alarm if a forecast crosses the event threshold."""
        threshold = self.settings["case.event_threshold"]
        return ForecastMonitor(forecaster, self.system.observable, self.timing, threshold)

    def noise(self) -> FloatArray:
        """Observation noise of each flow at each step, ``(flows, steps, dimension)``."""
        return observation_noise(
            self.series,
            self.timing.length,
            self.settings["case.training.noise"],
            component_scales(self.training_states),
            self.settings["random_seed"],
            self.settings["case"],
        )

    def run(
        self,
        monitor: Monitor,
        *,
        noisy: bool,
        rows: slice = slice(None),
        keep_states: bool = False,
    ) -> ControlledFlows:
        """Follow the flows (or some of them) with and without control."""
        return run_controlled_flows(
            self.system,
            self.washouts[rows],
            monitor,
            self.actuation,
            self.timing,
            self.settings["case.event_threshold"],
            noise=self.noise()[rows] if noisy else None,
            keep_states=keep_states,
        )

    def outcome(self, flows: ControlledFlows) -> Outcome:
        """Count what control achieved."""
        return count_outcome(
            flows,
            self.settings["case.laminarisation_threshold"],
            edges_of(self.settings["case.controlled_density"]),
        )


def write_outcome(
    counts_file: str, histograms: str, outcome: Outcome, provenance: Mapping[str, str]
) -> None:
    """Write the counts and scores as JSON, the histograms as NetCDF."""
    counts = {
        field.name: getattr(outcome, field.name)
        for field in dataclasses.fields(outcome)
        if isinstance(getattr(outcome, field.name), int)
    }
    scores = {name: getattr(outcome, name) for name in SCORES}
    defined = {name: value if np.isfinite(value) else None for name, value in scores.items()}
    write_json(counts_file, {**counts, **defined, "provenance": dict(provenance)})
    write_netcdf(
        histograms,
        {
            "edge": Variable(("edge",), outcome.edges, "1", "edges of the bins"),
            **{
                name: Variable(
                    ("bin",), getattr(outcome, f"histogram_{name}"), "1", f"steps, {description}"
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

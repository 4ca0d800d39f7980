"""Follow the flow whose suppressed event shows best what control by a forecaster does."""

from dataclasses import replace

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.control.example import suppressed_event_times
from burstcast.control.outcome import largest_suppressed_event
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.timing import Timing
from burstcast.forecasters.base import Forecaster
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import Variable, write_netcdf
from burstcast_workflow.jobs.control import control_experiment, control_noise, control_strategy
from burstcast_workflow.jobs.forecasters import read_forecaster

BEFORE_LT = 1.0
AFTER_LT = 0.5
"""What is shown before the alarm and after the last of the event's times, if there is as much."""


def suppressed_event(
    *,
    ensemble: str,
    summary: str,
    time_unit: str | list[str],
    forecaster: str,
    event: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the observable with and without control, and the states at four times."""
    experiment = control_experiment(settings, ensemble, summary, time_unit)
    strategy = control_strategy(settings)
    assert isinstance(strategy, PredictionTriggered)
    who = read_forecaster(forecaster, settings, time_unit)
    timing, dimension = strategy.timing(experiment.schedule), experiment.system.dimension
    noise = None
    if not who.sees_truth:
        noise = control_noise(settings, ensemble, experiment, timing)
    monitor = strategy.monitor(experiment, [who])
    chosen = largest_suppressed_event(
        strategy.follow(experiment, monitor, noise=noise),
        settings["case.laminarisation_threshold"],
    )
    start, stop = strategy.actuation(experiment).interval(timing)
    # in integration steps
    unit = timing.steps_per_lyapunov_time * timing.sampling_stride
    if chosen is None:
        steps = marks = np.empty(0, dtype=np.int64)
        uncontrolled = controlled = forecast = np.empty((0, dimension))
    else:
        only = slice(chosen.row, chosen.row + 1)
        flow_noise = None if noise is None else noise[only]
        flow = strategy.follow(
            replace(experiment, washouts=experiment.washouts[only]),
            monitor,
            noise=flow_noise,
            keep_states=True,
        )
        times = suppressed_event_times(
            flow.uncontrolled[0, chosen.alarm_step :],
            settings["case.event_threshold"],
            start // timing.sampling_stride,
            (timing.window_start, timing.window_end),
        )
        lyapunov_time = timing.steps_per_lyapunov_time
        first = max(0, chosen.alarm_step - round(BEFORE_LT * lyapunov_time))
        last = chosen.alarm_step + max(times[-1], timing.window_end + timing.window_start)
        last = min(last + round(AFTER_LT * lyapunov_time), timing.counted_until)
        steps = np.arange(first, last + 1) - chosen.alarm_step
        marks = np.array(times) - steps[0]
        assert flow.uncontrolled_states is not None
        assert flow.controlled_states is not None
        uncontrolled = flow.uncontrolled_states[0, first : last + 1]
        controlled = flow.controlled_states[0, first : last + 1]
        forecast = np.full_like(controlled, np.nan)
        ahead = slice(1 - steps[0], 1 - steps[0] + timing.window_end)
        forecast[ahead] = _forecast(
            who, timing, flow.controlled_states[0], flow_noise, chosen.alarm_step
        )
    observable = experiment.system.observable
    name = experiment.system.observable_name
    write_netcdf(
        event,
        {
            "time_lt": Variable(
                ("time",),
                steps / timing.steps_per_lyapunov_time,
                "1",
                "time after the alarm in Lyapunov times",
            ),
            **{
                key: Variable(("time",), observable(states.T), "1", f"{name} {description}")
                for key, states, description in (
                    ("uncontrolled", uncontrolled, "without control"),
                    ("controlled", controlled, "with control"),
                    ("forecast", forecast, "forecast"),
                )
            },
            "actuation_lt": Variable(
                ("end",), np.array([start, stop]) / unit, "1", "start and end of the actuation"
            ),
            "mark": Variable(("mark",), marks, "1", "entries of time that the states are for"),
            **{
                f"{key}_state": Variable(
                    ("mark", "component"), states[marks], "1", f"states {description}"
                )
                for key, states, description in (
                    ("uncontrolled", uncontrolled, "without control"),
                    ("controlled", controlled, "with control"),
                )
            },
        },
        {
            **provenance,
            "series": -1 if chosen is None else experiment.series[chosen.row],
            "alarm_step": -1 if chosen is None else chosen.alarm_step,
        },
    )


def _forecast(
    forecaster: Forecaster,
    timing: Timing,
    states: FloatArray,
    noise: FloatArray | None,
    now: int,
) -> FloatArray:
    """Forecast of one flow that was made at a step, up to the end of its window."""
    washout = slice(now + 1 - timing.washout, now + 1)
    observed = states[washout] if noise is None else states[washout] + noise[0, washout]
    memory = forecaster.start(np.ascontiguousarray(observed[:, :, np.newaxis]))
    forecast, _ = forecaster.advance(memory, timing.window_end)
    return forecast[:, :, 0]


if __name__ == "__main__":
    run_job(snakemake, suppressed_event)  # noqa: F821 - Snakemake puts it there

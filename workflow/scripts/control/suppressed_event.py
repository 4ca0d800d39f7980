"""Follow the flow whose suppressed event shows best what control by a forecaster does."""

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.control.example import suppressed_event_times
from burstcast.control.flows import ControlledFlows
from burstcast.control.outcome import SuppressedEvent, largest_suppressed_event
from burstcast.forecasters.base import Forecaster
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import Variable, write_netcdf
from burstcast_workflow.jobs.control import ControlSetting
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
    setting = ControlSetting.read(settings, ensemble, summary, time_unit)
    who = read_forecaster(forecaster, settings, time_unit)
    monitor, noisy = setting.forecast_monitor(who), not who.sees_truth
    chosen = largest_suppressed_event(
        setting.run(monitor, noisy=noisy), settings["case.laminarisation_threshold"]
    )
    timing, dimension = setting.timing, setting.system.dimension
    start, stop = setting.actuation.interval(timing)
    # in integration steps
    unit = timing.steps_per_lyapunov_time * timing.sampling_stride
    if chosen is None:
        steps = marks = np.empty(0, dtype=np.int64)
        uncontrolled = controlled = forecast = np.empty((0, dimension))
    else:
        only = slice(chosen.row, chosen.row + 1)
        flow = setting.run(monitor, noisy=noisy, rows=only, keep_states=True)
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
        forecast[ahead] = _forecast(setting, who, flow, chosen)
    observable = setting.system.observable
    name = setting.system.observable_name
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
            "series": -1 if chosen is None else setting.series[chosen.row],
            "alarm_step": -1 if chosen is None else chosen.alarm_step,
        },
    )


def _forecast(
    setting: ControlSetting, forecaster: Forecaster, flow: ControlledFlows, chosen: SuppressedEvent
) -> FloatArray:
    """Forecast that raised the alarm, up to the end of its window."""
    timing, now = setting.timing, chosen.alarm_step
    washout = slice(now + 1 - timing.washout, now + 1)
    assert flow.controlled_states is not None
    observed = flow.controlled_states[0, washout]
    if not forecaster.sees_truth:
        observed = observed + setting.noise()[chosen.row, washout]
    memory = forecaster.start(np.ascontiguousarray(observed[:, :, np.newaxis]))
    forecast, _ = forecaster.advance(memory, timing.window_end)
    return forecast[:, :, 0]


if __name__ == "__main__":
    run_job(snakemake, suppressed_event)  # noqa: F821 - Snakemake puts it there

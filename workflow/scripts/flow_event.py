"""Find an event of the test set whose flow is worth seeing, and forecast it with one network."""

from typing import Any

import numpy as np

from burstcast import durations
from burstcast.dataset import component_scales, observed_series
from burstcast.forecast.example_events import EventCriterion, isolated_events, predicted_event
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.network_files import read_forecaster
from burstcast_workflow.storage import Variable, read_json, read_rows, write_netcdf
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the observable through the event and the states at four times, true and forecast."""
    system = make_system(settings["system"], settings["parameters"])
    lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
    wanted, threshold = settings["flow_event"], settings["event_threshold"]
    calm = read_json(inputs.summary)["mean_observable"]
    training = settings["training"]["series"]
    truth = read_rows(inputs.ensemble, "observable", training, training + settings["test_series"])
    trained = read_rows(inputs.ensemble, "state", 0, training)
    states = read_rows(inputs.ensemble, "state", training, training + settings["test_series"])
    observed = observed_series(
        states,
        training,
        settings["training"]["noise"],
        component_scales(trained),
        settings["random_seed"],
        settings["case"],
    )
    forecaster = read_forecaster(inputs.network, settings["kernel"])
    lead = durations.steps(wanted["lead_lt"], lyapunov_time)
    washout = durations.steps(settings["washout_lt"], lyapunov_time)
    quiet = durations.steps(wanted["quiet_lt"], lyapunov_time)
    events = isolated_events(
        truth,
        EventCriterion(
            threshold=threshold,
            calm=calm,
            quiet=quiet,
            longest=durations.steps(wanted["longest_lt"], lyapunov_time),
            wanted_peak=wanted["peak"],
        ),
        before=lead + washout - 1,
    )
    event = predicted_event(
        events,
        forecaster,
        observed,
        states,
        lead=lead,
        washout=washout,
        tolerance=wanted["tolerance"] * float(np.linalg.norm(trained, axis=-1).max()),
    )
    if event is None:
        time = np.empty(0)
        shown = forecast = np.empty((0, system.dimension))
        marks = []
    else:
        start = event.times[0] - lead
        # the washout is seen, too, and the quiet stretch after the event
        steps = np.arange(start - washout + 1, event.times[3] + quiet + 1)
        time = (steps - start) / lyapunov_time
        shown = states[event.series, steps]
        forecast = np.full_like(shown, np.nan)
        # it starts from what was observed
        forecast[washout - 1] = observed[event.series, start]
        memory = forecaster.start(observed[event.series, steps[:washout], :, np.newaxis])
        outputs_after, _ = forecaster.advance(memory, len(steps) - washout)
        forecast[washout:] = outputs_after[:, :, 0]
        marks = [step - steps[0] for step in event.times]
    write_netcdf(
        outputs.event,
        _variables(system, time, shown, forecast, np.array(marks, dtype=np.int64)),
        {**provenance, "series": -1 if event is None else training + event.series},
    )


def _variables(system, time, true, forecast, marks):
    """Variables of the file; without an event their lengths are 0."""
    name = system.observable_name
    return {
        "time_lt": Variable(
            ("time",), time, "1", "time after the start of the forecast in Lyapunov times"
        ),
        "true": Variable(("time",), system.observable(true.T), "1", f"true {name}"),
        "forecast": Variable(("time",), system.observable(forecast.T), "1", f"forecast {name}"),
        "mark": Variable(("mark",), marks, "1", "entries of time that the states are for"),
        "true_state": Variable(("mark", "component"), true[marks], "1", "true states"),
        "forecast_state": Variable(("mark", "component"), forecast[marks], "1", "forecast states"),
    }


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

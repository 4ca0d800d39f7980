"""Find an event of the test series whose flow is worth seeing, and forecast it."""

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray, IntArray
from burstcast.forecast.example_events import EventCriterion, isolated_events, predicted_event
from burstcast.systems.state_space import StateSpace
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import Variable, read_json, read_rows, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster, seen_rows
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


def find_flow_event(
    *,
    ensemble: str,
    summary: str,
    forecaster: str,
    time_unit: str | list[str],
    event: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the observable through the event and the states at four times, true and forecast."""
    system, unit = system_of(settings), lyapunov_time(settings, time_unit)
    wanted, first = settings["figures.flow_event"], settings["case.training.series"]
    last = first + settings["case.test_series"]
    truth = read_rows(ensemble, "observable", first, last)
    states = read_rows(ensemble, "state", first, last)
    trained = read_rows(ensemble, "state", 0, first)
    who = read_forecaster(forecaster, settings, time_unit)
    observed = seen_rows(who, settings, ensemble, first, states)
    lead = durations.steps(wanted["lead_lt"], unit)
    washout = durations.steps(settings["washout_lt"], unit)
    quiet = durations.steps(wanted["quiet_lt"], unit)
    events = isolated_events(
        truth,
        EventCriterion(
            threshold=settings["case.event_threshold"],
            calm=read_json(summary)["mean_observable"],
            quiet=quiet,
            longest=durations.steps(wanted["longest_lt"], unit),
            wanted_peak=wanted["peak"],
        ),
        before=lead + washout - 1,
    )
    found = predicted_event(
        events,
        who,
        observed,
        states,
        lead=lead,
        washout=washout,
        tolerance=wanted["tolerance"] * float(np.linalg.norm(trained, axis=-1).max()),
    )
    if found is None:
        time = np.empty(0)
        shown = forecast = np.empty((0, system.dimension))
        marks: list[int] = []
    else:
        start = found.times[0] - lead
        # the washout is seen, too, and the quiet stretch after the event
        steps = np.arange(start - washout + 1, found.times[3] + quiet + 1)
        time = (steps - start) / unit
        shown = states[found.series, steps]
        forecast = np.full_like(shown, np.nan)
        # it starts from what was observed
        forecast[washout - 1] = observed[found.series, start]
        memory = who.start(observed[found.series, steps[:washout], :, np.newaxis])
        outputs_after, _ = who.advance(memory, len(steps) - washout)
        forecast[washout:] = outputs_after[:, :, 0]
        marks = [step - steps[0] for step in found.times]
    write_netcdf(
        event,
        _variables(system, time, shown, forecast, np.array(marks, dtype=np.int64)),
        {**provenance, "series": -1 if found is None else first + found.series},
    )


def _variables(
    system: StateSpace,
    time: FloatArray,
    true: FloatArray,
    forecast: FloatArray,
    marks: IntArray,
) -> dict[str, Variable]:
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
    run_job(snakemake, find_flow_event)  # noqa: F821 - Snakemake puts it there

"""Find an event of the test series whose flow is worth seeing, and forecast it."""

import numpy as np

from burstcast import durations
from burstcast.files.netcdf import read_rows, variables_of
from burstcast.forecast.example_events import (
    EventCriterion,
    forecast_event,
    isolated_events,
    predicted_event,
)
from burstcast_workflow.harness.job import Settings, job, read_json, write_netcdf
from burstcast_workflow.jobs.data import kept_series, test_series
from burstcast_workflow.jobs.forecasters import read_forecaster, seen_rows
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time

LEAD_LT, LONGEST_LT = 0.25, 6.0
"""From the start of the forecast to the event's first rise, and from there to its breakdown."""


@job
def find_flow_event(
    *, ensemble: str, summary: str, forecaster: str, event: str, settings: Settings
) -> None:
    """Write the observable through the event and the states at four times, true and forecast."""
    system, unit = system_of(settings), lyapunov_time(settings)
    wanted, first = settings["figures.flow_event"], settings["case.training.series"]
    last = first + test_series(settings, kept_series(ensemble))
    truth = read_rows(ensemble, "observable", first, last)
    states = read_rows(ensemble, "state", first, last)
    trained = read_rows(ensemble, "state", 0, first)
    model = read_forecaster(forecaster, settings)
    observed = seen_rows(model, settings, ensemble, first, states)
    lead = durations.steps(LEAD_LT, unit)
    washout = durations.steps(settings["washout_lt"], unit)
    quiet = durations.steps(wanted["quiet_lt"], unit)
    events = isolated_events(
        truth,
        EventCriterion(
            threshold=settings["case.event_threshold"],
            calm=read_json(summary)["mean_observable"],
            quiet=quiet,
            longest=durations.steps(LONGEST_LT, unit),
            wanted_peak=wanted["peak"],
        ),
        before=lead + washout - 1,
    )
    found = predicted_event(
        events,
        model,
        observed,
        states,
        lead=lead,
        washout=washout,
        tolerance=wanted["tolerance"] * float(np.linalg.norm(trained, axis=-1).max()),
    )
    event_of_flow = forecast_event(
        found,
        model,
        system,
        observed,
        states,
        lead=lead,
        washout=washout,
        after=quiet,  # the washout is seen, too, and the quiet stretch after the event
        steps_per_lyapunov_time=unit,
    )
    series, step = (-1, -1) if found is None else (first + found.series, found.times[0] - lead)
    where = {"series": series, "first_step": step - washout + 1}
    write_netcdf(event, variables_of(event_of_flow), {**settings.provenance, **where})

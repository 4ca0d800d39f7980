"""Select the event of the test series for the figures of the flow, and forecast it."""

import numpy as np

from burstcast.base.files.netcdf import read_rows, variables_of
from burstcast.forecasts.examples import (
    EventCriterion,
    forecast_event,
    isolated_events,
    predicted_event,
)
from burstcast_workflow.harness.job import JobSettings, at, computed, job, read_json, write_netcdf
from burstcast_workflow.jobs.cases import Washout
from burstcast_workflow.jobs.forecasters import Forecasting, seen_rows
from burstcast_workflow.jobs.series import Observed, Tested, kept_series

LEAD_LT, LONGEST_LT = 0.25, 6.0
"""From the start of the forecast to the event's first rise, and from there to its breakdown."""


class FlowEvent(JobSettings):
    """Settings of the selection of an event for the figures of the flow."""

    forecasting: Forecasting
    washout: Washout
    observed: Observed
    tested: Tested
    event_threshold: float = computed("event_threshold.event_threshold")
    quiet_lt: float = at("figures.flow_event.quiet_lt")
    peak: float = at("figures.flow_event.peak")
    tolerance: float = at("figures.flow_event.tolerance")


@job
def find_flow_event(
    *, ensemble: str, summary: str, forecaster: str, event: str, settings: FlowEvent
) -> None:
    """Write the observable through the event and the states at four times, true and forecast."""
    clock, washout = settings.washout.clock, settings.washout.steps
    first = settings.tested.training.series
    last = first + settings.tested.series(kept_series(ensemble))
    truth = read_rows(ensemble, "observable", first, last)
    states = read_rows(ensemble, "state", first, last)
    trained = read_rows(ensemble, "state", 0, first)
    model = settings.forecasting.read_forecaster(forecaster)
    observed = seen_rows(model, settings.observed, ensemble, first, states)
    lead, quiet = clock.steps(LEAD_LT), clock.steps(settings.quiet_lt)
    events = isolated_events(
        truth,
        EventCriterion(
            threshold=settings.event_threshold,
            calm=read_json(summary)["mean_observable"],
            quiet=quiet,
            longest=clock.steps(LONGEST_LT),
            wanted_peak=settings.peak,
        ),
        before=lead + washout - 1,
    )
    chosen = predicted_event(
        events,
        model,
        observed,
        states,
        lead=lead,
        washout=washout,
        tolerance=settings.tolerance * float(np.linalg.norm(trained, axis=-1).max()),
    )
    event_of_flow = forecast_event(
        chosen,
        model,
        settings.forecasting.system.space,
        observed,
        states,
        lead=lead,
        washout=washout,
        after=quiet,  # the washout is seen, too, and the quiet stretch after the event
        steps_per_lyapunov_time=clock.lyapunov_time,
    )
    series, step = (-1, -1) if chosen is None else (first + chosen.series, chosen.times[0] - lead)
    where = {"series": series, "first_step": step - washout + 1}
    write_netcdf(event, variables_of(event_of_flow), {**settings.provenance, **where})

"""Find the extreme events of the series that were not used for training."""

from burstcast.base.files.netcdf import read_netcdf, read_rows
from burstcast.base.series_lengths import numbers_of
from burstcast.data.starting_points import crossing_points, horizon_events, steps_before_events
from burstcast.forecasts.forecast_files import event_summary, event_variables
from burstcast.statistics.warning_signs import few_events
from burstcast_workflow.harness.job import (
    JobSettings,
    at,
    computed,
    concerning,
    job,
    tell,
    write_json,
    write_netcdf,
)
from burstcast_workflow.jobs.cases import Washout
from burstcast_workflow.jobs.series import Observed, known_rows


class Events(JobSettings):
    """Events that horizons are measured for."""

    observed: Observed
    washout: Washout
    event_threshold: float = computed("event_threshold.event_threshold")
    most_events: int = at("horizon.events")
    longest_lead_time_lt: float = at("horizon.longest_lead_time_lt")


@job
def events_of_case(*, ensemble: str, events: str, events_summary: str, settings: Events) -> None:
    """Write the events, with what was observed and what was true before each of them."""
    training, threshold = settings.observed.training, settings.event_threshold
    first, washout = training.series, settings.washout
    observable = read_netcdf(ensemble, "observable")["observable"]
    training.check_series(len(observable))
    longest_lt, field = settings.longest_lead_time_lt, Events.longest_lead_time_lt
    with concerning(field, Washout.lt):
        longest = washout.clock.positive_steps(longest_lt, field)
        before = steps_before_events(observable.shape[1], longest, washout.steps)
    samples = numbers_of(observable)
    if not threshold > samples.mean():
        raise ValueError(
            f"event_threshold is {threshold}, but it must exceed the mean of the "
            f"observable over all data, {samples.mean():.4g}"
        )
    for finding in few_events(1, 1, threshold, float(samples.max())):
        tell(finding)
    crossings = crossing_points(observable, threshold)
    points = horizon_events(crossings, first, before, settings.most_events)
    last = int(points.series.max()) + 1 if len(points) else first
    states = read_rows(ensemble, "state", first, last)
    observed = settings.observed.rows(ensemble, first, states)
    schedules = known_rows(ensemble, first, last)
    variables = event_variables(points, first, observed, states, observable, before, schedules)
    write_netcdf(events, variables, settings.provenance)
    summary = event_summary(observable, threshold, first, len(crossings), len(points))
    write_json(events_summary, summary, settings.provenance)

"""Find the extreme events of the series that were not used for training."""

from burstcast.base.files.netcdf import read_netcdf, read_rows
from burstcast.base.series_lengths import numbers_of
from burstcast.data.starting_points import crossing_points, horizon_events, steps_before_events
from burstcast.forecasts.forecast_files import event_summary, event_variables
from burstcast.statistics.warning_signs import few_events
from burstcast_workflow.harness.job import at, concerning, job, tell, write_json, write_netcdf
from burstcast_workflow.jobs.cases import Washed
from burstcast_workflow.jobs.series import Observed, known_rows


class Events(Observed, Washed):
    """Extreme events."""

    event_threshold: float = at("case.event_threshold")
    most_events: int = at("horizon.events")
    longest_lead_time_lt: float = at("horizon.longest_lead_time_lt")


@job
def events_of_case(*, ensemble: str, events: str, events_summary: str, settings: Events) -> None:
    """Write the events, with what was observed and what was true before each of them."""
    first, threshold = settings.training_series, settings.event_threshold
    observable = read_netcdf(ensemble, "observable")["observable"]
    settings.check_series(len(observable))
    with concerning(Events.longest_lead_time_lt, Events.washout_lt):
        longest = settings.positive_steps(Events.longest_lead_time_lt)
        before = steps_before_events(observable.shape[1], longest, settings.washout)
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
    observed = settings.observed_rows(ensemble, first, states)
    schedules = known_rows(ensemble, first, last)
    variables = event_variables(points, first, observed, states, observable, before, schedules)
    write_netcdf(events, variables, settings.provenance)
    summary = event_summary(observable, threshold, first, len(crossings), len(points))
    write_json(events_summary, summary, settings.provenance)

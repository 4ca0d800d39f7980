"""Find the extreme events of the series that were not used for training."""

from burstcast import durations
from burstcast.data.starting_points import crossing_points, horizon_events, steps_before_events
from burstcast.files.netcdf import read_netcdf, read_rows
from burstcast.forecast.forecast_files import event_summary, event_variables
from burstcast.statistics.warning_signs import few_events
from burstcast_workflow.harness.job import Settings, concerning, job, tell, write_json, write_netcdf
from burstcast_workflow.harness.settings import HORIZON
from burstcast_workflow.jobs.data import check_kept_series, known_rows, observed_rows
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def events_of_case(*, ensemble: str, events: str, events_summary: str, settings: Settings) -> None:
    """Write the events, with what was observed and what was true before each of them."""
    steps = lyapunov_time(settings)
    first, threshold = settings["case.training.series"], settings["case.event_threshold"]
    observable = read_netcdf(ensemble, "observable")["observable"]
    check_kept_series(len(observable), {"training.series": first})
    longest_lt = settings["horizon.longest_lead_time_lt"]
    with concerning(HORIZON):
        before = steps_before_events(
            observable.shape[1],
            durations.positive_steps(longest_lt, steps, "horizon.longest_lead_time_lt"),
            durations.positive_steps(settings["washout_lt"], steps, "washout_lt"),
        )
    if not threshold > observable.mean():
        raise ValueError(
            f"event_threshold is {threshold}, but it must exceed the mean of the "
            f"observable over all data, {observable.mean():.4g}"
        )
    for finding in few_events(1, 1, threshold, float(observable.max())):
        tell(finding.text)
    crossings = crossing_points(observable, threshold)
    points = horizon_events(crossings, first, before, settings["horizon.events"])
    last = int(points.series.max()) + 1 if len(points) else first
    states = read_rows(ensemble, "state", first, last)
    observed = observed_rows(settings, ensemble, first, states)
    known = known_rows(ensemble, first, last)
    variables = event_variables(points, first, observed, states, observable, before, known)
    write_netcdf(events, variables, settings.provenance)
    summary = event_summary(observable, threshold, first, len(crossings), len(points))
    write_json(events_summary, summary, settings.provenance)

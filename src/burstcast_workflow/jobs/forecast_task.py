"""The forecasting task of a job's case: what forecasts of other programs start from."""

from burstcast.benchmark.task import TaskData, campaign_task
from burstcast.data.starting_points import SeriesPoints
from burstcast.files.netcdf import read_netcdf
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.data import kept_series, known_rows, observed_rows, training_states
from burstcast_workflow.jobs.forecasts import boundaries_of, horizon_search
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import sampling_interval


def task_data(
    settings: Settings, ensemble: str, evaluation_set: str, events: str, summary: str
) -> TaskData:
    """Observed data of the case; the settings are ``TASK`` of the rules, and ``noise``."""
    known = known_rows(ensemble, 0, kept_series(ensemble))
    in_force = {} if known is None else read_netcdf(evaluation_set, "parameter")
    found = read_netcdf(evaluation_set, "series", "step", "washout")
    before = read_netcdf(events, "series", "step", "observed")
    return campaign_task(
        case=settings["case"],
        seed=settings["random_seed"],
        space=system_of(settings),
        boundaries=boundaries_of(settings),
        prediction_times_lt=settings["classification.prediction_times_lt"],
        window_lt=settings["classification.window_lt"],
        resolution_lt=settings["classification.resolution_lt"],
        training=observed_rows(settings, ensemble, 0, training_states(settings, ensemble)),
        points=SeriesPoints(found["series"], found["step"]),
        washouts=found["washout"],
        events=SeriesPoints(before["series"], before["step"]),
        before_events=before["observed"],
        search=horizon_search(settings, summary),
        known=known,
        known_of_points=in_force.get("parameter"),
        noise=settings["noise"],
        event_threshold=settings["case.event_threshold"],
        sampling_interval=sampling_interval(settings),
        tolerance=settings["horizon.tolerance"],
    )

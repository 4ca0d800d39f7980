"""The forecasting task of a job's case: what forecasts of other programs start from."""

from burstcast.benchmark.task import TaskData
from burstcast.data.starting_points import SeriesPoints
from burstcast.files.netcdf import read_netcdf
from burstcast_workflow.harness.settings import at
from burstcast_workflow.jobs.data import Observed, kept_series, known_rows
from burstcast_workflow.jobs.forecasts import Horizons, Windows
from burstcast_workflow.jobs.systems import System


class Task(System, Observed, Windows, Horizons):
    """What forecasts of other programs are compared with."""

    prediction_times_lt: list[float] = at("classification.prediction_times_lt")
    noise_of_case: float = at("noise")

    def data(self, ensemble: str, evaluation_set: str, events: str, summary: str) -> TaskData:
        """Observed data of the case."""
        known = known_rows(ensemble, 0, kept_series(ensemble))
        in_force = {} if known is None else read_netcdf(evaluation_set, "parameter")
        found = read_netcdf(evaluation_set, "series", "step", "washout")
        before = read_netcdf(events, "series", "step", "observed")
        return TaskData(
            case=self.case,
            seed=self.random_seed,
            space=self.space,
            boundaries=self.boundaries,
            prediction_times_lt=self.prediction_times_lt,
            window_lt=self.window_lt,
            resolution_lt=self.resolution_lt,
            training=self.observed_rows(ensemble, 0, self.training_states(ensemble)),
            points=SeriesPoints(found["series"], found["step"]),
            washouts=found["washout"],
            events=SeriesPoints(before["series"], before["step"]),
            before_events=before["observed"],
            search=self.horizon_search(summary),
            known=known,
            known_of_points=in_force.get("parameter"),
            noise=self.noise_of_case,
            event_threshold=self.event_threshold,
            sampling_interval=self.sampling_interval,
            tolerance=self.tolerance,
        )

"""Lay out the starting points of the evaluation set in test series whose actuator switches."""

from burstcast_workflow.harness.job import Settings, job
from burstcast_workflow.jobs.forecasts import test_rows, write_points
from burstcast_workflow.jobs.switched import switched_series
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def switched_evaluation_set_of_case(
    *, ensemble: str, evaluation_set: str, settings: Settings
) -> None:
    """Write points in series that go on from the ends of the test series, with their schedules."""
    rows, steps = test_rows(settings, ensemble), lyapunov_time(settings)
    series, observed = switched_series(settings, ensemble, rows, steps, "test")
    observable = system_of(settings).observable(series.states.transpose(2, 0, 1))
    write_points(
        evaluation_set,
        settings,
        (series.states, observed, observable),
        ("classification.start_spacing_lt", settings["classification.start_spacing_lt"]),
        series.schedules,
    )

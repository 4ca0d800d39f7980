"""Training series for forecasters that know the parameters: the case's own, or actuated ones."""

import numpy as np

from burstcast import durations, random_streams
from burstcast.arrays import FloatArray
from burstcast.control.actuation import ActuationValues, actuated_system
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.scheduled_series import RandomActuation, ScheduledSeries, simulated_series
from burstcast.systems.parameters import SHARE, SystemParameters
from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.data import observed_rows, training_states
from burstcast_workflow.jobs.scheduled import write_scheduled
from burstcast_workflow.jobs.systems import equations_of, parameters_of
from burstcast_workflow.jobs.time_unit import lyapunov_time

CANDIDATES = 8
"""Actuated series that are drawn for each one that is wanted, for some may laminarise."""


def _actuated(
    settings: Settings, free: FloatArray, names: list[str], steps_per_lyapunov_time: int
) -> ScheduledSeries:
    """Series that go on from the ends of the free ones, under an actuator that switches."""
    given, actuation = settings["case.training.actuation"], settings["case.actuation"]
    system, wanted = equations_of(settings), len(free)
    parameters = parameters_of(settings, names)
    on: tuple[float, ...] = (given["strength"],)
    if names != [SHARE]:
        actuated = actuated_system(
            system, actuation["parameters"], actuation["force"], given["strength"]
        )
        on = SystemParameters.of(actuated, names).own
    values = ActuationValues(parameters.own, on)
    interval = durations.positive_steps(
        given["interval_lt"], steps_per_lyapunov_time, "training.actuation.interval_lt"
    )
    switching = RandomActuation(
        interval,
        given["mean_on_lt"] / given["interval_lt"],
        given["mean_off_lt"] / given["interval_lt"],
    )
    stream = random_streams.stream(settings["random_seed"], "training actuation", settings["case"])
    acting = switching.draw(CANDIDATES * wanted, free.shape[1] - 1, stream)
    found, _ = simulated_series(
        parameters,
        system,
        np.ascontiguousarray(np.tile(free[:, -1].T, CANDIDATES)),
        values.schedule(acting.T).transpose(2, 0, 1),
        wanted,
        time_step=settings["case.ensemble.time_step"],
        sampling_stride=settings["case.ensemble.sampling_stride"],
        laminarisation_threshold=settings["case.laminarisation_threshold"],
    )
    return found


@job
def schedule_series(
    *,
    ensemble: str,
    time_unit: str | list[str],
    scheduled_series: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the series, what is observed of them, and the parameters in force."""
    free, names = training_states(settings, ensemble), settings["parameters"]
    if settings["case.training.actuation"] is None:
        constant = ScheduledSeries.constant(free, parameters_of(settings, names).own)
        observed = observed_rows(settings, ensemble, 0, free)
        write_scheduled(scheduled_series, constant, observed, False, provenance)
        return
    series = _actuated(settings, free, names, lyapunov_time(settings, time_unit))
    observed = observed_series(
        series.states,
        0,
        settings["case.training.noise"],
        component_scales(free),
        settings["random_seed"],
        f"{settings['case']} actuated",
    )
    write_scheduled(scheduled_series, series, observed, True, provenance)

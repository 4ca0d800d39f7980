"""Simulate the flow whose suppressed event shows best what control by a forecaster does."""

from burstcast.base.files.netcdf import variables_of
from burstcast.control.example import simulate_event
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.windows import largest_suppressed_event
from burstcast_workflow.harness.job import job, write_netcdf
from burstcast_workflow.jobs.control import Controlled


@job
def suppressed_event(
    *, ensemble: str, summary: str, forecasters: list[str], event: str, settings: Controlled
) -> None:
    """Write the observable with and without control, and the states at four times."""
    strategy, experiment, asked, noise = settings.setup(ensemble, summary, forecasters)
    assert isinstance(strategy, PredictionTriggered)
    policy = strategy.policy(experiment, asked[0])
    simulation = strategy.simulate(experiment, policy, noise=noise)
    chosen = largest_suppressed_event(simulation, settings.laminarisation_threshold)
    simulated = simulate_event(chosen, strategy, experiment, asked[0], noise)
    which = {
        "series": -1 if chosen is None else experiment.series[chosen.row],
        "alarm_step": -1 if chosen is None else chosen.alarm_step,
    }
    write_netcdf(event, variables_of(simulated), {**settings.provenance, **which})

"""Follow the flow whose suppressed event shows best what control by a forecaster does."""

from burstcast.control.example import follow_event
from burstcast.control.outcome import largest_suppressed_event
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.netcdf import variables_of
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.control import control_experiment, control_noise, control_strategy
from burstcast_workflow.jobs.forecasters import read_forecaster


def suppressed_event(
    *,
    ensemble: str,
    summary: str,
    time_unit: str | list[str],
    forecaster: str,
    event: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the observable with and without control, and the states at four times."""
    experiment = control_experiment(settings, ensemble, summary, time_unit)
    strategy, who = control_strategy(settings), read_forecaster(forecaster, settings, time_unit)
    assert isinstance(strategy, PredictionTriggered)
    noise = None
    if not who.sees_truth:
        noise = control_noise(settings, ensemble, experiment, strategy.timing(experiment.schedule))
    followed = strategy.follow(experiment, strategy.monitor(experiment, [who]), noise=noise)
    chosen = largest_suppressed_event(followed, settings["case.laminarisation_threshold"])
    found = follow_event(chosen, strategy, experiment, who, noise)
    which = {
        "series": -1 if chosen is None else experiment.series[chosen.row],
        "alarm_step": -1 if chosen is None else chosen.alarm_step,
    }
    write_netcdf(event, variables_of(found), {**provenance, **which})


if __name__ == "__main__":
    run_job(snakemake, suppressed_event)  # noqa: F821 - Snakemake puts it there

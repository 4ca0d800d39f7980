"""Control the flow of a case: by a forecaster, several, or none, or by alarms at random."""

from burstcast.control.controllers.registry import controlling_monitor
from burstcast.forecasters._names import parsed
from burstcast_workflow.harness.job import Settings, job, read_json
from burstcast_workflow.jobs.control import control_setup, write_control


@job
def control(
    *,
    ensemble: str,
    summary: str,
    forecasters: list[str],
    matched: str | list[str],
    counts: str,
    histograms: str,
    flows: str,
    settings: Settings,
) -> None:
    """Write what control achieved; random alarms are as frequent as those counted in `matched`."""
    strategy, experiment, asked, noise = control_setup(settings, ensemble, summary, forecasters)
    controller = parsed(settings["controller"])
    monitor = controlling_monitor(
        controller.role or "forecaster",
        strategy,
        experiment,
        asked,
        alarm_rate=read_json(matched)["alarm_rate"] or 0.0 if isinstance(matched, str) else 0.0,
        seed=controller.seed or 0,
    )
    simulation = strategy.simulate(experiment, monitor, noise=noise)
    files = counts, histograms, flows
    write_control(files, strategy, experiment, simulation, settings)

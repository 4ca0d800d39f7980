"""Control the flow of a case: by a forecaster, several, or none, or by alarms at random."""

import dataclasses

from burstcast.control.controllers.registry import controlling_monitor
from burstcast.control.flow_files import flow_variables, histogram_variables
from burstcast.control.records import Span, record_flows
from burstcast.forecasters._names import parsed
from burstcast.statistics.densities import bin_edges
from burstcast_workflow.harness.job import Settings, job, read_json, write_json, write_netcdf
from burstcast_workflow.jobs.control import control_setup


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
    laminarisation_threshold = settings["case.laminarisation_threshold"]
    density = settings["case.controlled_density"]
    low, high = density["range"]
    edges = bin_edges(low, high, density["bins"])
    outcome = strategy.outcome(simulation, laminarisation_threshold, edges)
    write_json(counts, outcome.record(), settings.provenance)
    write_netcdf(histograms, histogram_variables(outcome), settings.provenance)
    records, span = record_flows(simulation, laminarisation_threshold), Span.of(simulation.timing)
    cost = simulation.cost if settings.get("control.cost") else None
    variables = flow_variables(records, experiment.series.start, cost)
    write_netcdf(flows, variables, {**settings.provenance, **dataclasses.asdict(span)})

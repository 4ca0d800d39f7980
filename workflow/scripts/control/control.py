"""Control the flow of a case: by a forecaster, several, or none, or by alarms at random."""

import dataclasses
from typing import Any

from burstcast.base.files.netcdf import Variable, variables_of
from burstcast.base.files.units import NUMBER
from burstcast.base.names import parsed
from burstcast.control.controllers import controlling_policy
from burstcast.control.records import Span, record_flows
from burstcast.control.windows import observable_histograms
from burstcast.statistics.densities import bin_edges
from burstcast_workflow.harness.job import JobSettings, at, job, write_netcdf
from burstcast_workflow.jobs.control import Controlled, alarm_rate, sensor_of


class Control(JobSettings):
    """Control by any controller, for tables and figures."""

    run: Controlled
    aware: dict[str, Any] | None = at("forecasters.aware", otherwise=None)
    sensor: dict[str, Any] | None = at("control.sensor", otherwise=None)
    costs: bool = at("control.cost", otherwise=False)
    density: dict[str, Any] | None = at("case.controlled_density", otherwise=None)


@job
def control(
    *,
    ensemble: str,
    summary: str,
    forecasters: list[str],
    encoder: str | list[str],
    matched: str | list[str],
    flows: str,
    settings: Control,
) -> None:
    """Write records of each flow; random alarms are as frequent as those of `matched` flows."""
    run = settings.run
    sensor = sensor_of(settings.sensor, run.forecasting.system.equations, encoder)
    strategy, experiment, asked, noise = run.setup(
        ensemble, summary, forecasters, sensor, settings.aware
    )
    controller = parsed(settings.controller)
    policy = controlling_policy(
        controller.role or "forecaster",
        strategy,
        experiment,
        asked,
        alarm_rate=alarm_rate(matched) if isinstance(matched, str) else 0.0,
        seed=controller.seed or 0,
    )
    simulation = strategy.simulate(experiment, policy, noise=noise, costs=settings.costs)
    records = record_flows(simulation, run.laminarisation_threshold)
    parts = [records, strategy.categories(simulation), simulation.cost]
    if settings.density:
        low, high = settings.density["range"]
        edges = bin_edges(low, high, settings.density["bins"])
        parts.append(observable_histograms(simulation, edges))
    series = experiment.series.start + records.row
    variables = {"series": Variable(("flow",), series, NUMBER, "row of the series in the ensemble")}
    for part in filter(None, parts):
        variables |= variables_of(part)
    span = dataclasses.asdict(Span.of(simulation.timing))
    attributes = {**settings.provenance, **span, "left_out": simulation.left_out, **run.attributes}
    write_netcdf(flows, variables, attributes)

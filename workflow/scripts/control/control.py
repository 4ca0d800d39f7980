"""Control the flow of a case: by a forecaster, several, or none, or by alarms at random."""

import dataclasses

from burstcast.control.controllers import controlling_policy
from burstcast.control.records import Span, record_flows
from burstcast.control.windows import observable_histograms
from burstcast.files.netcdf import Variable, variables_of
from burstcast.files.units import NUMBER
from burstcast.forecasters._names import parsed
from burstcast.statistics.densities import bin_edges
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.control import alarm_rate, control_setup


@job
def control(
    *,
    ensemble: str,
    summary: str,
    forecasters: list[str],
    encoder: str | list[str],
    matched: str | list[str],
    flows: str,
    settings: Settings,
) -> None:
    """Write records of each flow; random alarms are as frequent as those of `matched` flows."""
    strategy, experiment, asked, noise = control_setup(
        settings, ensemble, summary, forecasters, encoder
    )
    controller = parsed(settings["controller"])
    policy = controlling_policy(
        controller.role or "forecaster",
        strategy,
        experiment,
        asked,
        alarm_rate=alarm_rate(matched) if isinstance(matched, str) else 0.0,
        seed=controller.seed or 0,
    )
    costs = bool(settings.get("control.cost"))
    simulation = strategy.simulate(experiment, policy, noise=noise, costs=costs)
    records = record_flows(simulation, settings["case.laminarisation_threshold"])
    found = [records, strategy.categories(simulation), simulation.cost]
    if density := settings.get("case.controlled_density"):
        low, high = density["range"]
        edges = bin_edges(low, high, density["bins"])
        found.append(observable_histograms(simulation, edges))
    series = experiment.series.start + records.row
    variables = {"series": Variable(("flow",), series, NUMBER, "row of the series in the ensemble")}
    for one in filter(None, found):
        variables |= variables_of(one)
    span = dataclasses.asdict(Span.of(simulation.timing))
    attributes = {**settings.provenance, **span, "left_out": simulation.left_out}
    write_netcdf(flows, variables, attributes)

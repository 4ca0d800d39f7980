"""Make the paper's table of the hyperparameters of the networks."""

from typing import Any

from burstcast.base.natural_order import natural_order
from burstcast_workflow.harness.job import JobSettings, at, job, write_table, write_text
from burstcast_workflow.jobs.forecasters import CaseInputs


class Hyperparameters(JobSettings):
    """Hyperparameters of all networks, and what differs between cases."""

    connectivity: float = at("forecasters.esn.connectivity")
    spectral_radius: list[float] = at("search.spectral_radius")
    input_scaling: list[float] = at("search.input_scaling")
    tikhonov: list[float] = at("search.tikhonov")
    cases: dict[str, dict[str, Any]] = at("cases")
    caption: str = at("caption")


@job
def network_hyperparameters(*, table: str, latex: str, settings: Hyperparameters) -> None:
    """Write one column of values, or one for each case where the noise or the bias differs."""
    # loaded here, with pandas: jobs from the cache start without it
    from burstcast.tables.latex import to_latex
    from burstcast.tables.parameters import network_parameters, side_by_side

    cases = settings.cases
    tables: dict[str, Any] = {}
    different = set()
    for name in sorted(cases, key=natural_order):
        case = CaseInputs(cases[name], {})
        different.add((case.noise, case.input_bias))
        tables[name] = network_parameters(
            spectral_radius=settings.spectral_radius,
            input_scaling=settings.input_scaling,
            tikhonov=settings.tikhonov,
            connectivity=settings.connectivity,
            input_bias=case.input_bias,
            noise=case.noise,
        )
    if len(different) == 1:
        tables = {name: tables[name] for name in list(tables)[:1]}
    columns = side_by_side(tables)
    write_table(table, columns)
    write_text(latex, to_latex(columns, settings.caption, f"tab:{settings.rule}", keys=2))

"""Make the paper's table of the parameters of the data, for all cases."""

from typing import Any

from burstcast.systems.registry import parameters_of
from burstcast_workflow.harness.job import JobSettings, at, job, read_json, write_table, write_text
from burstcast_workflow.jobs.cases import CaseData
from burstcast_workflow.jobs.origins import origins


class DataParameters(JobSettings):
    """Settings of all cases, and the caption."""

    cases: dict[str, dict[str, Any]] = at("cases")
    caption: str = at("caption")


@job
def data_generation_parameters(
    *,
    summaries: list[str],
    event_thresholds: list[str],
    table: str,
    latex: str,
    settings: DataParameters,
) -> None:
    """Write one column of values for each case."""
    # loaded here, with pandas: jobs from the cache start without it
    from burstcast.tables.latex import to_latex
    from burstcast.tables.parameters import data_parameters, described_parameters, side_by_side

    thresholds = {
        origin.identity["case"]: read_json(origin.path)["event_threshold"]
        for origin in origins(event_thresholds)
    }
    tables = {}
    for origin in origins(summaries):
        name = origin.identity["case"]
        case = CaseData(settings.cases[name], origin.identity)
        system = case.system.equations
        tables[name] = data_parameters(
            system=described_parameters(case.system.name, parameters_of(system)),
            symbol=system.observable_symbol,
            time_step=case.time_step,
            series_duration=case.duration,
            training_series=case.training_series,
            laminarisation_threshold=case.laminarisation_threshold,
            event_threshold=thresholds[name],
            series_kept=read_json(origin.path)["series_kept"],
        )
    columns = side_by_side(tables).fillna("")  # where only other cases have a parameter
    write_table(table, columns)
    write_text(latex, to_latex(columns, settings.caption, f"tab:{settings.rule}", keys=2))

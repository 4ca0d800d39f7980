"""Make the paper's table of the parameters of the data, for all cases."""

from burstcast.systems.registry import parameters_of
from burstcast.tables.latex import to_latex
from burstcast.tables.parameters import data_parameters, described_parameters, side_by_side
from burstcast_workflow.harness.job import Settings, job, read_json, write_table, write_text
from burstcast_workflow.jobs.gather import origins
from burstcast_workflow.jobs.systems import equations_of


@job
def data_generation_parameters(
    *, summaries: list[str], table: str, latex: str, settings: Settings
) -> None:
    """Write one column of values for each case."""
    tables = {}
    for origin in origins(summaries):
        case = Settings(settings["cases"][origin.identity["case"]], origin.identity)
        system = equations_of(case)
        tables[origin.identity["case"]] = data_parameters(
            system=described_parameters(case["case.system"], parameters_of(system)),
            symbol=system.observable_symbol,
            time_step=case["case.ensemble.time_step"],
            series_duration=case["case.ensemble.duration"],
            training_series=case["case.training.series"],
            laminarisation_threshold=case["case.laminarisation_threshold"],
            event_threshold=case["case.event_threshold"],
            series_kept=read_json(origin.path)["series_kept"],
        )
    found = side_by_side(tables).fillna("")  # where only other cases have a parameter
    write_table(table, found)
    label = "tab:data_generation_parameters"
    write_text(latex, to_latex(found, settings["caption"], label, keys=2))

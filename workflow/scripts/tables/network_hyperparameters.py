"""Make the paper's table of the hyperparameters of the networks."""

from burstcast.natural_order import natural_order
from burstcast.tables.latex import to_latex
from burstcast.tables.parameters import network_parameters, side_by_side
from burstcast_workflow.harness.job import Settings, job, write_table, write_text


@job
def network_hyperparameters(*, table: str, latex: str, settings: Settings) -> None:
    """Write one column of values, or one for each case where the noise differs."""
    cases = settings["cases"]
    noise = {case: cases[case]["case.training.noise"] for case in sorted(cases, key=natural_order)}
    if len(set(noise.values())) == 1:
        noise = dict([next(iter(noise.items()))])
    tables = {
        case: network_parameters(
            spectral_radius=settings["search.spectral_radius"],
            input_scaling=settings["search.input_scaling"],
            tikhonov=settings["search.tikhonov"],
            connectivity=settings["forecasters.esn.connectivity"],
            input_bias=settings["forecasters.esn.input_bias"],
            noise=value,
        )
        for case, value in noise.items()
    }
    found = side_by_side(tables)
    write_table(table, found)
    label = "tab:network_hyperparameters"
    write_text(latex, to_latex(found, settings["caption"], label, keys=2))

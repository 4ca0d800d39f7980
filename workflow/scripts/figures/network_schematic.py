"""The echo state network with the sizes and hyperparameters of the example network; open loop and
closed loop.
"""

from matplotlib.figure import Figure

from burstcast.figures.network_schematic import network_schematic
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.systems import system_of


def draw(*, hyperparameters: str, settings: Settings) -> Figure:
    """Draw the example network."""
    chosen = read_json(hyperparameters)
    return network_schematic(
        inputs=system_of(settings).dimension,
        neurons=settings["shown_neurons"],
        connectivity=settings["forecasters.esn.connectivity"],
        input_bias=settings["forecasters.esn.input_bias"],
        spectral_radius=chosen["spectral_radius"],
        input_scaling=chosen["input_scaling"],
        tikhonov=chosen["tikhonov"],
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there

"""The echo state network with the sizes and hyperparameters of the example network; open loop and
closed loop.
"""

from matplotlib.figure import Figure

from burstcast.figures.network_schematic import network_schematic
from burstcast_workflow.harness.figures import Record, Settings, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, hyperparameters: Record, settings: Settings) -> Figure:
    """Draw the example network."""
    return network_schematic(
        inputs=system_of(settings).dimension,
        neurons=settings["shown_neurons"],
        connectivity=settings["forecasters.esn.connectivity"],
        input_bias=settings["forecasters.esn.input_bias"],
        spectral_radius=hyperparameters["spectral_radius"],
        input_scaling=hyperparameters["input_scaling"],
        tikhonov=hyperparameters["tikhonov"],
    )

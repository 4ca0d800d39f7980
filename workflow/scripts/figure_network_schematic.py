"""Draw the echo state network with its real sizes and hyperparameters."""

from typing import Any

from burstcast.figures.network_schematic import network_schematic
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_json


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the example network."""
    chosen = read_json(inputs.hyperparameters)
    figure = network_schematic(
        **settings,
        spectral_radius=chosen["spectral_radius"],
        input_scaling=chosen["input_scaling"],
    )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

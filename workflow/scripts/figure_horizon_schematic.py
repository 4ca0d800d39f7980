"""Draw the procedure that yields the prediction horizon of an extreme event."""

from typing import Any

from burstcast.figures.horizon_schematic import horizon_schematic
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw it with the values of the configuration."""
    figure = horizon_schematic(
        longest_lead_time_lt=settings["longest_start_lt"],
        lead_time_step_lt=settings["start_step_lt"],
        tolerance=settings["tolerance"],
        symbol=settings["symbol"],
    )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

"""Figures of the workflow: what the scripts that draw run in."""

from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure

from burstcast.figures.parts.style import render
from burstcast_workflow.harness.job import arguments_for, run_job
from burstcast_workflow.harness.storage import atomic


def run_figure(snakemake: Any, draw: Callable[..., Figure]) -> None:
    """Run a script's function, and write the figure that it returns as PDF and PNG.

    Parameters
    ----------
    snakemake
        The object that Snakemake puts into the script.
    draw
        Takes inputs of the rule by their names, and ``settings``.
    """

    def write(*, pdf: str, png: str, **arguments: Any) -> None:
        figure = draw(**arguments_for(draw, arguments))
        # always the same bytes
        for path, content in ((pdf, render(figure, "pdf")), (png, render(figure, "png"))):
            with atomic(path) as partial:
                partial.write_bytes(content)

    run_job(snakemake, write)

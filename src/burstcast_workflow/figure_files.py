"""Figures of the workflow as files: each as PDF and as PNG."""

from typing import Any

from matplotlib.figure import Figure

from burstcast.figures.style import render
from burstcast_workflow.storage import atomic


def write_figure(outputs: Any, figure: Figure) -> None:
    """Write a figure to ``outputs.pdf`` and ``outputs.png``: always the same bytes."""
    for path, content in (
        (outputs.pdf, render(figure, "pdf")),
        (outputs.png, render(figure, "png")),
    ):
        with atomic(path) as partial:
            partial.write_bytes(content)

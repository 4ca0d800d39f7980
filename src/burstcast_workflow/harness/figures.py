"""Figures of the workflow: what the scripts that draw run in.

The script of a figure is its caption and one function::

    @figure
    def draw(*, scores: Table, settings: Settings) -> Figure: ...

Its arguments are the inputs of the figure by their names, and ``settings``. An input is read as its
type says, `Table` or another ``Annotated[type, reader]``; of one that is text it is given the path.
"""

from collections.abc import Callable, Mapping
from typing import Annotated, Any, get_args, get_type_hints

import numpy.typing as npt
import pandas as pd
from matplotlib.figure import Figure

from burstcast.figures.parts.style import render
from burstcast.netcdf import read_netcdf
from burstcast_workflow.harness.job import arguments_for, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import atomic, read_json
from burstcast_workflow.harness.tables import read_table

__all__ = ["Arrays", "Record", "Settings", "Table", "figure", "run_figure"]

Table = Annotated[pd.DataFrame, read_table]
Arrays = Annotated[dict[str, npt.NDArray[Any]], read_netcdf]
Record = Annotated[dict[str, Any], read_json]


def figure(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """Draw a figure where Snakemake runs its script; imported, the function stays what it is."""
    if snakemake := draw.__globals__.get("snakemake"):
        run_figure(snakemake, draw)
    return draw


def run_figure(snakemake: Any, draw: Callable[..., Figure]) -> None:
    """Run a script's function, and write the figure that it returns as PDF and PNG.

    Parameters
    ----------
    snakemake
        The object that Snakemake puts into the script.
    draw
        The function.
    """

    def write(*, pdf: str, png: str, **arguments: Any) -> None:
        drawn = draw(**_read(draw, arguments_for(draw, arguments)))
        # always the same bytes
        for path, content in ((pdf, render(drawn, "pdf")), (png, render(drawn, "png"))):
            with atomic(path) as partial:
                partial.write_bytes(content)

    run_job(snakemake, write)


def _read(draw: Callable[..., Figure], arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Inputs as the types of a function's arguments say."""
    read = dict(arguments)
    for name, hint in get_type_hints(draw, include_extras=True).items():
        for kind in (hint, *get_args(hint)):  # of one that may be left out as well
            if name in read and hasattr(kind, "__metadata__"):
                read[name] = kind.__metadata__[0](read[name])
    return read

"""Typical evolution of the observable (the first kept series that has extreme events; they are
shaded) and its probability density over all kept data. The line is the event threshold.
"""

import numpy as np
from matplotlib.figure import Figure

from burstcast.figures.observable_and_density import observable_and_density
from burstcast.netcdf import read_netcdf
from burstcast.statistics.densities import histogram
from burstcast_workflow.harness.figures import Settings, figure
from burstcast_workflow.jobs.bins import edges_of
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


@figure
def draw(*, ensemble: str, time_unit: str | list[str], settings: Settings) -> Figure:
    """Draw the first kept series that has an event and the histogram of all of them."""
    system = system_of(settings)
    observable = read_netcdf(ensemble, "observable")["observable"]
    threshold = settings["case.event_threshold"]
    shown = observable[np.argmax(observable.max(axis=1) >= threshold)]  # the first if none has any
    edges = edges_of(settings["case.density"])
    counts = histogram(observable, edges)
    return observable_and_density(
        np.arange(observable.shape[1]) / lyapunov_time(settings, time_unit),
        shown,
        counts.edges,
        counts.density,
        threshold,
        symbol=system.observable_symbol,
        name=system.observable_name,
    )

"""Density of the observable with and without control: means (lines) and quartiles (bands) over the
networks of an ensemble. Both flows start from the same states and are compared over the same
times. The table control_density.csv has these densities, and those without the time under
actuation.
"""

import numpy as np
from matplotlib.figure import Figure

from burstcast.figures.control_density import ControlledDensity, control_density
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast_workflow.harness.figures import Settings, figure
from burstcast_workflow.jobs.figures import OfCases
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, densities: OfCases, settings: Settings) -> Figure:
    """Draw one panel for each case."""
    system = system_of(settings)
    panels = []
    for panel in settings["panels"]:
        case, kind = panel["identity"]["case"], panel["kind"]
        rows = densities[
            (densities["case"] == case)
            & (densities["forecaster"] == "esn")
            & (densities["neurons"] == kind["neurons"])
            & (densities["validation"] == kind["validation"])
            & densities["prediction_time_lt"].isin(settings["control.prediction_times_lt"])
        ]
        by_time = {
            float(time): group.sort_values("low")
            for time, group in rows.groupby("prediction_time_lt")
        }
        bins = next(iter(by_time.values()))
        panels.append(
            ControlledDensity(
                title=f"Re = {bins['reynolds'].iloc[0]:g}" if "reynolds" in bins else case,
                bin_edges=np.append(bins["low"], bins["high"].iloc[-1]),
                threshold=panel["settings"]["case.event_threshold"],
                # the flows that count differ a little between prediction times
                uncontrolled=np.mean(
                    [group["density_uncontrolled"] for group in by_time.values()], axis=0
                ),
                controlled={
                    time: group["density_controlled"].to_numpy() for time, group in by_time.items()
                },
                bands={
                    time: group[["density_controlled_p25", "density_controlled_p75"]].to_numpy().T
                    for time, group in by_time.items()
                },
            )
        )
    # NaN where no flow counts
    if any(np.isfinite(panel.uncontrolled).all() for panel in panels):
        return control_density(panels, symbol=system.observable_symbol, name=system.observable_name)
    return nothing_to_show("No flow was free of events for long enough to be controlled.")

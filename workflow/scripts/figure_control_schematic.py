"""Draw the control strategy on a suppressed event."""

from typing import Any

from burstcast.figures.control_schematic import control_schematic
from burstcast.figures.nothing_to_show import nothing_to_show
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_netcdf


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the event, the forecast and the parts of the strategy."""
    event = read_netcdf(inputs.event)
    if event["mark"].size:
        figure = control_schematic(
            event["time_lt"],
            event["uncontrolled"],
            event["controlled"],
            event["forecast"],
            settings["event_threshold"],
            settings["prediction_time_lt"],
            tuple(event["actuation_lt"]),
            window_lt=settings["window_lt"],
            symbol=settings["symbol"],
            actuation_label=_label(settings["actuation"]),
        )
    else:
        figure = nothing_to_show("No event was suppressed.")
    write_figure(outputs, figure)


def _label(actuation):
    """What the actuation does."""
    changes = [
        f"{'Re' if name == 'reynolds' else name.replace('_', ' ')} = {value:g}"
        for name, value in actuation["parameters"].items()
    ]
    return ", ".join(changes + ["added force"] * (actuation["force"] is not None))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there

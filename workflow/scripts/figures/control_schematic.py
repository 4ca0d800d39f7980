"""The control strategy on the suppressed event: a forecast from time 0 crosses the threshold in
the window after the prediction time, which raises an alarm; the equations are changed over the
shaded interval.
"""

from typing import Any

from matplotlib.figure import Figure

from burstcast.figures.control_schematic import control_schematic
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast_workflow.harness.figures import Arrays, Settings, figure
from burstcast_workflow.jobs.systems import system_of


def _label(parameters: dict[str, float], force: Any) -> str:
    """What the actuation does."""
    changes = [
        f"{'Re' if name == 'reynolds' else name.replace('_', ' ')} = {value:g}"
        for name, value in parameters.items()
    ]
    return ", ".join(changes + ["added force"] * (force is not None))


@figure
def draw(*, event: Arrays, settings: Settings) -> Figure:
    """Draw the event, the forecast and the parts of the strategy."""
    if not event["mark"].size:
        return nothing_to_show("No event was suppressed.")
    start, stop = event["actuation_lt"]
    return control_schematic(
        event["time_lt"],
        event["uncontrolled"],
        event["controlled"],
        event["forecast"],
        settings["case.event_threshold"],
        settings["prediction_time_lt"],
        (start, stop),
        window_lt=settings["control.window_lt"],
        symbol=system_of(settings).observable_symbol,
        actuation_label=_label(
            settings["case.actuation.parameters"], settings["case.actuation.force"]
        ),
    )

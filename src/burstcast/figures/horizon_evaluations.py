"""The last evaluations of the example network before an event is predicted: the forecast starts
ever later until it stays within the tolerance up to the event.
"""

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import frame, looks, style
from burstcast.figures.registry import figure


@figure(section="horizon", position=20, needs_networks=True)
def draw(
    *,
    examples: Mapping[str, Any] = read("example/examples.nc"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    washout_lt: float = at("washout_lt"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw one panel for each forecast of the event, two by two, with the band of the tolerance.

    The event is at time 0; each forecast starts at minus its lead time.
    """
    leads_lt = examples["evaluation_lead_time_lt"]
    if not len(leads_lt):
        return style.nothing_to_show("No event was predicted from any start.")
    whole_lt, allowed = examples["evaluation_time_lt"], float(examples["allowed_error"])
    shown = whole_lt >= -leads_lt[0] - washout_lt
    time_lt, true = whole_lt[shown], examples["evaluation_truth"][shown]
    rows = (len(leads_lt) + 1) // 2
    figure = style.new_figure(style.DOUBLE_COLUMN, 1.5 * rows + 0.5)
    panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False).ravel()
    labels = frame.true_and_forecast(symbol)
    band = {"color": style.LIGHT_GREY, "linewidth": 0, "label": "tolerance"}
    for index, (panel, lead, forecast, horizon) in enumerate(
        zip(
            panels,
            leads_lt,
            examples["evaluation_forecast"],
            examples["evaluation_horizon_lt"],
            strict=False,
        )
    ):
        panel.fill_between(time_lt, true - allowed, true + allowed, **band)
        panel.plot(time_lt, true, label=labels[0], **looks.TRUTH)
        panel.plot(whole_lt, forecast, label=labels[1], **looks.NETWORK)
        frame.draw_threshold(panel, threshold, f"${symbol}_e$", at_left=True)
        panel.axvline(0, **looks.WINDOW)
        panel.axvline(-lead, color=looks.NETWORK["color"], linewidth=0.6, linestyle=":")
        verdict = r"PH $\geq \tau_e$: predicted"
        if horizon < lead:
            verdict = rf"PH = {horizon:.1f} LT $< \tau_e$"
            end = horizon - lead
            value = forecast[abs(whole_lt - end).argmin()]
            panel.plot(end, value, marker="x", color="black", markersize=5, zorder=4)
        letter = chr(ord("a") + index)
        panel.set_title(rf"({letter}) $\tau_e$ = {lead:g} LT, {verdict}", loc="left")
    for panel in panels[len(leads_lt) :]:
        panel.set_axis_off()
    panels[0].set_xlim(float(time_lt[0]), float(time_lt[-1]))
    floor, top = frame.axis_limits(threshold, true, true + allowed)
    panels[0].set_ylim(floor - (allowed if floor else 0.0), top)
    for panel in panels[: len(leads_lt)][-2:]:
        panel.set_xlabel(r"$t - t^{(e)}$ [LT]")
        panel.xaxis.set_tick_params(labelbottom=True)
    for panel in panels[::2]:
        panel.set_ylabel(frame.observable_label(symbol))
    style.legend_above(figure, [panels[0]])
    return figure

"""An extreme event of the test set as committees see it from one starting point: the forecasts of
all members and their median beside the truth (above), and the probability of an event in the window
that begins at each time (below): the share of the members that forecast one, what calibration on
the training series makes of it, and the alarm threshold. Of all
starting points of the test set that an event follows in the window farthest ahead, the one is shown
to which the first committee's share of votes is the median: half of the events were seen better,
half worse.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.arrays import BoolArray, FloatArray
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.observable_axis import axis_floor
from burstcast.figures.parts.style import (
    BLUE,
    DOUBLE_COLUMN,
    GREY,
    ORANGE,
    SINGLE_COLUMN,
    TRUTH,
    draw_threshold,
    legend_above,
    letter_panels,
    new_figure,
    observable_label,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.forecasters._labels import forecaster_label

FIGURE = Declaration(
    section="probabilities",
    position=50,
    inputs={"event": "case/committee_event.nc"},
    settings={
        "threshold": "case.event_threshold",
        "window_lt": "classification.window_lt",
        "symbol": "shown.symbol",
        "observable_name": "shown.observable_name",
    },
    cases="committees",
)

_FAN = "#8FBFDC"


@dataclass(frozen=True)
class SeenEvent:
    """True observable around a starting point.

    Attributes
    ----------
    time_lt
        Since the starting point, ``(time,)``.
    true
        Observable, ``(time,)``.
    observed
        Observations up to the starting point, ``(time,)``; NaN from there on.
    prediction_times_lt
        Beginnings of windows after the starting point, rising, ``(windows,)``.
    happened
        Whether an event began in each of them, ``(windows,)``.
    """

    time_lt: FloatArray
    true: FloatArray
    observed: FloatArray
    prediction_times_lt: FloatArray
    happened: BoolArray


@dataclass(frozen=True)
class CommitteeForecast:
    """Forecasts of a committee from the starting point.

    Attributes
    ----------
    kind
        Identity of the committee (`burstcast.figures.parts.reference_forecasters`).
    members
        Observable in each member's forecast, ``(members, time)``; NaN where there is none.
    votes, probability, alarm_threshold
        For each window: share of the members that forecast an event, calibrated probability, and
        the alarm threshold, ``(windows,)``.
    """

    kind: str
    members: FloatArray
    votes: FloatArray
    probability: FloatArray
    alarm_threshold: FloatArray


def draw(
    *,
    event: Mapping[str, Any],
    threshold: float,
    window_lt: float,
    symbol: str,
    observable_name: str,
) -> Figure:
    """Draw the event of a file of `burstcast.probability.committee_event.CommitteeEvent`.

    Its attribute ``committees`` names the kinds of the committees, in their order.
    """
    if not event["time_lt"].size:
        return nothing_to_show("No event occurred in the test set.")
    return committee_event(
        SeenEvent(
            event["time_lt"],
            event["true"],
            event["observed"],
            event["prediction_time_lt"],
            event["happened"],
        ),
        [
            CommitteeForecast(
                kind,
                event["forecast"][event["committee"] == number],
                event["votes"][number],
                event["probability"][number],
                event["alarm_threshold"][number],
            )
            for number, kind in enumerate(event["committees"].split())
        ],
        threshold,
        window_lt,
        symbol=symbol,
        observable_name=observable_name,
    )


@styled
def committee_event(
    event: SeenEvent,
    committees: Sequence[CommitteeForecast],
    threshold: float,
    window_lt: float,
    *,
    symbol: str = "k",
    observable_name: str | None = None,
) -> Figure:
    """Draw for each committee its members' forecasts, and below them the probability of an event.

    Parameters
    ----------
    event
        What happened.
    committees
        One column each; one at least.
    threshold
        Event threshold.
    window_lt
        Length of a window.
    symbol, observable_name
        Symbol and name of the observable.

    Raises
    ------
    ValueError
        If there is no committee.
    """
    if not committees:
        raise ValueError("there is no committee to draw")
    width = SINGLE_COLUMN if len(committees) == 1 else DOUBLE_COLUMN
    figure = new_figure(width, 3.8)
    panels = figure.subplots(
        2, len(committees), sharex=True, sharey="row", squeeze=False, height_ratios=[3, 2]
    )
    for (fan, chances), committee in zip(panels.T, committees, strict=True):
        _draw_fan(fan, event, committee, symbol)
        draw_threshold(fan, threshold, f"${symbol}_e$", at_left=True)
        _draw_probabilities(chances, event, committee)
        fan.set_title(forecaster_label(committee.kind), loc="center")
        chances.set_xlabel("Time from the starting point [LT]")
    # an unbounded forecast of a member must not squeeze the event
    highest = max(float(np.nanmax(event.true)), threshold)
    floor = axis_floor(event.true, np.array(threshold))
    panels[0, 0].set_ylim(floor, floor + 1.35 * (highest - floor))
    panels[0, 0].set_xlim(event.time_lt[0], event.time_lt[-1])
    panels[0, 0].set_ylabel(observable_label(symbol, observable_name))
    panels[1, 0].set_ylim(-0.06, 1.06)
    panels[1, 0].set_ylabel(f"Probability of an event\nwithin {window_lt:g} LT from then")
    columns = 2 if len(committees) == 1 else 4
    legend_above(figure, panels[0], columns=columns)
    lower, _ = panels[1, 0].get_legend_handles_labels()
    figure.legend(handles=lower, loc="outside lower center", ncols=columns)
    letter_panels(list(panels.flat), inside=True)
    return figure


def _draw_fan(axes: Axes, event: SeenEvent, committee: CommitteeForecast, symbol: str) -> None:
    shown = np.isfinite(committee.members).any(axis=0)
    for number, member in enumerate(committee.members):
        axes.plot(
            event.time_lt[shown],
            member[shown],
            color=_FAN,
            linewidth=0.5,
            zorder=1.6,
            label="" if number else "forecasts of the members",
        )
    axes.plot(
        event.time_lt[shown],
        np.nanmedian(committee.members[:, shown], axis=0),
        color=BLUE,
        linestyle=(0.0, (3.5, 1.2)),
        linewidth=1.2,
        label="their median",
    )
    axes.plot(event.time_lt, event.true, label="truth", **TRUTH)
    axes.plot(
        event.time_lt,
        event.observed,
        linestyle="none",
        marker=".",
        markersize=2.0,
        color=GREY,
        label="observation",
        zorder=3,
    )
    axes.axvline(0.0, color=GREY, linewidth=0.6, zorder=1.2)


def _draw_probabilities(axes: Axes, event: SeenEvent, committee: CommitteeForecast) -> None:
    times, happened = event.prediction_times_lt, event.happened
    axes.plot(
        times,
        committee.alarm_threshold,
        color=GREY,
        linestyle=(0.0, (1.0, 1.2)),
        linewidth=1.0,
        label="alarm threshold",
    )
    axes.plot(
        times,
        committee.votes,
        color=ORANGE,
        linestyle="--",
        linewidth=0.9,
        label="share of votes",
    )
    axes.plot(times, committee.probability, color=BLUE, linewidth=1.2, label="probability")
    for which, face, label in (
        (happened, BLUE, "an event begins then"),
        (~happened, "white", ""),
    ):
        axes.plot(
            times[which],
            committee.probability[which],
            linestyle="none",
            marker="o",
            markersize=3.6,
            color=BLUE,
            markerfacecolor=face,
            label=label,
            zorder=3,
        )
    axes.axvline(0.0, color=GREY, linewidth=0.6, zorder=1.2)

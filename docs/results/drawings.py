"""Figures of the pages of results that no campaign draws by itself."""

from itertools import product
from typing import Any

import numpy as np
from comparisons import HORIZON, f_score, hierarchical
from experiments import MIDDLE, WHICH_FLOWS
from kept_tables import PUBLISHED as PUBLISHED_PERCENTILES
from kept_tables import Tables, published_rows
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter

from burstcast.base.files.tables import read_table
from burstcast.figures import published_scores
from burstcast.figures.parts import looks, style

RV = {"forecaster": "esn", "validation": "RV"}
SQUARES = {"forecaster": "esn_quadratic", "validation": "RV"}
PUBLISHED: Any = {"marker": "o", "linestyle": "none", "color": "black", "markerfacecolor": "white"}


def draw_published_scores(tables: Tables) -> Figure:
    """Draw published medians over ours, Re = 400, RV."""
    rows = {
        argument: tables.rows(name, case="Re400")
        for argument, name in {
            "scores": "classification_percentiles",
            "score_intervals": "classification_intervals",
            "horizons": "horizon_percentiles",
            "horizon_intervals": "horizon_intervals",
        }.items()
    }
    figure: Figure = published_scores.draw(
        **rows, validation="RV", published=read_table(PUBLISHED_PERCENTILES)
    )
    return figure


@style.styled
def draw_readouts(tables: Tables) -> Figure:
    """Draw F-score and PH_ee against the size, a curve for each readout, with 95 % intervals."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.4)
    panels = figure.subplots(1, 2)
    for axes, score in zip(panels, (f_score(3.0), HORIZON), strict=True):
        means = hierarchical(tables, score)
        means = means[means["forecaster"].isin(["esn", "esn_bias", "esn_quadratic"])]
        curves = means.groupby("readout", sort=False)
        for (name, curve), look in zip(curves, looks.categories(curves.ngroups), strict=True):
            sizes = curve["neurons"].to_numpy(dtype=np.float64)
            axes.fill_between(
                sizes, curve["low"], curve["high"], alpha=0.2, lw=0, color=look["color"]
            )
            axes.plot(sizes, curve["mean"], label=str(name), **look)
        axes.set_xscale("log", base=2)
        ticks = sorted(means["neurons"].unique())
        axes.set_xticks(ticks, [f"{size:g}" for size in ticks])
        axes.set_xlabel("neurons")
        axes.set_ylabel(score.title)
    style.letter_panels(panels)
    style.label_ends(figure, panels)
    return figure


@style.styled
def draw_forecasters(paper: Tables, readouts: Tables, beyond: Tables) -> Figure:
    """Draw F-scores of forecasters with their intervals, Re = 400, beside the published ones."""
    f_scores = {"name": "classification", "metric": "f_score", "case": "Re400"}
    sources: list[tuple[str, Tables, dict[str, Any]]] = [
        ("network, 500 neurons", paper, {"neurons": 500, **RV}),
        ("network, 2000 neurons", paper, {"neurons": 2000, **RV}),
        ("network with squares, 500 neurons", readouts, {"neurons": 500} | SQUARES),
        ("true equations, noisy state", beyond, {"forecaster": "equations_noisy"}),
        ("learnt equations, filtered", beyond, {"forecaster": "quadratic_filtered"}),
        ("true equations, filtered", beyond, {"forecaster": "equations_filtered"}),
    ]
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.3)
    panels = figure.subplots(1, 3, sharey=True)
    for axes, time in zip(panels, (1.0, 3.0, 5.0), strict=True):
        for place, (_, tables, where) in enumerate(sources):
            row = tables.row(**f_scores, prediction_time_lt=time, **where)
            ends = [[row.p50 - row.low], [row.high - row.p50]]
            axes.errorbar(row.p50, place, xerr=ends, color=style.BLUE, marker="o", capsize=2)
            if tables is paper:
                published = published_rows(
                    "classification", "f_score", reynolds=400, prediction_time_lt=time, **where
                )
                place_above = np.full(len(published), place + 0.25)
                axes.plot(published["p50"], place_above, **PUBLISHED)
        axes.set_title(f"{time:g} LT ahead", loc="center")
        axes.set_xlabel("F-score")
        axes.set_xlim(0, 1.03)
    panels[0].set_yticks(range(len(sources)), [name for name, *_ in sources])
    panels[0].set_ylim(-0.6, len(sources) - 0.4)
    ours = style.bar_handle("burstcast, interval of one forecaster over test series")
    figure.legend(
        handles=[ours, Line2D([], [], label="published", **PUBLISHED)],
        loc="outside upper center",
        ncols=2,
    )
    style.letter_panels(panels)
    return figure


_NONE = 0.01
"""Height of a marker of a run without an event, per cent."""


@style.styled
def draw_late_actuator(tables: Tables) -> Figure:
    """Draw what strategies leave, and their duty cycles, by the actuator's delay.

    Feedback on each observable and each forecaster has its best settings. Where no event was
    observed, a marker lies in the grey strip, without an interval.
    """
    runs = tables.runs("control_choices", case="Re400", strength=1.0, noise=0.01)
    runs = runs.sort_values("left", kind="stable")
    of_strategy = dict(list(runs.groupby("strategy")))
    planned, receding = of_strategy["planned"], of_strategy["receding_horizon"]
    feedback, unaware = of_strategy["reactive"], receding[receding["options"].isna()]
    kinds = {
        "feedback on $k$": feedback[feedback["options"].isna()],
        "feedback on $a_1$": feedback[feedback["options"].notna()],
        "receding horizon,\nnetwork unaware of\nthe actuation": unaware[
            unaware["forecaster"] == "esn"
        ],
        "predictive control,\naware equations": planned[
            planned["forecaster"] == "quadratic_aware_filtered"
        ],
        "predictive control,\naware network": planned[planned["forecaster"] == "esn_aware"],
    }
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    panels = figure.subplots(1, 2)
    titles = {"left": "Remaining exceedance [%]", "acting": "Actuation duty cycle [%]"}
    for axes, (metric, title) in zip(panels, titles.items(), strict=True):
        curves = zip(kinds.items(), looks.categories(len(kinds)), strict=True)
        for number, ((name, rows), look) in enumerate(curves):
            best = rows.drop_duplicates("delay_lt").sort_values("delay_lt")
            value, low, high = (100 * best[f"{metric}{end}"] for end in ("", "_low", "_high"))
            seen = value > 0
            # a hair apart, so that bars and markers do not hide each other
            position = best["delay_lt"] + 0.014 * (number - 2)
            bars = (value - low)[seen], (high - value)[seen]
            axes.errorbar(position[seen], value[seen], bars, label=name, capsize=2, **look)
            unseen = np.full((~seen).sum(), _NONE * 1.3 ** (number - 3))
            axes.plot(position[~seen], unseen, **{**look, "linestyle": "none"})
        axes.set_yscale("log")
        axes.set_xlabel("Delay of the actuator [LT]")
        axes.set_ylabel(title)
        axes.set_xticks([0, 0.5, 1])
        axes.yaxis.set_major_formatter(FuncFormatter(lambda tick, _: f"{tick:g}"))
    panels[0].set_ylim(0.5 * _NONE, 200)
    panels[0].set_yticks([0.1, 1, 10, 100])
    panels[0].axhspan(0.5 * _NONE, 3 * _NONE, color=style.LIGHT_GREY, alpha=0.5, lw=0, zorder=0.2)
    panels[0].text(0.25, 1.3 * _NONE, "no event observed", ha="center", color=style.GREY)
    panels[1].set_ylim(1, 100)
    style.letter_panels(panels)
    style.label_ends(figure, panels[1:])
    return figure


@style.styled
def draw_learning_curves(tables: Tables) -> Figure:
    """Draw F-scores against the number of events that forecasters learn from."""
    data = tables.rows("dataset").set_index("case")["events_per_series"]
    scores = tables.medians("classification", "f_score", prediction_time_lt=[1.0, 3.0])
    series = scores["case"].str.removeprefix("training_").astype(int)
    scores = scores.assign(events=series * scores["case"].map(data))
    kinds = {
        "equations_filtered": "true equations, filtered",
        "quadratic_filtered": "learnt equations, filtered",
        "quadratic": "learnt equations, noisy state",
        "esn": "network, 500 neurons",
    }
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.4)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, time in zip(panels, (1.0, 3.0), strict=True):
        at_time = scores[scores["prediction_time_lt"] == time]
        curves = zip(kinds.items(), looks.categories(len(kinds)), strict=True)
        for number, ((kind, name), look) in enumerate(curves):
            curve = at_time[at_time["forecaster"] == kind].sort_values("events")
            ends = (curve["p50"] - curve["low"], curve["high"] - curve["p50"])
            position = curve["events"] * 1.03 ** (number - 1.5)
            axes.errorbar(position, curve["p50"], ends, label=name, capsize=2, **look)
        axes.set_xscale("log")
        axes.set_xticks([10, 20, 50, 100], ["10", "20", "50", "100"])
        axes.set_xlabel("Events in the training series")
        axes.set_title(f"{time:g} LT ahead", loc="center")
    panels[0].set_ylim(0, 1.04)
    panels[0].set_ylabel("F-score")
    style.letter_panels(panels)
    style.label_ends(figure, panels[1:])
    return figure


@style.styled
def draw_spread_and_error(tables: Tables) -> Figure:
    """Draw the spread of ensembles against the error of their means, along the prediction time."""
    rows = tables.rows("ensemble_spread")
    names = {
        "esn": "networks",
        "quadratic_filtered": "filter's members,\nlearnt equations",
    }
    figure = style.new_figure(style.SINGLE_COLUMN + 1.0, 2.7)
    axes = figure.subplots()
    for (kind, name), look in zip(names.items(), looks.categories(len(names)), strict=True):
        curve = rows[rows["forecaster"] == kind].sort_values("prediction_time_lt")
        axes.plot(curve["error"], curve["spread"], label=name, **look)
        for time, error, spread in curve[["prediction_time_lt", "error", "spread"]].to_numpy():
            if time in (2, 3, 4, 5):
                place: Any = {"textcoords": "offset points", "color": look["color"]}
                axes.annotate(f"{time:g}", (error, spread), (3, -8), fontsize=6.5, **place)
    longest = 1.08 * float(rows[["error", "spread"]].to_numpy().max())
    axes.plot([0, longest], [0, longest], **looks.THRESHOLD)
    axes.set_xlim(0, longest)
    axes.set_ylim(0, longest)
    axes.set_xlabel("Error of the ensemble mean [std of $k$]")
    axes.set_ylabel("Spread of the ensemble [std of $k$]")
    style.label_ends(figure, [axes])
    return figure


WHICH_KINDS = {
    "quadratic_filtered": ("learnt equations", style.PURPLE, "s"),
    "esn_filtered": ("filtered network", style.GREEN, "D"),
    "esn": ("network", style.BLUE, "o"),
    "esn_1000": ("larger network", "#0B2D4D", "h"),
    "nvar": ("NVAR", "#56B4E9", "^"),
    "analogues": ("analogues", style.GREY, "v"),
    "precursor": ("trees", style.ORANGE, "P"),
    "esn_direct": ("reservoir classifier", style.VERMILLION, "X"),
}
"""Kinds of forecasters: name, colour and marker."""
_CONDITIONS = {
    "noise\n0": {"noise": 0.0, "observed": "all"},
    "noise\n1 %": {"noise": 0.01, "observed": "all"},
    "noise\n10 %": {"noise": 0.1, "observed": "all"},
    "half\nseen": {"noise": 0.01, "observed": "half"},
    "few\nseen": {"noise": 0.01, "observed": "few"},
}


def leader(tables: Tables, **where: Any) -> Any:
    """Best kind of a condition, with the second best and the interval of the lead; or None."""
    rows = tables.rows("best", score="average_precision", rank=2, **where)
    return rows.iloc[0] if len(rows) else None


@style.styled
def draw_which_method(tables: Tables) -> Figure:
    """Draw average precision by training events, and the best kind by noise and observation."""
    scores = tables.rows("scores", noise=0.01, observed="all")
    figure = style.new_figure(style.DOUBLE_COLUMN, 5.6)
    grid = figure.subplots(
        3, len(WHICH_FLOWS), gridspec_kw={"height_ratios": [1.0, 1.0, 0.62]}, squeeze=False
    )
    for axes, (time, flow) in zip(grid[:2].flat, product((1.0, 3.0), WHICH_FLOWS), strict=True):
        of_flow = scores[(scores["flow"] == flow) & (scores["prediction_time_lt"] == time)]
        for number, (kind, (name, colour, marker)) in enumerate(WHICH_KINDS.items()):
            if kind not in set(scores["kind"]):
                continue
            curve = of_flow[of_flow["kind"] == kind].drop_duplicates("training_events")
            curve = curve.sort_values("training_events")
            value = curve["average_precision"]
            ends = (value - curve["average_precision_low"], curve["average_precision_high"] - value)
            position = curve["training_events"] * 1.05 ** (number - 3)
            look = {"color": colour, "marker": marker, "markersize": 3.2, "lw": 0.9}
            axes.errorbar(position, value, ends, label=name, elinewidth=0.5, **look)
        if len(of_flow):
            # equations that start from the last sample, where those with a filter take too long
            plain = of_flow[of_flow["kind"] == "quadratic"]
            look = {"color": style.PURPLE, "marker": "s", "mfc": "white", "markersize": 3.2}
            axes.plot(plain["training_events"], plain["average_precision"], lw=0, **look)
            axes.axhline(of_flow["base_rate"].mean(), **looks.THRESHOLD)
        axes.set_xscale("log")
        axes.set_xlim(3.8, 1400)
        axes.set_xticks([5, 20, 100, 1000], ["5", "20", "100", "1000"])
        axes.set_ylim(0, 1.03)
        if flow == "shear_flow":
            axes.set_ylabel(f"Average precision,\n{time:g} LT ahead")
        else:
            axes.set_yticklabels([])
        if time == 1.0:
            axes.set_title(WHICH_FLOWS[flow], loc="center")
            axes.set_xticklabels([])
        else:
            axes.set_xlabel("Training events")
    for axes, flow in zip(grid[2], WHICH_FLOWS, strict=True):
        _draw_best(axes, tables, flow)
    grid[2, 0].set_yticks([1, 0], ["1 LT", "3 LT"])
    style.letter_panels(list(grid.flat))
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), columnspacing=1)
    return figure


def _draw_best(axes: Any, tables: Tables, flow: str) -> None:
    """Draw a field for each condition, in the colour of its best kind, with its score and lead."""
    for column, where in enumerate(_CONDITIONS.values()):
        for row, time in enumerate((3.0, 1.0)):
            at = {"flow": flow, "prediction_time_lt": time, "events": MIDDLE, **where}
            found = leader(tables, **at)
            if found is None:
                axes.text(column, row, "–", ha="center", va="center", color=style.GREY)
                continue
            colour = WHICH_KINDS[found["best"]][1]
            decided = found["lead_low"] > 0
            field = Rectangle((column - 0.48, row - 0.46), 0.96, 0.92, color=colour, lw=0)
            field.set_alpha(0.85 if decided else 0.3)
            axes.add_patch(field)
            dark = decided and found["best"] == "esn_1000"
            place: Any = {"ha": "center", "va": "center", "fontsize": 6.5}
            place["color"] = "white" if dark else "black"
            axes.text(column, row + 0.17, f"{found['value']:.2f}".lstrip("0"), **place)
            axes.text(column, row - 0.2, f"+{found['lead']:.2f}".replace("0.", "."), **place)
    axes.set_xlim(-0.5, len(_CONDITIONS) - 0.5)
    axes.set_ylim(-0.5, 1.5)
    axes.set_xticks(range(len(_CONDITIONS)), list(_CONDITIONS), fontsize=6.5)
    axes.set_yticks([])
    axes.tick_params(length=0)

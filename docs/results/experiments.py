"""Tables of programs in benchmarks/, by training set: their means, and their figures."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from comparisons import Mean, half_interval, mean_of, paired
from kept_tables import Part, Tables
from matplotlib.figure import Figure

from burstcast.figures.parts import looks, style

TIMES = (1, 2, 3, 5)
F_SCORES = {f"F, {time} LT": f"f_{time}" for time in TIMES}
VARIANTS = {
    "plain": "as it is",
    "smoothing": "smoothing",
    "filter": "filter",
    "both": "smoothing and filter",
}
FORECASTERS = {"esn": "network", "quadratic": "learnt equations", "nvar": "NVAR"}
FORECASTERS |= {"equations": "true equations"}
HIDDEN_KINDS = {
    "conserved": "two hidden variables, energy conserved",
    "free": "two hidden variables",
    "none": "no hidden variables",
    "equations": "true equations",
}


def of_sets(tables: Tables, table: str, metric: str, **where: Any) -> pd.DataFrame:
    """A metric of some rows, as `comparisons.paired` takes it: a row for each training set."""
    return tables.rows(table, **where).set_index("set")[[metric]]


def mean_score(tables: Tables, table: str, metric: str, **where: Any) -> Mean:
    """Mean over training sets, with Student's interval over these."""
    return mean_of(of_sets(tables, table, metric, **where)[metric].tolist())


def with_range(tables: Tables, table: str, metric: str, **where: Any) -> str:
    """Mean over training sets, and in parentheses the least and the largest; one value alone."""
    values = of_sets(tables, table, metric, **where)[metric]
    if len(values) < 2:
        return f"{values.mean():.3f}"
    return f"{values.mean():.3f} ({values.min():.3f}–{values.max():.3f})"


def over_sets_and_series(tables: Tables, table: str, **where: Any) -> str:
    """Interval of the mean F at 3 LT, for other training sets and other test series; "" of one."""
    rows = tables.rows(table, **where)
    if len(rows) < 2:
        return ""
    of_test = np.square((rows["f_3_high"] - rows["f_3_low"]) / (2 * 1.96)).mean()
    count = len(rows)
    of_sets = rows["f_3"].var(ddof=1) / count
    # the true equations are the same for all sets
    half = half_interval(of_sets, of_test, count) if of_sets > 0 else 1.96 * np.sqrt(of_test)
    low, high = np.clip(rows["f_3"].mean() + np.array([-half, half]), 0.0, 1.0)
    return f"{low:.3f}–{high:.3f}"


def kinds_of(tables: Tables, table: str, columns: list[str]) -> list[dict[str, Any]]:
    """Different values of some columns, as conditions of rows; None where there is none."""
    kinds = tables.rows(table)[columns].drop_duplicates().astype(object)
    rows = kinds.where(kinds.notna(), None).to_dict("records")
    return [{str(name): value for name, value in row.items()} for row in rows]


def smoothing_name(kind: dict[str, Any]) -> str:
    """A forecaster in words."""
    size = f", {kind['neurons']:g} neurons" if kind["neurons"] is not None else ""
    return FORECASTERS[kind["kind"]] + size


def smoothing_scores(tables: Tables) -> Part:
    """F-scores and Brier skill of each variant, and what it takes."""
    cells: Part = []
    kinds = kinds_of(tables, "smoothing", ["kind", "neurons", "variant"])
    kinds.sort(key=lambda kind: [*VARIANTS].index(kind["variant"]))
    kinds.sort(key=lambda kind: ([*FORECASTERS].index(kind["kind"]), kind["neurons"] or 0))
    for kind in kinds:
        label = f"{smoothing_name(kind)}: {VARIANTS[kind['variant']]}"
        cells.append((label, "sets", f"{len(tables.rows('smoothing', **kind))}"))
        for head, metric in {**F_SCORES, "Brier skill, 3 LT": "brier_3"}.items():
            cells.append((label, head, with_range(tables, "smoothing", metric, **kind)))
            if metric == "f_3":
                ends = over_sets_and_series(tables, "smoothing", **kind)
                cells.append((label, "its 95 % interval", ends))
        milliseconds = mean_score(tables, "smoothing", "forecast_ms", **kind).mean
        cells.append((label, "forecast [ms]", f"{milliseconds:.1f}"))
    return cells


def gain(tables: Tables, metric: str, variant: str, over: str = "plain", **kind: Any) -> Mean:
    """Difference of two variants on the same training sets."""
    first, second = (
        of_sets(tables, "smoothing", metric, variant=one, **kind) for one in (variant, over)
    )
    return paired(first, second)


def gain_text(difference: Mean) -> str:
    """A difference and its margin, if there is one."""
    return difference.text(3) if difference.count > 1 else f"{difference.mean:+.3f}"


def smoothing_gains(tables: Tables) -> Part:
    """Gains of F at 3 LT and of Brier skill over the forecaster as it is."""
    cells: Part = []
    for kind in kinds_of(tables, "smoothing", ["kind", "neurons"]):
        if kind["kind"] == "equations":
            continue
        for variant in ("smoothing", "filter", "both"):
            for metric, name in {"f_3": "F, 3 LT", "brier_3": "Brier skill, 3 LT"}.items():
                difference = gain(tables, metric, variant, **kind)
                head = f"{name}: {VARIANTS[variant]}"
                cells.append((smoothing_name(kind), head, gain_text(difference)))
    return cells


def reach_scores(tables: Tables) -> Part:
    """Prediction horizons of the variants at Re = 400, and F-scores at Re = 1000."""
    cells: Part = []
    for variant, label in VARIANTS.items():
        at = {"reynolds": 400.0, "variant": variant}
        of_sets = tables.rows("smoothing_reach", **at)["horizon_lt"]
        text = f"{of_sets.mean():.2f} ({of_sets.min():.2f}–{of_sets.max():.2f})"
        cells.append((label, "PH_ee, Re = 400 [LT]", text))
        for row in tables.rows("smoothing_reach", reynolds=1000.0, variant=variant).to_dict(
            "records"
        ):
            ends = f"({row['f_3_low']:.2f}–{row['f_3_high']:.2f})"
            cells.append((label, "F, 3 LT, Re = 1000", f"{row['f_3']:.3f} {ends}"))
    return cells


def lorenz96_scores(tables: Tables) -> Part:
    """F-scores and Brier skill for Lorenz 96 at 1, 2 and 3 LT, means over seeds."""
    cells: Part = []
    for variant, label in VARIANTS.items():
        rows = tables.rows("smoothing_lorenz96", variant=variant)
        for head, metric in {"F": "f", "Brier skill": "brier"}.items():
            values = [f"{rows[f'{metric}_{time}'].mean():.2f}" for time in (1, 2, 3)]
            cells.append((label, f"Lorenz 96: {head}, 1, 2, 3 LT", " ".join(values)))
    return cells


def control_scores(tables: Tables) -> Part:
    """Control by networks, learnt and true equations, in per cent, on the same flows."""
    cells: Part = []
    told = VARIANTS | {"told": "filter, told of the actuation"}
    for row in tables.rows("smoothing_control").to_dict("records"):
        size = row["neurons"] if pd.notna(row["neurons"]) else None
        label = smoothing_name({"kind": row["kind"], "neurons": size})
        label += f": {told[row['variant']]}"
        left, low, high, duty = (100 * row[name] for name in ("remaining", "low", "high", "duty"))
        # where no flow exceeds the threshold, a bootstrap has no upper end
        text = f"{left:.2g} ({low:.2g} to {high:.2g})" if left else "0"
        cells.append((label, "remaining exceedance [%]", text))
        cells.append((label, "duty cycle [%]", f"{duty:.2g}"))
        if (row["kind"], row["variant"]) != ("equations", "filter"):
            names = ("difference", "difference_low", "difference_high")
            apart, low, high = (100 * row[name] for name in names)
            text = f"{apart:+.2g} ({low:+.2g} to {high:+.2g})"
            cells.append((label, "difference from the true equations", text))
    return cells


def consistency_scores(tables: Tables) -> Part:
    """Shares of inconsistent washouts, and scores at 2 LT, by the length of the washout."""
    cells: Part = []
    for row in tables.rows("consistency", kind="quadratic_filtered").to_dict("records"):
        label, head = row["washouts"], f"{row['washout_lt']:g} LT"
        cells.append((label, f"inconsistent, {head}", f"{100 * row['inconsistent']:.1f} %"))
    for row in tables.rows("consistency", kind="quadratic_filtered", washout_lt=1.0).to_dict(
        "records"
    ):
        for part, name in {"consistent": "consistent", "inconsistent": "the others"}.items():
            events, score = row[f"events_{part}"], row[f"alarm_f_score_{part}"]
            text = f"{score:.2f} ({events:g} events)" if events else "- (0 events)"
            cells.append((row["washouts"], f"F after {name}, 1 LT", text))
    return cells


def hidden_scores(tables: Tables) -> Part:
    """F-scores of equations where two modes are hidden."""
    cells: Part = []
    for kind in kinds_of(tables, "hidden_modes", ["kind", "hidden", "series"]):
        label = HIDDEN_KINDS[kind["kind"]]
        if kind["hidden"] in ("none", None):
            label += ", all nine modes seen"
        else:
            label += f"; {kind['hidden'].replace('a', 'a_')} hidden"
        if kind["series"] != 10:
            label += f", {kind['series']:g} training series"
        sets = len(tables.rows("hidden_modes", **kind))
        cells.append((label, "sets", f"{sets}"))
        for head, metric in {**F_SCORES, "Brier skill, 3 LT": "brier_3"}.items():
            cells.append((label, head, with_range(tables, "hidden_modes", metric, **kind)))
            if metric == "f_3":
                ends = over_sets_and_series(tables, "hidden_modes", **kind)
                cells.append((label, "its 95 % interval", ends))
    return cells


NETWORKS = {
    "esn": "squares",
    "leak": "squares, leak searched",
    "delays": "squares, past values",
    "esn_filtered": "squares, smoothing and filter",
}


def washout_scores(tables: Tables) -> Part:
    """F-scores of networks at 1 and 3 LT, by the length of their washout."""
    cells: Part = []
    for kind in kinds_of(tables, "hidden_washouts", ["kind", "neurons"]):
        rows = tables.rows("hidden_washouts", **kind)
        for row in rows.to_dict("records"):
            label = f"{NETWORKS[row['kind']]}, {row['neurons']:g} neurons"
            head = f"washout {row['washout_lt']:g} LT"
            cells.append((label, head, f"{row['f_1']:.3f}, {row['f_3']:.3f}"))
    return cells


def _curves(axes: Any, curves: dict[str, pd.DataFrame]) -> None:
    """Means over training sets against the lead time, with all sets as thin marks."""
    for (name, rows), look in zip(curves.items(), looks.categories(len(curves)), strict=True):
        values = rows[[*F_SCORES.values()]].to_numpy(dtype=np.float64)
        axes.plot(TIMES, values.mean(axis=0), label=name, **look)
        for of_set in values:
            axes.plot(TIMES, of_set, color=look["color"], alpha=0.35, lw=0.5)
    axes.set_xlabel("lead time [LT]")
    axes.set_ylabel("F-score")
    axes.set_xticks(TIMES)
    axes.set_ylim(0, 1.02)


@style.styled
def draw_smoothing(tables: Tables) -> Figure:
    """Draw F-scores of networks against the lead time, a curve for each variant."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.4)
    sizes = (500.0, 1000.0)
    panels = figure.subplots(1, len(sizes), sharey=True)
    for axes, size in zip(panels, sizes, strict=True):
        rows = {
            name: tables.rows("smoothing", kind="esn", neurons=size, variant=variant)
            for variant, name in VARIANTS.items()
        }
        _curves(axes, rows)
        axes.set_title(f"{size:g} neurons", loc="center")
    panels[0].legend(loc="lower left")
    style.letter_panels(panels)
    return figure


@style.styled
def draw_hidden_modes(tables: Tables) -> Figure:
    """Draw F-scores of equations against the lead time where two modes are hidden."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.4)
    axes = figure.subplots()
    rows = {}
    for kind, name in HIDDEN_KINDS.items():
        found = tables.rows("hidden_modes", kind=kind, hidden="a8, a9", series=10)
        if kind == "equations":
            name, found = f"{name}, all nine modes seen", tables.rows("smoothing", kind=kind)
        if len(found):
            rows[name] = found
    _curves(axes, rows)
    axes.legend(loc="center left")
    return figure


def long_runs(new: Tables, earlier: Tables, **where: Any) -> pd.DataFrame:
    """Rows of return times; an asterisk marks those of an earlier campaign that no newer one has.

    Earlier rows count excursions that were under way when counting began, one of each flow at most.
    """
    keys = ["case", "forecaster", "strategy", "horizon_lt", "delay_lt", "strength"]
    rows, former = (each.rows("return_times", **where) for each in (new, earlier))
    made = {*map(tuple, rows[keys].fillna(0).to_numpy())}
    others = [tuple(run) not in made for run in former[keys].fillna(0).to_numpy()]
    return pd.concat([rows.assign(mark=""), former[others].assign(mark="*")], ignore_index=True)


def matched_scores(tables: Tables, time: float = 3.0) -> Part:
    """F-scores at each Reynolds number of forecasters with as many training series each."""
    cells: Part = []
    rows = tables.rows("classification", prediction_time_lt=time)
    for kind, name in MATCHED.items():
        for case, here in rows[rows["forecaster"] == kind].groupby("case", sort=False):
            if str(case).startswith("few"):
                continue
            values, head = here["f_score"], f"Re = {here['reynolds'].iloc[0]:g}"
            text = f"{values.mean():.3f}"
            if len(values) > 1:
                text += f" ({values.min():.3f}–{values.max():.3f})"
            cells.append((name, head, text))
    heads = sorted({head for _, head, _ in cells}, key=lambda head: float(head.split("=")[1]))
    names = [*MATCHED.values()]
    return sorted(cells, key=lambda cell: (names.index(cell[0]), heads.index(cell[1])))


def matched_gains(tables: Tables, time: float = 3.0) -> dict[float, Mean]:
    """F of aware networks less that of networks of one Reynolds number, by this; over seeds."""
    rows = tables.rows("classification", prediction_time_lt=time, forecaster=["esn", "esn_aware"])
    wide = rows.pivot(index="seed", columns=["reynolds", "forecaster"], values="f_score")
    return {
        reynolds: mean_of((wide[reynolds, "esn_aware"] - wide[reynolds, "esn"]).tolist())
        for reynolds in sorted(set(rows["reynolds"]))
    }


MATCHED = {
    "esn": "network, 500 neurons",
    "esn_aware": "aware network, 500 neurons",
    "quadratic": "learnt equations, from the noisy state",
    "quadratic_aware": "aware learnt equations, from the noisy state",
    "quadratic_aware_filtered": "aware learnt equations, filtered",
}
"""Kinds that know the Reynolds number, and their rivals."""


# -- which method, when ----------------------------------------------------------------------------

MIDDLE = 40
"""Events in the training series while noise and observed components vary."""
WHICH_NAMES = {
    "quadratic_filtered": "learnt equations, filtered",
    "quadratic": "learnt equations, noisy state",
    "esn": "network, 300 neurons",
    "esn_1000": "network, 1000 neurons",
    "esn_filtered": "filtered network, 300 neurons",
    "nvar": "NVAR",
    "analogues": "nearest analogues",
    "precursor": "boosted trees",
    "esn_direct": "reservoir, logistic readout",
}
WHICH_FLOWS = {
    "shear_flow": "shear flow",
    "lorenz96": "Lorenz 96",
    "kuramoto_sivashinsky": "Kuramoto–Sivashinsky",
    "kolmogorov": "Kolmogorov flow",
}


def average_precisions(tables: Tables) -> Part:
    """Average precision of each kind at `MIDDLE` events 1 and 3 LT ahead, with its interval."""
    rows = tables.rows("scores", events=MIDDLE, noise=0.01, observed="all")
    cells: Part = []
    for kind, name in WHICH_NAMES.items():
        for flow, title in WHICH_FLOWS.items():
            here = rows[(rows["kind"] == kind) & (rows["flow"] == flow)]
            for row in here.sort_values("prediction_time_lt").to_dict("records"):
                ends = f"{row['average_precision_low']:.2f}–{row['average_precision_high']:.2f}"
                head = f"{title}, {row['prediction_time_lt']:g} LT"
                cells.append((name, head, f"{row['average_precision']:.2f} ({ends})"))
    for flow, title in WHICH_FLOWS.items():
        for time, here in rows[rows["flow"] == flow].groupby("prediction_time_lt"):
            head = f"{title}, {time:g} LT"
            cells.append(("base rate", head, f"{here['base_rate'].mean():.2f}"))
    heads = [f"{title}, {time} LT" for title in WHICH_FLOWS.values() for time in (1, 3)]
    rows_of_kinds = [*WHICH_NAMES.values(), "base rate"]
    empty: Part = [(rows_of_kinds[0], head, "") for head in heads]
    there = {(row, head) for row, head, _ in cells}
    empty = [cell for cell in empty if cell[:2] not in there]
    return sorted(
        [*empty, *cells], key=lambda cell: (rows_of_kinds.index(cell[0]), heads.index(cell[1]))
    )


def leads(tables: Tables) -> pd.DataFrame:
    """Best kinds by average precision and their leads over the second best, a row each."""
    return tables.rows("best", score="average_precision", rank=2)


def neural(tables: Tables, model: str, number: int = 0) -> Any:
    """Row of a wrong model, a hybrid or the gated network on one training set."""
    rows = tables.rows("neural_baselines", model=model, set=number)
    if len(rows) != 1:
        raise LookupError(f"{len(rows)} rows of {model}, set {number}, not one")
    return rows.iloc[0]


def seconds_of(tables: Tables) -> float:
    """Processor seconds of all fits and forecasts."""
    once = tables.rows("scores", prediction_time_lt=1.0)
    return float((once["fit_seconds"] + once["forecast_seconds"]).sum())


def which(tables: Tables, kind: str, flow: str, time: float, **where: Any) -> Any:
    """Row of scores of a kind at `MIDDLE` events with 1 % noise, unless said otherwise."""
    where = {"events": MIDDLE, "noise": 0.01, "observed": "all", **where}
    rows = tables.rows("scores", kind=kind, flow=flow, prediction_time_lt=time, **where)
    if len(rows) != 1:
        raise LookupError(f"{len(rows)} rows of {kind}, {flow}, {time:g} LT, {where}, not one")
    return rows.iloc[0]


def fits_made(tables: Tables) -> Part:
    """Numbers of training events of the fits of each kind, and the conditions beside them."""
    cells: Part = []
    once = tables.rows("scores", prediction_time_lt=1.0)
    for kind, name in WHICH_NAMES.items():
        for flow, title in WHICH_FLOWS.items():
            here = once[(once["kind"] == kind) & (once["flow"] == flow)]
            usual = here[(here["noise"] == 0.01) & (here["observed"] == "all")]
            made = " ".join(f"{events:g}" for events in sorted(set(usual["training_events"])))
            noise = [f"{100 * value:g} %" for value in sorted(set(here["noise"]) - {0.01})]
            seen = sorted(set(here["observed"]) - {"all"}, reverse=True)
            cells.append((name, title, ", ".join(filter(None, [made, *noise, *seen])) or "–"))
    return cells


def neural_rows(tables: Tables) -> Part:
    """F-scores of wrong models, hybrids and the gated network, beside networks of the same data."""
    cells: Part = []

    def add(label: str, row: Any, seconds: str) -> None:
        for head, metric in F_SCORES.items():
            ends = f" ({row['f_3_low']:.3f}–{row['f_3_high']:.3f})" if metric == "f_3" else ""
            cells.append((label, head, f"{row[metric]:.3f}{ends}"))
        cells.append((label, "fit [s]", seconds))

    for row in tables.rows("neural_baselines").to_dict("records"):
        seconds = f"{row['seconds']:.0f}"
        if pd.notna(row["search_seconds"]):
            seconds = f"{row['search_seconds']:.0f} + {seconds}"
        add(f"{row['model']}, set {row['set'] + 1}", row, seconds)
    for variant in ("plain", "both"):
        for row in tables.rows("smoothing", kind="esn", neurons=500.0, variant=variant).to_dict(
            "records"
        ):
            label = f"network, 500 neurons, {VARIANTS[variant]}, set {row['set'] + 1}"
            add(label, row, f"{row['seconds']:.0f}" if variant == "plain" else "")
    return cells


def bank_skills(measured: Path) -> pd.DataFrame:
    """Brier skill of each kind (columns) on each system of the bank, from its Markdown table."""
    rows = [
        [cell.strip(" `") for cell in line.strip("|\n").split("|")]
        for line in measured.read_text(encoding="utf-8")
        .partition("## A bank of systems")[2]
        .partition("\n## ")[0]
        .splitlines()
        if line.startswith("| ")
    ]
    numbers = [
        [float(cell.partition(",")[0].replace("refused", "nan")) for cell in row[1:-1]]
        for row in rows[1:]
    ]
    return pd.DataFrame(numbers, [row[0] for row in rows[1:]], rows[0][1:-1])


def bank_counts(measured: Path) -> Part:
    """On how many systems of the bank each kind is the best, or within 0.1 of it."""
    skills = bank_skills(measured)
    best = skills.max(axis=1)
    cells: Part = []
    for kind in skills:
        lost = best - skills[kind]
        name = WHICH_NAMES.get(str(kind), str(kind).replace("_", " ")).replace("300", "100")
        for head, share in (("best", lost == 0), ("within 0.1 of the best", lost <= 0.1)):
            cells.append((name, f"{head} of {len(skills)}", f"{share.sum()}"))
        invalid = skills[kind] < 0.05
        cells.append(
            (name, "no skill (below 0.05), or refused", f"{(invalid | skills[kind].isna()).sum()}")
        )
    return cells

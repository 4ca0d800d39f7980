"""Summary and warnings of a finished campaign, shown at the end of a run."""

from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from burstcast.base.names import described
from burstcast.base.natural_order import natural_order

if TYPE_CHECKING:
    import pandas as pd

PREDICTION_TIME_LT = 2.0
"""Of the F-score that is shown, or the nearest that the campaign has."""

MOST_ROWS = 16

MOST_WARNINGS = 8
"""Warnings that are shown; more where there are more kinds, of which each has one."""

LOOK_FIRST_AT = ("published_scores", "forecast_skill")
"""Figures that the summary names first, if they exist."""

_WARNINGS = "warnings"
_KEYS = ["case", "forecaster", "neurons", "validation"]


def closing_summary(results: Path) -> str:
    """All that the end of a run shows: scores, warnings, and where the results lie."""
    tables = results / "tables"
    parts = campaign_summary(tables), warnings_summary(tables), where_results_lie(results)
    return "\n\n".join(filter(None, parts))


def campaign_summary(tables: Path) -> str:
    """`summary_table` as text, as far as it fits on a screen; empty without any score."""
    table = summary_table(tables_in(tables))
    if table is None:
        return ""
    shown_rows = table.head(MOST_ROWS)
    text = shown_rows.to_string(index=False, na_rep="", float_format=lambda value: f"{value:.3g}")
    left_out = len(table) - len(shown_rows)
    return text + (f"\n... and {left_out} more in {tables}" if left_out > 0 else "")


def tables_in(directory: Path) -> dict[str, Path]:
    """Tables in a directory, by name."""
    return {path.stem: path for path in directory.glob("*.csv")}


def summary_table(tables: Mapping[str, Path]) -> "pd.DataFrame | None":
    """Medians over the networks of each ensemble: F-score, prediction horizon, control.

    ``tables``: Files of existing tables, by name. Returns a row for each ensemble, the best of each
    case first: case, ``forecaster``, and a column for each available score, by its name for people.
    None without any score.
    """
    import pandas as pd  # planning needs no tables

    columns = {}
    scores = _medians(tables, "classification_percentiles", "f_score")
    if scores is not None:
        times = scores["prediction_time_lt"].to_numpy(dtype=np.float64)
        shown = times[np.abs(times - PREDICTION_TIME_LT).argmin()]
        at_time = scores[times == shown].set_index(_KEYS)
        columns[f"F-score {shown:g} LT ahead"] = at_time["p50"]
    horizons = _medians(tables, "horizon_percentiles", "mean_horizon_lt")
    if horizons is not None:
        columns["mean PH_ee [LT]"] = horizons.set_index(_KEYS)["p50"]
    columns |= _control(tables)
    if not columns:
        return None
    table = pd.DataFrame(columns).dropna(how="all")
    first = next(iter(columns))
    table = table.reset_index().sort_values(first, ascending=False, kind="stable")
    place = sorted(set(table["case"]), key=natural_order).index
    table = table.sort_values("case", key=lambda cases: cases.map(place), kind="stable")
    forecasters = [_described(row) for row in table[_KEYS].to_dict("records")]
    table = table.drop(columns=_KEYS[1:])
    table.insert(1, "forecaster", forecasters)
    return table


def where_results_lie(results: Path) -> str:
    """Places of existing tables and figures, and the figures to look at first."""
    places = []
    if any((results / "tables").glob("*.csv")):
        places.append(f"Tables: {results}/tables/*.csv and *.tex.")
    figures = results / "figures"
    if any(figures.glob("*.png")):
        first = [name for name in LOOK_FIRST_AT if (figures / f"{name}.png").exists()]
        look = f"; look first at {' and '.join(first)}" if first else ""
        places.append(f"Figures: {figures}/*.pdf and *.png{look}.")
    if (results / "report.html").exists():
        places.append(f"All on one page: {results}/report.html.")
    return " ".join(places) or f"Results: {results}"


def _control(tables: Mapping[str, Path]) -> dict[str, "pd.Series[float]"]:
    """Exceedance without and under control, at the prediction time with the least exceedance."""
    controlled = _medians(tables, "control_percentiles", "exceedance_controlled")
    uncontrolled = _medians(tables, "control_percentiles", "exceedance_uncontrolled")
    if controlled is None or uncontrolled is None:
        return {}
    least = controlled.loc[controlled.groupby(_KEYS)["p50"].idxmin()]
    pairs = least.merge(uncontrolled, on=[*_KEYS, "prediction_time_lt"], suffixes=("", "_free"))
    pairs = pairs.set_index(_KEYS)
    return {
        "exceedance": pairs["p50_free"],
        "under control": pairs["p50"],
        "PT [LT]": pairs["prediction_time_lt"],
    }


def warnings_summary(tables: Path) -> str:
    """Signs that results are less than they seem, each with what to try; "" if there are none."""
    warnings = found_warnings(tables_in(tables))
    if not warnings:
        return ""
    lines = ["  {whose}: {finding}. Try: {advice}.".format(**warning) for warning in warnings]
    most = max(MOST_WARNINGS, len({warning["kind"] for warning in warnings}))
    left_out = len(lines) - most
    lines = lines[:most] + ([f"  ... and {left_out} more"] if left_out > 0 else [])
    return "\n".join([f"What to look at twice ({tables / _WARNINGS}.csv):", *lines])


def found_warnings(tables: Mapping[str, Path]) -> list[dict[str, str]]:
    """Signs that results are less than they seem: kind, whose, finding, advice; one for several.

    The first of each kind come first, so that no kind is missing where not all are shown.
    """
    table = _read(tables, _WARNINGS)
    if table is None:
        return []
    names = [_described(row) for row in table.astype(object).to_dict("records")]
    keys = ["warning", "finding", "advice", "case"]
    warnings = table.assign(forecaster=names).groupby(keys, sort=False)["forecaster"]
    joined = warnings.agg(lambda listed: "; ".join(filter(None, listed))).reset_index()
    joined = joined.iloc[joined["warning"].duplicated().argsort(kind="stable")]
    return [
        {
            "kind": row["warning"],
            "whose": ", ".join(filter(None, [row["case"], row["forecaster"]])),
            "finding": row["finding"],
            "advice": row["advice"],
        }
        for row in joined.to_dict("records")
    ]


def _read(tables: Mapping[str, Path], name: str) -> "pd.DataFrame | None":
    """Read a table that may be missing, or of no byte: a finished campaign does not fail for it."""
    import pandas as pd

    return pd.read_csv(tables[name]) if name in tables and tables[name].stat().st_size else None


def _medians(tables: Mapping[str, Path], name: str, metric: str) -> "pd.DataFrame | None":
    table = _read(tables, name)
    if table is None:
        return None
    chosen = table[table["metric"] == metric].dropna(subset=["p50"])
    # what has no size and no strategy is one forecaster all the same
    chosen = chosen.fillna({"neurons": 0, "validation": ""})
    return None if chosen.empty else chosen


def _described(row: Mapping[Hashable, Any]) -> str:
    return described(row["forecaster"], row["neurons"], row["validation"])

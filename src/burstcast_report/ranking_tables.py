"""Markdown tables of campaigns of encoded flows, for docs/results.md."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from burstcast.probability.ranking import ONSET
from burstcast.tables.ranked import SAME_EVERYWHERE, shown_once
from burstcast_report.control_tables import chosen_runs
from burstcast_report.results_tables import (
    Tables,
    controller_in,
    forecaster_in,
    markdown,
    percent_with_ends,
    significant,
    strategy_in_words,
    with_ends,
)

_METRIC = "average_precision"
_MOST_LEFT, _MOST_TIME = 0.01, 0.1
"""Shares of the exceedance and of the time that control was to leave and to take at most."""
_KEYS = ["case", "alarm", "forecaster", "neurons", "validation"]


def average_precision(tables: Tables, event: str, source: str) -> str:
    """Average precision of all that rank starting points, with intervals over test series.

    Only the case ``source`` and what is observed of it have the same test series.
    """
    rows = _rows(tables, event, source)
    times = sorted(rows["prediction_time_lt"].unique())
    shown = []
    for _, part in rows.groupby(_KEYS, dropna=False, sort=False):
        first, *_ = records = part.to_dict("records")
        cells = {row["prediction_time_lt"]: with_ends(row) for row in records}
        of = "" if first["alarm"] in SAME_EVERYWHERE else f"`{first['case']}`"
        shown.append([of, _name(first), *(cells.get(time, "") for time in times)])
    return markdown(["case", "", *(f"{time:g} LT" for time in times)], shown)


def targets(tables: Tables, source: str) -> str:
    """Attainable and attained average precision of onsets, of a case and what is observed of it."""
    rows = _rows(tables, ONSET, source)
    learnt = rows[
        ~rows["forecaster"].str.startswith("equations") & ~rows["alarm"].isin(SAME_EVERYWHERE)
    ]
    shown = []
    for time, wanted in ((0.5, 0.75), (1.0, 0.5), (2.0, 0.2)):
        at = learnt[learnt["prediction_time_lt"] == time]
        best = _best(at)
        shown.append(
            [
                f"the best forecaster that learns, {time:g} LT ahead",
                f"above {wanted:g}",
                f"{with_ends(best)}: {_said(best)}",
                _reached(best["value"] > wanted),
            ]
        )
    one = learnt[learnt["prediction_time_lt"] == 1.0]
    reservoirs = one[one["neurons"].notna() | (one["forecaster"] == "esn_direct")]
    boosting = one[one["forecaster"] == "precursor"]
    if len(reservoirs) and len(boosting):
        best, other = _best(reservoirs), _best(boosting)
        shown.append(
            [
                "a reservoir against the learnt precursor, 1 LT ahead",
                "not below its interval",
                f"{with_ends(best)} against {with_ends(other)}: {_said(best)}",
                _reached(best["value"] >= other["low"]),
            ]
        )
    known = rows[rows["prediction_time_lt"] == 1.0]
    filtered, whole = (
        float(known.loc[known["alarm"] == alarm, "value"].max())
        for alarm in ("equations_filtered", "equations_noisy")
    )
    shown.append(
        [
            "the filter from sensors against all amplitudes with noise, 1 LT ahead",
            "within 0.05",
            f"{significant(filtered)} against {significant(whole)}",
            _reached(filtered >= whole - 0.05),
        ]
    )
    shown += _control(tables)
    return markdown(["average precision of onsets, control", "wanted", "found", ""], shown)


def _control(tables: Tables) -> list[list[str]]:
    """Least exceedance that control leaves at a tenth of the time, by all and from sensors."""
    runs = [
        run
        for run in chosen_runs(tables)
        if run.scores["control_fraction"]["value"] <= _MOST_TIME
        and run.keys["forecaster"] != "random"
    ]
    shown = []
    for from_sensors, name in ((False, "by true states"), (True, "from sensors")):
        some = [run for run in runs if isinstance(run.keys.get("observed"), str) == from_sensors]
        if not some:
            continue
        best = min(some, key=lambda run: run.scores["relative_exceedance"]["value"])
        left, time = (best.scores[name] for name in ("relative_exceedance", "control_fraction"))
        shown.append(
            [
                f"exceedance left under control {name}, at a tenth of the time at most",
                "1 % at most",
                f"{percent_with_ends(left)} % at {percent_with_ends(time)} % of the time: "
                f"{strategy_in_words(best.keys, ['span_lt'])}, by "
                f"{controller_in(best.keys) or 'no forecaster'}, in `{best.keys['case']}`",
                _reached(left["value"] <= _MOST_LEFT),
            ]
        )
    return shown


def _rows(tables: Tables, event: str, source: str) -> pd.DataFrame:
    """Rows of an event: committees in place of their members, each alarm once."""
    rows = tables.rows("ranking", event=event, metric=_METRIC)
    return shown_once(rows[rows["case"].isin(_of_same_series(tables, source))])


def _of_same_series(tables: Tables, source: str) -> set[str]:
    """Cases that have the series of a case: as many, with the same mean of the observable."""
    cases = tables.rows("dataset").set_index("case")[["series_kept", "mean_observable"]]
    return {*cases.index[(cases == cases.loc[source]).all(axis=1)]}


def _name(row: Mapping[Any, Any]) -> str:
    if row["alarm"] in SAME_EVERYWHERE:
        return str(row["forecaster"]).replace("_", " ")
    return forecaster_in(row)


def _best(rows: pd.DataFrame) -> dict[Any, Any]:
    return rows.sort_values("value").to_dict("records")[-1]


def _said(row: Mapping[Any, Any]) -> str:
    return f"{_name(row)} on `{row['case']}`"


def _reached(yes: bool) -> str:
    return "reached" if yes else "not reached"

"""Markdown tables of strategies of control at their best, for docs/results.md."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pandas as pd

from burstcast_report.results_tables import (
    Tables,
    forecaster_in,
    markdown,
    option_text,
    percent_with_ends,
    significant,
)


@dataclass(frozen=True)
class ChosenRun:
    """A run of control with the settings that half of the flows chose, scored on the others.

    Attributes
    ----------
    keys
        Case, forecaster, strategy, conditions and settings, by column.
    scores
        Rows of `control_choices`, by metric.
    """

    keys: dict[str, Any]
    scores: dict[str, dict[Any, Any]]


_SHOWN_SETTINGS = ("level", "horizon_lt", "margin", "probability")
_RESULTS = ("metric", "value", "low", "high")


def chosen_runs(tables: Tables, **wanted: Any) -> Iterator[ChosenRun]:
    """Runs of the table `control_choices` whose columns have these values."""
    found = tables.rows("control_choices", **wanted)
    if found.empty:
        return
    observed = found.get("observed", pd.Series("", found.index)).fillna("")
    order = found.assign(observed=observed).sort_values(
        ["observed", "noise", "strength", "delay_lt"],
        ascending=[True, True, False, True],
        kind="stable",
    )
    found = found.loc[order.index]
    keys = [str(name) for name in found if name not in _RESULTS]
    for _, part in found.groupby(keys, dropna=False, sort=False):
        records = part.to_dict("records")
        first = {str(name): value for name, value in records[0].items() if name not in _RESULTS}
        yield ChosenRun(first, {row["metric"]: row for row in records})


def choices(tables: Tables, case: str) -> str:
    """Strategies at their best under each condition: what is left, how long they act, how hard.

    The last column is there if the campaign records the effort (`control.cost`).
    """
    rows = [
        [
            condition(run.keys),
            strategy(run.keys),
            percent_with_ends(run.scores["relative_exceedance"]),
            percent_with_ends(run.scores["control_fraction"]),
            *([significant(1000 * effort["value"], 2)] if effort else []),
        ]
        for run in chosen_runs(tables, case=case)
        for effort in [run.scores.get("effort")]
    ]
    head = ["condition", "strategy, settings as chosen", "left [%]", "time under actuation [%]"]
    return markdown([*head, "effort [1e-3]"][: len(rows[0])], rows) if rows else ""


def condition(keys: dict[str, Any]) -> str:
    """Under which conditions a run controls, in words."""
    parts = []
    if keys["strength"] != 1:
        parts.append(f"strength {keys['strength']:g}")
    if keys["delay_lt"]:
        parts.append(f"{keys['delay_lt']:g} LT late")
    if keys["noise"] != 0.01:
        parts.append(f"{100 * keys['noise']:g} % noise")
    if isinstance(keys.get("observed"), str):
        parts.append(f"observed: {keys['observed'].replace('_', ' ')}")
    return ", ".join(parts) or "in time"


def strategy(keys: dict[str, Any]) -> str:
    """Strategy of a run, its forecaster and the chosen settings, in words."""
    name = str(keys["strategy"]).replace("_", " ")
    if keys["forecaster"] != "none":
        name += f" by {forecaster_in(keys)}"
    settings = [
        f"{key.removesuffix('_lt')} {keys[key]:g}"
        for key in _SHOWN_SETTINGS
        if key in keys and pd.notna(keys[key])
    ]
    if isinstance(keys.get("options"), str):
        settings.append(option_text(keys["options"]))
    return f"{name} ({', '.join(settings)})" if settings else name

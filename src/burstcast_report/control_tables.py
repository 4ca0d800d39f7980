"""Markdown tables of strategies of control at their best, for docs/results.md."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from burstcast_report.results_tables import (
    Tables,
    controller_in,
    markdown,
    percent_with_ends,
    significant,
    strategy_in_words,
    with_telling_seeds,
)


@dataclass(frozen=True)
class ChosenRun:
    """A run of control with the settings that half of the flows chose, scored on the others."""

    keys: dict[str, Any]  #: case, forecaster, strategy, conditions and settings, by column
    scores: dict[str, dict[Any, Any]]  #: rows of `control_choices`, by metric


_TOLD = ("strength", "delay_lt", "noise", "observed", "span_lt")
"""Columns that the column of the condition tells, or the page for all rows."""
_RESULTS = ("metric", "value", "low", "high")


def chosen_runs(tables: Tables, **wanted: Any) -> Iterator[ChosenRun]:
    """Runs of the table `control_choices` whose columns have these values."""
    found = tables.rows("control_choices", **wanted)
    if found.empty:
        return
    observed = found.get("observed", pd.Series("", found.index)).astype(object).fillna("")
    order = found.assign(observed=observed).sort_values(
        ["observed", "noise", "strength", "delay_lt"],
        ascending=[True, True, False, True],
        kind="stable",
    )
    found = with_telling_seeds(found.loc[order.index])
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
            *strategy(run.keys),
            percent_with_ends(run.scores["relative_exceedance"]),
            percent_with_ends(run.scores["control_fraction"]),
            *([significant(1000 * effort["value"], 2)] if effort else []),
        ]
        for run in chosen_runs(tables, case=case)
        for effort in [run.scores.get("effort")]
    ]
    head = ["condition", *STRATEGY, "left [%]", "time under actuation [%]"]
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


STRATEGY = ("strategy, settings as chosen", "forecaster")
"""Heads of the cells of `strategy`."""


def strategy(keys: Mapping[str, Any]) -> tuple[str, str]:
    """Two cells of a run: its strategy with the settings, and its forecaster."""
    return strategy_in_words(keys, _TOLD), controller_in(keys)

"""Runs of all strategies of control: which are shown, and under which conditions."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from burstcast.figures.parts import looks
from burstcast.forecasters._labels import forecaster_label

LEFT, ACTING = "relative_exceedance", "control_fraction"
_ENDS = ("value", "low", "high")
_NO_SETTINGS = {
    *("case", "reynolds", "forecaster", "neurons", "validation", "seed", "strategy", "label"),
    *("starts", "quiet_lt", "span_lt", "delay_lt", "strength", "noise"),
    *(f"{end}_{metric}" for metric in (LEFT, ACTING) for end in _ENDS),
}


@dataclass(frozen=True)
class Condition:
    """A condition that strategies are tried under, as an axis."""

    column: str
    label: str
    logarithmic: bool = True
    unit: float = 1.0


CONDITIONS = (
    Condition("delay_lt", "Delay of the actuator [LT]", logarithmic=False),
    Condition("strength", "Strength of the actuator"),
    Condition("noise", "Noise of the observations [%]", unit=100.0),
)


def of_network(scores: pd.DataFrame, network: Mapping[str, Any] | None) -> pd.DataFrame:
    """Rows of one network, of the committee of its size, and of all other forecasters."""
    shown = ~scores["forecaster"].isin(["esn", "esn_committee", "random"])
    if network is not None:
        shown |= (scores[list(network)] == pd.Series(network)).all(axis="columns")
        size = pd.Series(network)[["neurons", "validation"]]
        alike = (scores[list(size.index)] == size).all(axis="columns")
        shown |= alike & (scores["forecaster"] == "esn_committee")
    return scores[shown]


def runs_of(scores: pd.DataFrame, span_lt: float) -> pd.DataFrame:
    """A row for each run of the flows that are shown, with both scores and its ``label``.

    These start quietly, last so long, and have the quiet that most runs have.
    """
    keys = [name for name in scores.columns if name not in ("metric", *_ENDS)]
    parts = []
    for metric in (LEFT, ACTING):
        rows = scores[scores["metric"] == metric].drop(columns="metric").drop_duplicates(keys)
        parts.append(rows.rename(columns={end: f"{end}_{metric}" for end in _ENDS}))
    runs = parts[0].merge(parts[1], on=keys)
    shown = (runs["starts"] == "quiet") & np.isclose(runs["span_lt"], span_lt)
    runs = runs.loc[shown & runs[f"value_{LEFT}"].notna()]
    runs = runs.loc[runs["quiet_lt"].isin(runs["quiet_lt"].mode()[-1:])]
    return runs.assign(label=_labels(runs))


def where(runs: pd.DataFrame, conditions: Mapping[str, float]) -> pd.DataFrame:
    """Runs under these conditions."""
    matching = np.ones(len(runs), dtype=bool)
    for name, value in conditions.items():
        matching &= np.isclose(runs[name].astype(np.float64), value)
    return runs.loc[matching]


def tried_under(runs: pd.DataFrame, conditions: Mapping[str, float], column: str) -> pd.DataFrame:
    """Runs of one setting of each strategy and forecaster at several values of one condition.

    All other conditions are as usual. The setting is the one that was tried at most values, and of
    several the one that leaves least.
    """
    runs = where(runs, {name: value for name, value in conditions.items() if name != column})
    chosen = []
    for _, of_label in runs.groupby("label", sort=False):
        settings = [rows for _, rows in of_label.groupby(_settings(runs), dropna=False)]
        tried = [rows for rows in settings if rows[column].nunique() > 1]
        if tried:
            chosen.append(
                min(tried, key=lambda rows: (-rows[column].nunique(), rows[f"value_{LEFT}"].mean()))
            )
    return pd.concat(chosen) if chosen else runs.iloc[:0]


def undominated(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs that no other run betters in what is left and in the time under actuation."""
    runs = runs.sort_values([f"value_{ACTING}", f"value_{LEFT}"])
    left = runs[f"value_{LEFT}"]
    return runs[left < left.cummin().shift(fill_value=np.inf)]


def _settings(runs: pd.DataFrame) -> list[str]:
    """Names of the settings that any strategy has."""
    return [name for name in runs.columns if name not in _NO_SETTINGS]


def _labels(runs: pd.DataFrame) -> list[str]:
    """Strategy and forecaster in words, and what it observes where its runs differ in that."""
    labels = []
    for strategy, forecaster in zip(runs["strategy"], runs["forecaster"], strict=True):
        title, _ = looks.strategy(strategy)
        labels.append(title if forecaster == "none" else f"{title}, {forecaster_label(forecaster)}")
    if "observed" not in runs:
        return labels
    observed = runs["observed"].fillna("")
    counts = observed.groupby(labels).nunique()
    return [
        f"{label}, observed {modes.replace('_', ' ')}" if counts[label] > 1 and modes else label
        for label, modes in zip(labels, observed, strict=True)
    ]

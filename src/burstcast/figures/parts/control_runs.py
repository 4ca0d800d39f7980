"""Runs of all strategies of control: which are shown, and in what words."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from burstcast.control.setting_names import option_words
from burstcast.figures.parts import looks

LEFT, ACTING = "relative_exceedance", "control_fraction"
_NO_SETTINGS = {
    *("case", "reynolds", "forecaster", "neurons", "validation", "seed", "strategy", "kind"),
    *("starts", "quiet_lt", "span_lt", "delay_lt", "strength", "noise"),
    *(f"{name}_{metric}" for metric in (LEFT, ACTING) for name in ("value", "low", "high")),
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
    """A row for each run of the flows that are shown, with both scores.

    These start quietly, last so long, and have the quiet that most runs have.
    """
    keys = [name for name in scores.columns if name not in ("metric", "value", "low", "high")]
    parts = []
    for metric in (LEFT, ACTING):
        rows = scores[scores["metric"] == metric].drop(columns="metric").drop_duplicates(keys)
        new = {name: f"{name}_{metric}" for name in ("value", "low", "high")}
        parts.append(rows.rename(columns=new))
    runs = parts[0].merge(parts[1], on=keys)
    shown = (runs["starts"] == "quiet") & np.isclose(runs["span_lt"], span_lt)
    runs = runs.loc[shown & runs[f"value_{LEFT}"].notna()]
    return runs.loc[runs["quiet_lt"].isin(runs["quiet_lt"].mode()[-1:])]


def where(runs: pd.DataFrame, conditions: Mapping[str, float]) -> pd.DataFrame:
    """Runs under these conditions."""
    matching = np.ones(len(runs), dtype=bool)
    for name, value in conditions.items():
        matching &= np.isclose(runs[name].astype(np.float64), value)
    return runs.loc[matching]


def tried_under(runs: pd.DataFrame, conditions: Mapping[str, float], column: str) -> pd.DataFrame:
    """Runs with several values of one condition and usual values of all others."""
    runs = where(runs, {name: value for name, value in conditions.items() if name != column})
    who = ["forecaster", "strategy", *_settings(runs)]
    groups = [rows for _, rows in runs.groupby(who, dropna=False) if rows[column].nunique() > 1]
    return pd.concat(groups) if groups else runs.iloc[:0]


def with_kinds(runs: pd.DataFrame, *, along: bool) -> pd.DataFrame:
    """Runs in the order of the legend, each with its strategy and settings in words.

    These are the settings that tell runs of that strategy apart; also the one along which curves
    run, if that is wanted.
    """
    parts = []
    for name in looks.ordered_strategies(runs["strategy"]):
        look, own = looks.strategy(name), runs[runs["strategy"] == name]
        texts = {
            one: looks.SETTINGS.get(one, one.replace("_", " ") + " {}")
            for one in _settings(own)
            if own[one].nunique(dropna=False) > 1 and one != look.along
        }
        if along and look.along is not None:
            texts = {look.along: look.words, **texts}
        own = own.sort_values(list(texts)) if texts else own
        words = [
            [_words(one, row[one], text) for one, text in texts.items() if pd.notna(row[one])]
            for _, row in own.iterrows()
        ]
        kinds = [", ".join([look.title, *filter(None, said)]) for said in words]
        parts.append(own.assign(kind=kinds))
    named: pd.DataFrame = pd.concat(parts) if parts else runs.assign(kind="")
    return named


def _settings(runs: pd.DataFrame) -> list[str]:
    """Names of the settings that any strategy has."""
    return [name for name in runs.columns if name not in _NO_SETTINGS]


def _words(name: str, value: Any, text: str) -> str:
    if name == "options":
        return option_words(value)
    return text.format(value.replace("_", " ") if isinstance(value, str) else f"{value:g}")

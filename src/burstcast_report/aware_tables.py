"""Markdown tables of the campaign whose forecasters know the parameters, for docs/results.md."""

from dataclasses import dataclass
from typing import Any

import pandas as pd

from burstcast_report.control_tables import STRATEGY, chosen_runs, condition, strategy
from burstcast_report.results_tables import (
    SCORED,
    Tables,
    forecaster_in,
    markdown,
    percent_with_ends,
    significant,
    with_ends,
)

TRAINED = (400.0, 600.0, 1000.0)
"""Reynolds numbers that aware forecasters of the preset were trained on."""


def scores_by_reynolds(tables: Tables, time: float) -> str:
    """F-score of each forecaster at each Reynolds number; those not trained on are in bold."""
    found = _scores(tables).query("prediction_time_lt == @time")
    cases = _free_cases(found)
    rows = []
    for forecaster, part in found.groupby([*SCORED], dropna=False, sort=False):
        cells = {row["case"]: with_ends(row) for row in part.to_dict("records")}
        if not cells.keys().isdisjoint(cases.values()):
            rows.append([_name(forecaster), *(cells.get(case, "") for case in cases.values())])
    heads = [f"{value:g}" if value in TRAINED else f"**{value:g}**" for value in cases]
    return markdown(["Re", *heads], rows)


def escape_rates(tables: Tables) -> str:
    """Escapes per 1,000 time units from the turbulent state: of the true flow and of forecasts."""
    found = tables.rows("survival")
    cases = _free_cases(found)
    rows = []
    for forecaster, part in found.groupby([*SCORED], dropna=False, sort=False):
        cells = {}
        for row in part.to_dict("records"):
            ends = {end: row[f"escape_rate_{end}"] for end in ("low", "high")}
            cells[row["case"]] = with_ends(
                {"value": row["escape_rate"], **ends}, lambda rate: significant(1000 * rate, 2)
            )
        name = "true flow" if forecaster[0] == "data" else _name(forecaster)
        rows.append([name, *(cells.get(case, "") for case in cases.values())])
    return markdown(["Re", *(f"{value:g}" for value in cases)], rows)


def under_switching(tables: Tables) -> str:
    """F-scores where the actuator of the test series switches on and off."""
    found = _scores(tables)
    found = found[found["case"] == SWITCHED]
    times = sorted(time for time in found["prediction_time_lt"].unique() if time % 1 == 0)
    rows = []
    for forecaster, part in found.groupby([*SCORED], dropna=False, sort=False):
        cells = {row["prediction_time_lt"]: with_ends(row) for row in part.to_dict("records")}
        rows.append([_name(forecaster), *(cells.get(time, "") for time in times)])
    return markdown(["", *(f"{time:g} LT" for time in times)], rows)


SWITCHED = "Re400switched"


# -- targets ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Target:
    """Targets of control: remaining share of the exceedance, share of the time under actuation."""

    #: case, forecaster: case that is controlled, and forecaster that controls it
    case: str
    forecaster: str
    #: left, acting: largest share of the exceedance that may be left, and of the time under
    #: actuation
    left: float
    acting: float
    #: delay_lt, strength: delay and strength of the actuator
    delay_lt: float = 0.0
    strength: float = 1.0


TARGETS = (
    Target("Re400", "esn_aware", 0.006, 0.022, strength=0.25),
    Target("Re400", "esn_aware", 0.0, 0.02),
    Target("Re400large", "quadratic_aware_filtered", 0.001, 0.02),
    Target("Re400", "esn_aware", 0.006, 0.025, delay_lt=1),
    Target("Re800", "quadratic_aware_filtered", 0.01, 0.012, delay_lt=1),
    Target("Re800", "quadratic_aware_filtered_committee", 0.01, 0.012, delay_lt=1),
    Target("Re800", "esn_aware", 0.02, 0.035, delay_lt=1),
    Target("Re1000", "quadratic_aware_filtered", 0.015, 0.01, delay_lt=1),
    Target("Re1000", "quadratic_aware_filtered_committee", 0.015, 0.01, delay_lt=1),
)


def targets(tables: Tables) -> str:
    """Each target of control, what was reached on the scored flows, and whether that suffices."""
    rows = []
    for target in TARGETS:
        wanted = {
            **{"case": target.case, "forecaster": target.forecaster, "noise": 0.01},
            **{"delay_lt": target.delay_lt, "strength": target.strength},
        }
        for run in chosen_runs(tables, **wanted):
            left, acting = (
                run.scores[name] for name in ("relative_exceedance", "control_fraction")
            )
            met = left["value"] <= target.left and acting["value"] <= target.acting
            rows.append(
                [
                    f"{target.case}, {condition(run.keys)}",
                    *strategy(run.keys),
                    f"{100 * target.left:g} at {100 * target.acting:g}",
                    f"{percent_with_ends(left)} at {percent_with_ends(acting)}",
                    "yes" if met else "no",
                ]
            )
    head = ["case, condition", *STRATEGY, "to reach [%]", "reached [%]"]
    return markdown([*head, "met"], rows)


def forecast_targets(tables: Tables) -> str:
    """Differences of F-scores three Lyapunov times ahead that were to be .02 at most."""
    found = _scores(tables)
    found = found[found["prediction_time_lt"] == 3]
    value = {(row["case"], row["forecaster"]): row for row in found.to_dict("records")}
    pairs = [
        (f"Re{reynolds}", f"{kind}_aware", kind)
        for kind in ("esn", "quadratic")
        for reynolds in (500, 700, 800)
    ]
    pairs.append((SWITCHED, "quadratic_aware_filtered", "equations_filtered"))
    rows = []
    for case, forecaster, other in pairs:
        if (case, forecaster) not in value or (case, other) not in value:
            continue
        mine, theirs = value[case, forecaster], value[case, other]
        difference = mine["value"] - theirs["value"]
        rows.append(
            [
                case,
                forecaster_in(mine),
                with_ends(mine),
                with_ends(theirs),
                f"{difference:+.3f}",
                "yes" if difference >= -0.02 else "no",
            ]
        )
    head = ["case", "forecaster", "F 3 LT ahead", "to compare with", "difference"]
    return markdown([*head, "within .02"], rows)


# -- parts -----------------------------------------------------------------------------------------


def _name(forecaster: tuple[Any, ...]) -> str:
    return forecaster_in(dict(zip(SCORED, forecaster, strict=True)))


def _scores(tables: Tables) -> pd.DataFrame:
    """F-scores with their intervals, without the permanent alarm."""
    values = tables.rows("classification").rename(columns={"f_score": "value"})
    ends = tables.rows("classification_intervals", metric="f_score").drop(columns="metric")
    keys = [name for name in ends if name in values]
    found = values[[*keys, "value"]].merge(ends, on=keys, how="left")
    return found[found["forecaster"] != "permanent_alarm"]


def _free_cases(found: pd.DataFrame) -> dict[float, str]:
    """Cases that are called after their Reynolds number, by it."""
    cases = found[["case", "reynolds"]].drop_duplicates().dropna()
    named = cases[cases["case"] == cases["reynolds"].map("Re{:g}".format)]
    return dict(sorted(zip(named["reynolds"], named["case"], strict=True)))

"""Tables of finished campaigns, and their Markdown tables for docs/results.md."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from burstcast.control.setting_names import option_words
from burstcast.data.training_realisations import realisation_of
from burstcast.files.tables import read_table
from burstcast.tables.published import intervals_of_control, published_percentiles
from burstcast_workflow.project import project_root

PUBLISHED = project_root() / "resources" / "published_percentiles.csv"
"""Published values of the paper."""

OF_SINGLE_NETWORKS = (
    *("dataset", "hyperparameters", "classification", "classification_intervals"),
    *("horizon", "horizon_intervals", "statistics", "statistics_intervals", "survival"),
    *("kaplan_yorke", "lyapunov_spectrum", "control", "control_strategies"),
)
"""Kept tables with rows of their own for each network, whatever other networks there are."""

PUBLISHED_TABLES = (
    *OF_SINGLE_NETWORKS,
    *("warnings", "control_choices", "control_density", "control_differences"),
    *("training_realisations", "ranking"),
    *(
        f"{name}_percentiles"
        for name in (
            *("hyperparameters", "classification", "horizon", "statistics", "survival"),
            *("kaplan_yorke", "lyapunov_spectrum", "control"),
        )
    ),
)
"""Tables of a campaign that the repository keeps: a row for each network, and percentiles."""


@dataclass(frozen=True)
class Ensemble:
    """Quartiles over the networks of an ensemble, and the interval of one network."""

    #: p25, p50, p75: quartiles over networks; all the same for a forecaster without seeds
    p25: float
    p50: float
    p75: float
    #: low, high: medians over networks of the ends of each one's 95 % bootstrap interval over test
    #: series, events, runs or flows: what the test data leave open, which all networks share; the
    #: scatter over training sets is not in it. NaN if there is no such interval.
    low: float
    high: float
    networks: int

    @property
    def has_interval(self) -> bool:
        """Whether the tables have an interval for it."""
        return bool(np.isfinite(self.low))


class Tables:
    """The tables of one campaign, by name; empty where there is none."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._read = cache(self._from_file)

    def __bool__(self) -> bool:
        """Whether there are any."""
        return any(self.directory.glob("*.csv"))

    def _from_file(self, name: str) -> pd.DataFrame:
        if name == "control_intervals":
            both = self._read("control_strategies"), self._read("control")
            return pd.DataFrame() if any(one.empty for one in both) else intervals_of_control(*both)
        path = self.directory / f"{name}.csv"
        return read_table(path) if path.exists() and path.stat().st_size else pd.DataFrame()

    def rows(self, name: str, **where: Any) -> pd.DataFrame:
        """Rows of a table whose columns have these values."""
        table = self._read(name)
        for column, value in where.items():
            if column not in table:
                return table.iloc[:0]
            cells = table[column]
            table = table[cells.isna() if value is None else cells == value]
        return table

    def number(self, name: str, column: str, **where: Any) -> float:
        """The one number in a column of those rows."""
        rows = self.rows(name, **where)
        if len(rows) != 1:
            raise LookupError(f"{self.directory}/{name}: {len(rows)} rows with {where}, not one")
        return float(rows[column].iloc[0])

    def ensemble(self, table: str, metric: str, **where: Any) -> Ensemble | None:
        """An ensemble's quartiles and interval of a metric; None if there are none."""
        rows = self.rows(f"{table}_percentiles", metric=metric, **where)
        if len(rows) != 1 or rows["p50"].isna().any():
            return None
        ends = self.rows(f"{table}_intervals", metric=metric, **where)
        low, high = (
            (float(ends[end].median()) for end in ("low", "high"))
            if len(ends)
            else (np.nan, np.nan)
        )
        row = rows.iloc[0]
        return Ensemble(row["p25"], row["p50"], row["p75"], low, high, int(row["networks"]))

    def sizes(self, case: str) -> list[int]:
        """Numbers of neurons of a case's networks, ascending."""
        found = self.rows("horizon_percentiles", case=case, forecaster="esn")
        return sorted(int(size) for size in found["neurons"].unique()) if len(found) else []

    def cases(self) -> list[str]:
        """The campaign's cases, in its order."""
        return [str(case) for case in self.rows("dataset")["case"]]


@cache
def _published(table: str) -> pd.DataFrame:
    return published_percentiles(read_table(PUBLISHED), table)


def published_rows(table: str, metric: str, **where: Any) -> pd.DataFrame:
    """Percentiles that the paper published, in our definitions."""
    rows = _published(table)
    for column, value in {"metric": metric, **where}.items():
        rows = rows[rows[column] == value]
    return rows


def published_value(table: str, metric: str, **where: Any) -> float:
    """A median that the paper published, in our definitions."""
    rows = published_rows(table, metric, **where)
    if len(rows) != 1:
        raise LookupError(f"{len(rows)} published rows of {table}, {metric}, {where}")
    return float(rows["p50"].iloc[0])


# -- numbers as text -------------------------------------------------------------------------------


def fixed(value: float | None, digits: int = 3) -> str:
    """A number with that many decimals; "" for none."""
    return "" if value is None or np.isnan(value) else f"{value:.{digits}f}"


def significant(value: float | None, digits: int = 3) -> str:
    """A number with that many significant digits; "" for none."""
    return "" if value is None or np.isnan(value) else f"{value:.{digits}g}"


def quartiles(found: Ensemble | None, text: Callable[[float], str] = fixed) -> str:
    """Median, and quartiles in parentheses where there are several networks."""
    if found is None:
        return ""
    middle = text(found.p50)
    if found.networks < 2:
        return middle
    return f"{middle} ({text(found.p25)} to {text(found.p75)})"


def interval(found: Ensemble | None, text: Callable[[float], str] = fixed) -> str:
    """Median, and the interval of one network in parentheses."""
    if found is None:
        return ""
    if not found.has_interval:
        return text(found.p50)
    return f"{text(found.p50)} ({text(found.low)} to {text(found.high)})"


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def name_of(forecaster: str, neurons: float | None = None, validation: str | None = None) -> str:
    """A forecaster, an alarm or a committee as people call it."""
    names = {
        "equations": "equations, from the true state",
        "equations_noisy": "equations, from the noisy state",
        "equations_filtered": "equations, filtered",
        "quadratic": "learnt equations, from the noisy state",
        "quadratic_filtered": "learnt equations, filtered",
        "quadratic_aware": "parameter-aware learnt equations, from the noisy state",
        "quadratic_aware_filtered": "parameter-aware learnt equations, filtered",
        "linear_inverse": "linear inverse model",
        "analogues": "nearest analogues, mean",
        "climatology": "climatology: the base rate",
        "observable_now": "threshold on k now",
    }
    kind = forecaster.removesuffix("_committee")
    network = neurons is not None
    name = f"{neurons:g} neurons, {validation}" if network else names.get(kind, kind)
    if network and kind != "esn":
        name = f"{kind.removeprefix('esn_')} network, {name}"
    if kind == forecaster:
        return name.replace("_", " ")
    return f"committee of the networks: {name}" if network else f"members of {name}"


SCORED = ("forecaster", "neurons", "validation")
"""Columns that name a forecaster, whatever its seed."""


def forecaster_in(row: Mapping[Any, Any]) -> str:
    """The forecaster of a row, as people call it."""
    return name_of(**{key: row[key] for key in SCORED if pd.notna(row[key])})


# -- tables of the page ----------------------------------------------------------------------------

TIMES_LT = (1.0, 2.0, 3.0, 4.0, 5.0)
"""Prediction times that tables show, as far as the campaign has them."""

VALIDATIONS = ("SSV", "RV")


def datasets(tables: Tables) -> str:
    """Series that were kept, and leading Lyapunov exponents beside the published ones."""
    rows = []
    for row in tables.rows("dataset").to_dict("records"):
        ours, theirs = row["lyapunov_exponent"], row["lyapunov_exponent_paper"]
        low, high = row["lyapunov_exponent_low"], row["lyapunov_exponent_high"]
        growth = [row[f"lyapunov_exponent_by_growth{end}"] for end in ("", "_low", "_high")]
        rows.append(
            [
                f"{row['reynolds']:g}",
                f"{row['series_kept']} of {row['series_generated']}",
                fixed(row["mean_observable"], 4),
                fixed(row["events_per_series"], 2),
                fixed(theirs, 4),
                f"{fixed(ours, 4)} ({fixed(low, 4)} to {fixed(high, 4)})",
                "{} ({} to {})".format(*(fixed(value, 4) for value in growth)),
                f"{100 * (ours / theirs - 1):+.0f} %",
            ]
        )
    head = ["Re", "series kept", "mean k", "events per series", "exponent, paper"]
    return markdown([*head, "ours, by QR", "ours, by growth", "difference"], rows)


def scores_by_size(tables: Tables, case: str, metric: str) -> str:
    """Quartiles of a score of each ensemble against prediction time; the equations below."""
    groups: list[dict[str, Any]] = [
        {"forecaster": "esn", "neurons": size, "validation": validation}
        for size in tables.sizes(case)
        for validation in VALIDATIONS
    ]
    return _scores(tables, case, metric, [*groups, {"forecaster": "equations_noisy"}])


def scores_of_forecasters(tables: Tables, case: str, metric: str) -> str:
    """Rows of all forecasters of a case, the best first."""
    found = tables.rows("horizon_percentiles", case=case, metric="mean_horizon_lt")
    groups = _groups(found.sort_values("p50", ascending=False))
    return _scores(tables, case, metric, groups)


def _scores(tables: Tables, case: str, metric: str, groups: Sequence[dict[str, Any]]) -> str:
    with_horizon = metric == "f_score"  # it stands beside one of the scores
    rows = [
        [name_of(**group), *scores, *([_horizon_cell(tables, case, group)] if with_horizon else [])]
        for group in groups
        if any(scores := _score_cells(tables, case, metric, group))
    ]
    times = [f"{time:g} LT" for time in TIMES_LT]
    return markdown(["", *times, *(["mean PH_ee [LT]"] if with_horizon else [])], rows)


def _score_cells(tables: Tables, case: str, metric: str, group: dict[str, Any]) -> list[str]:
    """Quartiles of a score at each prediction time."""
    scores = (
        tables.ensemble("classification", metric, case=case, prediction_time_lt=time, **group)
        for time in TIMES_LT
    )
    return list(map(quartiles, scores))


def _horizon_cell(tables: Tables, case: str, group: dict[str, Any]) -> str:
    """Quartiles of the mean prediction horizon."""
    horizon = tables.ensemble("horizon", "mean_horizon_lt", case=case, **group)
    return quartiles(horizon, lambda value: fixed(value, 2))


def horizons_by_size(tables: Tables, case: str) -> str:
    """Mean prediction horizons by size and validation, with the interval over events."""
    rows = []
    for size in tables.sizes(case):
        row = [str(size)]
        for validation in VALIDATIONS:
            group = {"case": case, "forecaster": "esn", "neurons": size, "validation": validation}
            found = tables.ensemble("horizon", "mean_horizon_lt", **group)
            two = quartiles(found, lambda value: fixed(value, 2))
            ends = "" if found is None else f"{fixed(found.low, 2)} to {fixed(found.high, 2)}"
            row += [two, ends]
        rows.append(row)
    head = ["neurons", "SSV", "95 % of one network, over events", "RV", "95 % of one network"]
    return markdown(head, rows)


def scores_by_reynolds(tables: Tables, neurons: int) -> str:
    """F-scores and prediction horizons of networks of one size, by case."""
    rows = []
    for row in tables.rows("dataset").to_dict("records"):
        for validation in VALIDATIONS:
            group = {"forecaster": "esn", "neurons": neurons, "validation": validation}
            scores = _score_cells(tables, row["case"], "f_score", group)
            cells = [*scores, _horizon_cell(tables, row["case"], group)]
            if any(cells):
                rows.append([f"{row['reynolds']:g}", validation, *cells])
    times = [f"F, {time:g} LT" for time in TIMES_LT]
    return markdown(["Re", "", *times, "mean PH_ee [LT]"], rows)


STATISTICS = {
    "kantorovich": "Kantorovich metric",
    "mean_log_error": "mean logarithmic error",
    "nrmse_u": "NRMSE u",
    "nrmse_uu": "NRMSE u^2",
    "nrmse_uv": "NRMSE uv",
    "discarded_fraction": "discarded",
}


def long_term(tables: Tables, case: str) -> str:
    """Errors of long-term statistics: every ensemble, the training set, halves of the data."""
    groups = _groups(tables.rows("statistics_percentiles", case=case))
    rows = []
    for group in groups:
        cells = [
            quartiles(tables.ensemble("statistics", metric, case=case, **group), significant)
            for metric in STATISTICS
        ]
        names = {"training": "training set", "floor": "halves of the data: the floor"}
        rows.append([names.get(group["forecaster"], name_of(**group)), *cells])
    return markdown(["", *STATISTICS.values()], rows)


def own_flow(tables: Tables, case: str, leading: int = 4) -> str:
    """Escape rate, Kaplan-Yorke dimension and leading Lyapunov exponents of each one's own flow."""
    rows = []
    for group in _groups(tables.rows("survival_percentiles", case=case)):
        where = {"case": case, **group}
        escape = tables.ensemble("survival", "escape_rate", **where)
        dimension = tables.ensemble("kaplan_yorke", "kaplan_yorke_dimension", **where)
        exponents = [
            tables.ensemble("lyapunov_spectrum", "lyapunov_exponent", number=number, **where)
            for number in range(1, leading + 1)
        ]
        rows.append(
            [
                "the flow" if group["forecaster"] == "data" else name_of(**group),
                quartiles(escape, lambda value: fixed(1e4 * value, 2)),
                quartiles(dimension, lambda value: fixed(value, 2)),
                *(quartiles(found, lambda value: fixed(value, 4)) for found in exponents),
            ]
        )
    head = ["", "escape rate [1e-4 per time unit]", "Kaplan-Yorke dimension"]
    return markdown([*head, *(f"exponent {n}" for n in range(1, leading + 1))], rows)


def _groups(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Forecasters with rows in a table, as its cells name them, in its order."""
    keys = ["forecaster", "neurons", "validation"]
    found = table.reindex(columns=keys).drop_duplicates()
    return [
        {key: row[key] for key in keys if pd.notna(row[key])} for row in found.to_dict("records")
    ]


def control_of_the_paper(tables: Tables) -> str:
    """Exceedance with and without control, by Reynolds number and prediction time."""
    rows = []
    for case in tables.rows("dataset").to_dict("records"):
        found = tables.rows("control_percentiles", case=case["case"], forecaster="esn")
        if found.empty:
            continue
        for time in sorted(found["prediction_time_lt"].unique()):
            where = {"case": case["case"], "prediction_time_lt": time}
            esn = {**where, "forecaster": "esn"}
            networks = tables.ensemble("control", "exceedance_controlled", **esn)
            if networks is None:
                continue
            rows.append(
                [
                    f"{case['reynolds']:g}",
                    f"{time:g}",
                    quartiles(tables.ensemble("control", "exceedance_uncontrolled", **esn), _k),
                    quartiles(networks, _k),
                    f"{_k(networks.low)} to {_k(networks.high)}",
                    *(
                        quartiles(tables.ensemble("control", "exceedance_controlled", **keys), _k)
                        for keys in (
                            {**where, "forecaster": "equations"},
                            {**where, "forecaster": "random"},
                        )
                    ),
                    quartiles(tables.ensemble("control", "control_fraction", **esn), _k),
                ]
            )
    head = ["Re", "prediction time [LT]", "without control", "networks", "95 % over flows"]
    return markdown([*head, "equations", "random alarms", "share of time under actuation"], rows)


def control_by_forecaster(tables: Tables, case: str) -> str:
    """The paper's control by all forecasters: exceedance and share of time under actuation."""
    rows = []
    for time in sorted(tables.rows("control", case=case)["prediction_time_lt"].unique()):
        found = tables.rows("control_percentiles", case=case, prediction_time_lt=time)
        for group in _groups(found[found["forecaster"] != "random"]):
            where = {"case": case, "prediction_time_lt": time, **group}
            metrics = ("exceedance_uncontrolled", "exceedance_controlled", "control_fraction")
            cells = [quartiles(tables.ensemble("control", name, **where), _k) for name in metrics]
            rows.append([f"{time:g}", name_of(**group), *cells])
    head = ["prediction time [LT]", "forecaster", "without control", "with"]
    return markdown([*head, "share of time under actuation"], rows)


def _k(value: float) -> str:
    return fixed(value, 4)


def strategies(
    tables: Tables, case: str, *, laminarisations: bool = False, **conditions: Any
) -> str:
    """Remaining exceedance of control strategies against their cost, under one set of conditions.

    ``laminarisations``: Whether to say how often flows become laminar, with control and without.
    ``conditions``: Columns of `control_strategies` and their values; the others have all that there
    are.
    """
    found = tables.rows("control_strategies", case=case, **conditions)
    if found.empty:
        return ""
    found = with_telling_seeds(found[found["forecaster"] != "random"])
    settings = [name for name in map(str, found) if name not in _NO_SETTINGS]
    rows = []
    for _, part in found.groupby(settings, dropna=False, sort=False):
        setting = dict(zip(settings, part[settings].to_numpy()[0], strict=True))
        values = {row["metric"]: row for row in part.to_dict("records")}
        row = [
            strategy_in_words(setting, conditions),
            controller_in(setting),
            percent_with_ends(values["relative_exceedance"]),
            percent_with_ends(values["control_fraction"]),
            fixed(values["switchings_per_lyapunov_time"]["value"]),
        ]
        if laminarisations:
            row += [with_ends(values[name], _in_ten_thousand) for name in _HAZARDS]
        rows.append(row)
    head = ["strategy", "forecaster", "left [%]", "time under actuation [%]", "switched on per LT"]
    if laminarisations:
        head += ["laminarisations [1e-4 / LT]", "without control"]
    return markdown(head, rows)


_HAZARDS = ("laminarisation_hazard_controlled", "laminarisation_hazard_uncontrolled")

_NO_SETTINGS = (
    *("case", "reynolds", "metric", "value", "low", "high"),
    *("candidates", "scored_flows"),
)
_USUAL = {"delay_lt": 0, "strength": 1, "noise": 0.01, "span_lt": 20, "starts": "quiet"}
_TOLD_ELSEWHERE = (
    *("strategy", "forecaster", "neurons", "validation", "seed"),
    *("quiet_lt", "window_lt"),
)


def strategy_in_words(keys: Mapping[str, Any], told: Iterable[str] = ()) -> str:
    """Strategy and settings of a run of control, without the usual ones.

    ``keys``: Columns of the run that are not results, and their values.
    """
    left_out = {*_NO_SETTINGS, *_TOLD_ELSEWHERE, *told}
    parts = [
        _words(name, value)
        for name, value in keys.items()
        if name not in left_out and pd.notna(value) and value != _USUAL.get(name)
    ]
    return ", ".join([str(keys["strategy"]).replace("_", " "), *parts])


def _words(name: str, value: Any) -> str:
    text = name.removesuffix("_lt").replace("_", " ")
    if name == "options":
        return option_words(value)
    if isinstance(value, str):
        return f"{text} {value.replace('_', ' ')}"
    return f"{text} {value:g}" + (" LT" if name.endswith("_lt") else "")


def controller_in(keys: Mapping[str, Any]) -> str:
    """Forecaster of a run of control, with its seed if the run has one; "" for none."""
    if keys["forecaster"] == "none":
        return ""
    seed = keys.get("seed")
    return forecaster_in(keys) + ("" if pd.isna(seed) else f", seed {seed:g}")


def with_telling_seeds(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs of control whose seeds are left empty where a forecaster has only one."""
    if "seed" not in runs:
        return runs
    seeds = runs.groupby([*SCORED], dropna=False)["seed"].transform("nunique")
    return runs.assign(seed=runs["seed"].where(seeds > 1))


def percent_with_ends(row: dict[Any, Any]) -> str:
    """A share in per cent, with the ends of its interval."""
    return with_ends(row, lambda share: _two_digits(100 * share))


def _in_ten_thousand(value: float) -> str:
    return _two_digits(1e4 * value)


def _two_digits(value: float) -> str:
    """Two significant digits, and all of those before the point."""
    return f"{value:.0f}" if abs(value) >= 10 else f"{value:.2g}"


def forecasters_apart(tables: Tables, case: str) -> str:
    """Forecasters that control differently by the same strategy, on the same flows.

    Differences of what is left whose paired 95 % interval excludes zero; a line above the table
    says how many there were to look at.
    """
    found = tables.rows("control_differences", case=case)
    found = found[
        (found["strategy"] == found["other_strategy"])
        & ~found["compared"].str.contains("random-")
        & ~found["other"].str.contains("random-")
    ]
    rows, pairs = [], 0
    for (strategy, forecaster, other), part in found.groupby(
        ["strategy", "compared", "other"], sort=False
    ):
        pairs += 1
        values = {row["metric"]: row for row in part.to_dict("records")}
        left = values["relative_exceedance"]
        if left["low"] <= 0 <= left["high"]:
            continue
        spent = values["control_fraction"]
        rows.append(
            [
                f"`{strategy}`",
                str(forecaster),
                str(other),
                percent_with_ends(left),
                percent_with_ends(spent),
            ]
        )
    head = ["strategy", "forecaster", "minus", "difference of what is left [%]"]
    table = markdown([*head, "of the time under actuation [%]"], rows)
    return f"{len(rows)} of {pairs} pairs:\n\n{table}"


def probabilities(tables: Tables, case: str, metric: str) -> str:
    """A score of calibrated probabilities: of committees, and of all but single networks."""
    found = tables.rows(
        "probability_scores", case=case, probability="calibrated", metric=metric, seed=None
    )
    rows = []
    for group in _groups(found):
        cells = found
        for column, value in group.items():
            cells = cells[cells[column] == value]
        values = {row["prediction_time_lt"]: row for row in cells.to_dict("records")}
        rows.append([name_of(**group), *(with_ends(values.get(time)) for time in TIMES_LT)])
    return markdown(["", *(f"{time:g} LT" for time in TIMES_LT)], rows)


def with_ends(row: dict[Any, Any] | None, text: Callable[[float], str] = fixed) -> str:
    """A value as text, with the ends of its interval in parentheses; "" for None."""
    if row is None:
        return ""
    ends = "" if np.isnan(row["low"]) else f" ({text(row['low'])} to {text(row['high'])})"
    return text(row["value"]) + ends


def sweep(tables: Tables, metric: str = "f_score") -> str:
    """A score at all prediction times, one row for each case, one column for each forecaster."""
    groups = _groups(tables.rows("classification_percentiles", metric=metric))
    rows = [
        [
            case.replace("_", " "),
            *(
                " ".join(
                    fixed(None if found is None else found.p50, 2).replace("0.", ".")
                    for time in TIMES_LT
                    for found in [
                        tables.ensemble(
                            "classification", metric, case=case, prediction_time_lt=time, **group
                        )
                    ]
                )
                for group in groups
            ),
        ]
        for case in tables.cases()
    ]
    return markdown(["", *(name_of(**group) for group in groups)], rows)


def choices_compared(best: Tables, other: Tables, case: str) -> str:
    """Networks whose hyperparameters were chosen in two ways: medians, extremes, lower counts.

    ``best``, ``other``: Campaigns that share the case and have networks of the same sizes and
    seeds.
    """
    both = [_by_network(tables, case) for tables in (best, other)]
    shared = both[0].index.intersection(both[1].index)
    first, second = (table.loc[shared] for table in both)
    rows = []
    for neurons in sorted(set(shared.get_level_values("neurons"))):
        one, two = first.loc[neurons], second.loc[neurons]
        changed = (one["objective"] != two["objective"]).to_numpy()
        for name, (title, unit, digits) in _COMPARED.items():
            a, b = unit * one[name].to_numpy(), unit * two[name].to_numpy()
            rows.append(
                [
                    f"{neurons:g}",
                    title,
                    *(
                        f"{fixed(np.median(x), digits)} "
                        f"({fixed(x.min(), digits)} to {fixed(x.max(), digits)})"
                        for x in (a, b)
                    ),
                    f"{(b < a)[changed].sum()} of {changed.sum()}",
                ]
            )
    head = ["neurons", "", "by the objective alone", "by survival"]
    return markdown([*head, "lower, of the changed"], rows)


_COMPARED = {
    "escape_rate": ("escape rate [1e-4 per time unit]", 1e4, 2),
    "discarded_fraction": ("discarded share of the long runs", 1, 3),
    "kantorovich": ("Kantorovich metric [1e-3]", 1e3, 2),
    "mean_log_error": ("mean logarithmic error", 1, 3),
    "nrmse_u": ("NRMSE of u", 1, 4),
    **{f"{time} LT": (f"F-score, {time} LT ahead", 1, 3) for time in (1, 2, 3, 4)},
    "mean_horizon_lt": ("mean PH_ee [LT]", 1, 2),
}


def _by_network(tables: Tables, case: str) -> pd.DataFrame:
    """All that `choices_compared` shows, a row for each network: by neurons and seed."""
    keys = ["neurons", "seed"]
    names = ("hyperparameters", "survival", "statistics", "horizon")
    found = [tables.rows(name, case=case, forecaster="esn").set_index(keys) for name in names]
    scores = tables.rows("classification", case=case, forecaster="esn")
    for time in (1, 2, 3, 4):
        ahead = scores[scores["prediction_time_lt"] == time].set_index(keys)["f_score"]
        found.append(ahead.rename(f"{time} LT").to_frame())
    wanted = ["objective", *_COMPARED]
    return pd.concat([table[[n for n in wanted if n in table]] for table in found], axis=1)


def scatter(tables: Tables, case: str) -> str:
    """Means of scores, and their scatter over training sets, seeds and test data.

    The last is the standard error of one network: half of its 95 % interval over test series,
    events or runs, divided by 1.96, in the median over networks and training sets.
    """
    found = tables.rows("training_realisations", case=case)
    rows = []
    for row in found.to_dict("records"):
        time = row["prediction_time_lt"]
        if row["metric"] not in _SCATTERED or not (pd.isna(time) or time in TIMES_LT):
            continue
        title, unit, digits, intervals = _SCATTERED[row["metric"]]
        ahead = "" if pd.isna(time) else f", {time:g} LT ahead"
        values = [unit * row[name] for name in _SCATTER]
        forecaster = {key: row[key] for key in ("forecaster", "neurons", "validation")}
        where = {k: v for k, v in forecaster.items() if pd.notna(v)} | {"metric": row["metric"]}
        if intervals:
            ends = tables.rows(intervals, **where, **({} if pd.isna(time) else {_TIME: time}))
            ends = ends[[realisation_of(name)[0] == case for name in ends["case"]]]
            values.append(unit * float((ends["high"] - ends["low"]).median()) / (2 * 1.96))
        else:
            values.append(np.nan)
        texts = (fixed(value, digits) for value in values)
        rows.append([name_of(**forecaster), f"{title}{ahead}", *texts])
    return markdown(["", "", "mean", "over training sets", "over seeds", "over test data"], rows)


def own_training_set(tables: Tables, case: str) -> str:
    """Whether a case's own training set is the best or the worst of all that were chosen.

    A line for each forecaster, about F-scores; networks of a training set by their means.
    """
    found = tables.rows("classification").dropna(subset="f_score")
    found = found[[realisation_of(name)[0] == case for name in found["case"]]]
    sentences = []
    keys = ["forecaster", "neurons", "validation"]
    shown = found[found[_TIME].isin(TIMES_LT)]
    for (kind, *_), rows in shown.groupby(keys, sort=False, dropna=False):
        highest, lowest, sets = [], [], rows["case"].nunique()
        for time, of_time in rows.groupby(_TIME):
            scores = of_time.groupby("case")["f_score"].mean()
            own, others = scores[case], scores.drop(index=case)
            highest += [f"{time:g}"] if own > others.max() else []
            lowest += [f"{time:g}"] if own < others.min() else []
        told = [
            f"the {word} of {sets} F-scores {', '.join(times)} LT ahead"
            for word, times in (("highest", highest), ("lowest", lowest))
            if times
        ]
        told = told or [f"neither the highest nor the lowest of {sets} F-scores"]
        neurons, validation = (rows[key].dropna().unique() for key in keys[1:])
        name = name_of(str(kind), *neurons[:1], *validation[:1])
        sentences.append(f"* {name}: {' and '.join(told)}.")
    return "\n".join(sentences)


_TIME = "prediction_time_lt"
_SCATTER = ("mean", "standard_deviation_over_training_sets", "standard_deviation_over_seeds")
_SCATTERED = {
    "f_score": ("F-score", 1, 3, "classification_intervals"),
    "mean_horizon_lt": (*_COMPARED["mean_horizon_lt"], "horizon_intervals"),
    "kantorovich": (*_COMPARED["kantorovich"], "statistics_intervals"),
    "mean_log_error": (*_COMPARED["mean_log_error"], "statistics_intervals"),
    "escape_rate": (*_COMPARED["escape_rate"], ""),
}


def costs(tables: Tables) -> str:
    """Times of the jobs of each rule beside the prediction, the most expensive first."""
    found = tables.rows("rule_costs").sort_values("minutes", ascending=False)
    shown = found[found["minutes"] >= 1.0]
    rest = found[~(found["minutes"] >= 1.0)]
    rows = [_cost(row["rule"], row) for row in shown.to_dict("records")]
    sums = ["jobs", "predicted_minutes", "minutes", "disk_mib"]
    for name, part in ((f"{len(rest)} other rules", rest), ("**all**", found)):
        row = {**part[sums].sum().to_dict(), "memory_mib": part["memory_mib"].max()}
        rows.append(_cost(name, row))
    head = ["rule", "jobs", "predicted [min]", "took [min]", "largest memory [MiB]", "disk [MiB]"]
    return markdown(head, rows)


def _cost(name: str, row: dict[Any, Any]) -> list[str]:
    return [
        name,
        f"{row['jobs']:.0f}",
        fixed(row["predicted_minutes"], 1),
        fixed(row["minutes"], 1),
        fixed(row["memory_mib"], 0),
        fixed(row["disk_mib"], 0),
    ]

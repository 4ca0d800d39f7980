"""Comparisons on pages of results that take more than one row of a table."""

import operator
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
from kept_tables import PUBLISHED, Part, Tables, part, published_rows, published_value
from scipy.stats import t as student

from burstcast.base.files.tables import read_table
from burstcast.base.resampling import mean_with_interval
from burstcast.data.training_realisations import realisation_of
from burstcast.figures.parts.published import compare
from burstcast.figures.parts.ranked import SAME_EVERYWHERE, shown_once

CASE = "Re400"
CONFIDENCE = 0.95
TRUE = "esn_true_washout"

# -- published values ------------------------------------------------------------------------------

_HIGHER_IS_BETTER = ("precision", "recall", "f_score", "mean_horizon_lt")


def beside_published(tables: Tables) -> pd.DataFrame:
    """Our value beside each published one, and a ``group`` of both: `tables.published.compare`."""
    names = ("classification", "horizon", "hyperparameters", "statistics", "control")
    both = (
        {name: rows for name in names if len(rows := tables.rows(f"{name}_{ending}"))}
        for ending in ("percentiles", "intervals")
    )
    compared = compare(read_table(PUBLISHED), *both)
    time, small = compared["prediction_time_lt"], compared["neurons"] < 1000
    ahead = np.where(time == time.min(), "0.5 LT", np.where(time == time.max(), "5 LT", "between"))
    scores = np.where(small, "scores below 1000 neurons", "scores from 1000 neurons, " + ahead)
    kind = compared["kind"]
    return compared.assign(group=kind.where(kind != "classification", scores))


def sides(compared: pd.DataFrame) -> pd.DataFrame:
    """Counts by group: values, ours inside, better, better and outside, worse and outside.

    Objectives, errors and the exceedance under control are better where they are smaller;
    hyperparameters are no better anywhere.
    """
    decided = compared[compared["inside"].notna()]
    higher_is_better = decided["metric"].isin(_HIGHER_IS_BETTER)
    better = (decided["p50"] > decided["published_p50"]) == higher_is_better
    inside = decided["inside"].astype(bool)
    chosen = decided["metric"].isin(["spectral_radius", "tikhonov"])
    counts = pd.DataFrame(
        {
            "values": True,
            "inside": inside,
            "better": better & ~chosen,
            "better_outside": better & ~inside & ~chosen,
            "worse_outside": ~better & ~inside & ~chosen,
        }
    )
    sums = counts.groupby(decided["group"], sort=False).sum()
    return pd.concat([sums, sums.sum().rename("all").to_frame().T]).rename_axis("group")


# -- training sets ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Score:
    """A score of networks: its column in a kept table, and how many digits it is shown with."""

    title: str
    table: str
    metric: str
    digits: int = 3
    where: tuple[tuple[str, float], ...] = ()

    def networks(self, tables: Tables, drawn: bool = True, **where: Any) -> pd.DataFrame:
        """Values of networks: rows are training sets (the drawn ones), columns are seeds."""
        rows = tables.rows(self.table, **{"forecaster": "esn", **dict(self.where), **where})
        if rows.empty or self.metric not in rows:
            return pd.DataFrame()
        rows = rows[[(realisation_of(name)[1] > 0) or not drawn for name in rows["case"]]]
        return rows.pivot_table(self.metric, "case", "seed")

    def median(self, tables: Tables, **where: Any) -> float:
        """Median over all networks; NaN for none."""
        values = self.networks(tables, False, **where).to_numpy().ravel()
        defined = values[~np.isnan(values)]
        return float(np.median(defined)) if len(defined) else float("nan")

    def error(self, tables: Tables, **where: Any) -> float:
        """Standard error of one network over the test data, from its interval; 0 for none."""
        where = {"forecaster": "esn", "metric": self.metric, **dict(self.where), **where}
        ends = tables.rows(f"{self.table}_intervals", **where)
        return float((ends["high"] - ends["low"]).median()) / (2 * 1.96) if len(ends) else 0.0

    def published(self, **network: Any) -> float:
        """The published median at Re = 400; NaN if there is none."""
        return published_value(self.table, self.metric, reynolds=400, **dict(self.where), **network)


def f_score(time: float) -> Score:
    """The F-score so many Lyapunov times ahead."""
    where = (("prediction_time_lt", time),)
    return Score(f"F-score, {time:g} LT ahead", "classification", "f_score", 3, where)


HORIZON = Score("mean PH_ee [LT]", "horizon", "mean_horizon_lt", 2)
SCORES = (f_score(2.0), f_score(3.0), HORIZON)


def all_published(**network: Any) -> Iterator[Score]:
    """All that is published of a size and strategy and that campaigns of networks have."""
    for metric in ("precision", "recall", "f_score"):
        rows = published_rows("classification", metric, reynolds=400, **network)
        for time in rows["prediction_time_lt"]:
            where = (("prediction_time_lt", float(time)),)
            yield Score(metric, "classification", metric, 3, where)
    yield HORIZON


def networks_of(tables: Tables) -> list[dict[str, Any]]:
    """Sizes and strategies of the networks of a campaign, as conditions of rows."""
    rows = tables.rows("classification", forecaster="esn")
    if rows.empty:
        return []
    keys = ["neurons", "validation"]
    networks = rows[keys].drop_duplicates().sort_values(keys)
    return [{str(key): value for key, value in row.items()} for row in networks.to_dict("records")]


def half_interval(of_sets: Any, of_test: Any, sets: Any) -> Any:
    """Half of an interval from the variances over training sets and over test series.

    Degrees of freedom of the sum of both are Welch and Satterthwaite's.
    """
    degrees = (of_sets + of_test) ** 2 / (of_sets**2 / (sets - 1))
    return student.ppf((1 + CONFIDENCE) / 2, degrees) * np.sqrt(of_sets + of_test)


@cache
def inside_counts(authors: Tables, paper: Tables, neurons: int | None = None) -> dict[str, int]:
    """Published values inside intervals around the paper's campaign, and the authors' choices.

    ``neurons``: Size of the networks; default: all.

    Both by one rule. ``narrow``: 1.96 standard errors of one network over the test series.
    ``wide``: what a further training set and two choices of the test series give, ours and the
    authors'.
    """
    counts = dict.fromkeys(("values", "narrow", "narrow_authors", "wide", "wide_authors"), 0)
    networks = networks_of(authors)
    for network in networks:
        if neurons not in (None, network["neurons"]):
            continue
        for score in all_published(**network):
            values = score.networks(authors, **network).mean(axis=1)
            median = score.median(paper, case=CASE, **network)
            published, error = score.published(**network), score.error(paper, case=CASE, **network)
            if np.isnan([published, median, *values]).any():
                continue
            of_sets, of_test = values.var(ddof=1) * (1 + 1 / len(values)), 2 * error**2
            wide = half_interval(of_sets, of_test, len(values))
            narrow = {"narrow": 1.96 * error}
            narrow["narrow_authors"] = 1.96 * score.error(authors, **network)
            counts["values"] += 1
            for name, margin in {**narrow, "wide": wide, "wide_authors": wide}.items():
                centre = float(values.mean()) if name.endswith("authors") else median
                counts[name] += int(abs(published - centre) <= margin)
    return counts


@dataclass(frozen=True)
class Mean:
    """Mean with its 95 % interval, and how many independent values it is of."""

    mean: float
    margin: float  #: half of the interval; NaN of fewer than two values
    count: int

    @property
    def low(self) -> float:
        """Lower end."""
        return self.mean - self.margin

    @property
    def high(self) -> float:
        """Upper end."""
        return self.mean + self.margin

    def text(self, digits: int, sign: str = "+") -> str:
        """Mean and margin."""
        return f"{self.mean:{sign}.{digits}f} ± {self.margin:.{digits}f}"


def mean_of(values: Sequence[float]) -> Mean:
    """Mean of independent values, with Student's interval."""
    if len(values) < 2:
        return Mean(float(np.mean(values)), float("nan"), len(values))
    interval = mean_with_interval(np.array(values), CONFIDENCE)
    return Mean(float(interval.mean), float(interval.high - interval.mean), len(values))


def common(*networks: pd.DataFrame) -> list[pd.DataFrame]:
    """Values of the training sets (rows) and seeds (columns) that all kinds of networks have."""
    index, columns = networks[0].index, networks[0].columns
    for of_kind in networks[1:]:
        index, columns = index.intersection(of_kind.index), columns.intersection(of_kind.columns)
    known = np.all([of.loc[index, columns].notna() for of in networks], axis=0)
    return [
        of.loc[index, columns].where(known).dropna(axis=1, how="all").dropna(how="all")
        for of in networks
    ]


def paired(
    first: pd.DataFrame,
    second: pd.DataFrame,
    of_pair: Callable[[pd.DataFrame, pd.DataFrame], pd.DataFrame] = operator.sub,
) -> Mean:
    """Mean difference of two kinds of networks on the same training sets and test series.

    Rows are training sets, columns are seeds. Networks of a set share its series, so that the unit
    is the set: the interval is Student's over the means of the pairs of each set. It leaves out
    other test series, and other seeds where all sets have the same ones.

    ``of_pair``: What is compared of each pair; default: first less second.
    """
    return mean_of(of_pair(*common(first, second)).mean(axis=1).tolist())


def differences(authors: Tables, own_choices: Tables, paper: Tables) -> Part:
    """Distance of published values from the paper's campaign (RV), as a sum of three.

    The choices, on the same training sets and seeds; the five training sets beside the campaign's
    own, with our choices; and what is left between the published value and the five training sets
    with the authors' choices.
    """
    cells: Part = []
    for network in networks_of(own_choices):
        for score in SCORES:
            theirs, ours = common(
                *(score.networks(tables, **network) for tables in (authors, own_choices))
            )
            median = score.median(paper, case=CASE, **network)
            if np.isnan(published := score.published(**network)) or ours.empty:
                continue
            choices, sets = paired(theirs, ours), paired(ours, 0 * ours + median)
            left, digits = published - median - choices.mean - sets.mean, score.digits
            label = f"{network['neurons']:g} neurons, {score.title}"
            cells += [
                (label, "paper less its campaign here", f"{published - median:+.{digits}f}"),
                (label, "choices", choices.text(digits)),
                (label, "other training sets", sets.text(digits)),
                (label, "left", f"{left:+.{digits}f}"),
            ]
    return cells


def gaps(name: str, tables: Tables, score: Score) -> Part:
    """Share of the distance of networks from F = 1 that a washout without noise removes."""
    cells: Part = []
    for network in networks_of(tables):
        noisy, true = (
            score.networks(tables, forecaster=forecaster, **network) for forecaster in ("esn", TRUE)
        )
        if true.empty:
            continue
        clean, both = common(true, noisy)
        closed = paired(true, noisy, lambda clean, noisy: (clean - noisy) / (1 - noisy))
        label = f"{name} choices, {network['neurons']:g} neurons"
        cells += [
            (label, "noisy washout", f"{np.nanmean(both):.3f}"),
            (label, "true washout", f"{np.nanmean(clean):.3f}"),
            (label, "share of the gap due to the state", closed.text(2, "")),
        ]
    return cells


def scatter(tables: Tables, scores: tuple[Score, ...]) -> Part:
    """Means of scores, and their scatter over training sets, seeds and test data.

    The last is the standard error of one network over test series, events or closed loops.
    """
    cells: Part = []
    for score in scores:
        where = {"metric": score.metric, **dict(score.where)}
        for row in tables.rows("training_realisations", forecaster="esn", **where).to_dict(
            "records"
        ):
            network = {"neurons": row["neurons"], "validation": row["validation"]}
            digits = score.digits
            values = {
                "mean": row["mean"],
                "over training sets": row["standard_deviation_over_training_sets"],
                "over seeds": row["standard_deviation_over_seeds"],
                "over test data": score.error(tables, **network),
            }
            label = f"{row['neurons']:g} neurons, {score.title}"
            cells += [(label, head, f"{value:.{digits}f}") for head, value in values.items()]
    return cells


def own_ranks(tables: Tables, times: tuple[float, ...] = (1.0, 2.0, 3.0, 4.0, 5.0)) -> str:
    """How often the campaign's own training set is the best or the worst of all, in F-scores."""
    best, worst, count = 0, 0, 0
    for network in networks_of(tables):
        for time in times:
            means = f_score(time).networks(tables, False, **network).mean(axis=1)
            best += int(means.idxmax() == CASE)
            worst += int(means.idxmin() == CASE)
            count += 1
    return f"the best in {best} and the worst in {worst} of {count} F-scores"


def own_is_best(tables: Tables, score: Score, network: dict[str, Any]) -> bool:
    """Whether the campaign's own training set has the best mean over seeds of all sets."""
    means = score.networks(tables, False, **network).mean(axis=1)
    return str(means.idxmax()) == CASE


def own_is_worst(tables: Tables, score: Score, network: dict[str, Any]) -> bool:
    """Whether the campaign's own training set has the worst mean over seeds of all sets."""
    means = score.networks(tables, False, **network).mean(axis=1)
    return str(means.idxmin()) == CASE


# -- readouts --------------------------------------------------------------------------------------

READOUTS = {
    "esn": "as in the paper",
    "esn_bias": "input bias 1",
    "esn_quadratic": "squares",
    "esn_quadraticbias": "squares, input bias 1",
    "esn_quadraticleak": "squares, leak searched",
}
"""Networks by their readout, as they are named in tables."""


def renamed(rows: pd.DataFrame) -> pd.DataFrame:
    """Rows with the words for their readouts."""
    return rows.assign(readout=rows["forecaster"].map(READOUTS))


def over_sets(tables: Tables, score: Score, **where: Any) -> pd.DataFrame:
    """Means over the training sets of networks, by readout, size and Reynolds number.

    ``low``, ``high``: 95 % interval of Student's t over the means of the seeds of each set, which
    leaves out what other test series would give. ``least``, ``largest``: Of these means.
    """
    rows = tables.rows(score.table, forecaster=list(READOUTS), **{**dict(score.where), **where})
    keys = ["forecaster", "neurons", "reynolds"]
    of_sets = rows.groupby([*keys, "case"], sort=False)[score.metric].mean()
    means = of_sets.groupby(level=keys, sort=False).agg(["mean", "std", "count", "min", "max"])
    half = student.ppf((1 + CONFIDENCE) / 2, means["count"] - 1)
    half = half * means["std"] / np.sqrt(means["count"])
    means = means.assign(low=means["mean"] - half, high=means["mean"] + half).reset_index()
    means["order"] = means["forecaster"].map(list(READOUTS).index)
    return renamed(means.sort_values(["order", "reynolds", "neurons"], kind="stable"))


def hierarchical(tables: Tables, score: Score, **where: Any) -> pd.DataFrame:
    """Means over training sets with the interval over these and over the test series.

    ``low``, ``high``: What other training sets and other test series, which all networks of a
    campaign share, would give; the seeds are the same in each set, and are not drawn anew.
    """
    means = over_sets(tables, score, **where)
    kinds = means[["forecaster", "neurons"]].to_dict("records")
    of_test = np.square([score.error(tables, **{str(k): v for k, v in of.items()}) for of in kinds])
    half = half_interval(means["std"] ** 2 / means["count"], of_test, means["count"])
    return means.assign(low=means["mean"] - half, high=means["mean"] + half)


def paired_score(
    tables: Tables, score: Score, first: dict[str, Any], second: dict[str, Any]
) -> Mean:
    """Difference of two kinds of networks of a campaign, as `paired` has it."""
    one, other = (score.networks(tables, False, **kind) for kind in (first, second))
    return paired(one, other)


def extremes(rows: pd.DataFrame, column: str) -> pd.DataFrame:
    """Least and largest value of the networks of each kind."""
    of_kind = rows.groupby("forecaster", sort=False)[column]
    return of_kind.agg(least="min", largest="max").reset_index()


# -- bursts of turbulence --------------------------------------------------------------------------


def onsets(tables: Tables, source: str = "turbulence") -> pd.DataFrame:
    """Average precision of onsets, of a case and of what is observed of it, each alarm once."""
    cases = tables.rows("dataset").set_index("case")[["series_kept", "mean_observable"]]
    same = [*cases.index[(cases == cases.loc[source]).all(axis=1)]]
    rows = shown_once(tables.rows("ranking", event="onset", metric="average_precision", case=same))
    common = rows["alarm"].isin(SAME_EVERYWHERE)
    name = rows["name"].mask(common, rows["forecaster"].str.replace("_", " "))
    return rows.assign(name=name, case=rows["case"].mask(common, "any"))


# -- control ---------------------------------------------------------------------------------------

_MEASURED = re.compile(
    "(left|acting|effort|power|condition|means|name|scored_flows|rarer_than_lt|.*_(low|high)"
    "|(exceedance|events_per|switchings|input|relative|dissipation|laminarisation|laminarised).*)"
)


def over_all_flows(tables: Tables) -> pd.DataFrame:
    """Chosen runs of control on all flows: those that choose settings, and those that score."""
    everything, chosen = (tables.runs(f"control_{name}") for name in ("strategies", "choices"))
    keys = [key for key in chosen if key in everything and not _MEASURED.fullmatch(str(key))]
    return everything.merge(chosen[keys], on=keys)


# -- costs -----------------------------------------------------------------------------------------


def costs(tables: Tables, shown: int = 6) -> Part:
    """Times of the jobs of the most expensive rules, and of all; of the processor where known."""
    costs_of_rules = tables.rows("rule_costs").sort_values("minutes", ascending=False)
    times = [name for name in ("minutes", "processor_minutes") if name in costs_of_rules]
    sums = costs_of_rules[["jobs", *times]].sum(skipna=False)
    total = {**sums.to_dict(), "memory_mib": costs_of_rules["memory_mib"].max(), "rule": "**all**"}
    cells = {"jobs": "{jobs:.0f}", "took [min]": "{minutes:.0f}"}
    if "processor_minutes" in times:
        cells |= {"processor [min]": "{processor_minutes:.0f}"}
    cells |= {"largest memory [MiB]": "{memory_mib:.0f}"}
    rows = pd.concat([costs_of_rules.head(shown), pd.DataFrame([total])])
    return part(rows, "{rule}", cells)

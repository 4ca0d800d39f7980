"""Tables of docs/results.md about the choices of the paper's authors and the training sets.

Two campaigns have the same networks on the same training sets, which are drawn by their share of
time with an extreme event: one with the choices of the authors' programs, one with the choices in
config.yaml. The networks of a size are a balanced design of training sets and seeds.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from burstcast.data.training_realisations import realisation_of
from burstcast.statistics.analysis_of_variance import (
    analysis_of_variance,
    mean_and_margin,
    slope_and_margin,
    student_quantile,
)
from burstcast_report.results_tables import (
    Tables,
    fixed,
    markdown,
    published_rows,
)

CASE = "Re400"
CONFIDENCE = 0.95
MORE_EVENTS = 0.04
"""By which the share of events in the authors' training set, 0.17, exceeds the one of all data."""
TRUE = "esn_true_washout"


@dataclass(frozen=True)
class Score:
    """A score of networks: its column in a kept table, and how it is shown."""

    title: str
    table: str
    metric: str
    time_lt: float | None
    digits: int

    def rows(self, tables: Tables, forecaster: str = "esn", **where: Any) -> pd.DataFrame:
        """Rows of its table, with its prediction time."""
        if self.time_lt is not None:
            where["prediction_time_lt"] = self.time_lt
        return tables.rows(self.table, forecaster=forecaster, **where)

    def by_training_set(
        self, tables: Tables, forecaster: str = "esn", **where: Any
    ) -> pd.DataFrame:
        """Values of the networks: rows are drawn training sets, columns are seeds."""
        rows = self.rows(tables, forecaster, **where)
        if rows.empty or self.metric not in rows:
            return pd.DataFrame()
        rows = rows[[realisation_of(name)[1] > 0 for name in rows["case"]]]
        return rows.pivot_table(self.metric, "case", "seed")

    def sampling_error(self, tables: Tables, **where: Any) -> float:
        """Standard error of one network over test series or events; NaN for an objective."""
        if self.table == "hyperparameters":
            return float("nan")
        if self.time_lt is not None:
            where["prediction_time_lt"] = self.time_lt
        ends = tables.rows(f"{self.table}_intervals", forecaster="esn", metric=self.metric, **where)
        if ends.empty:
            return float("nan")
        return float((ends["high"] - ends["low"]).median()) / (2 * 1.96)


SCORES = (
    Score("F-score, 2 LT ahead", "classification", "f_score", 2.0, 3),
    Score("F-score, 3 LT ahead", "classification", "f_score", 3.0, 3),
    Score("mean PH_ee [LT]", "horizon", "mean_horizon_lt", None, 2),
    Score("objective", "hyperparameters", "objective", None, 2),
)
F_SCORES = SCORES[:2]


def _networks(tables: Tables) -> list[tuple[int, str]]:
    """Sizes and strategies of the networks on drawn training sets."""
    rows = tables.rows("classification", forecaster="esn")
    if rows.empty:
        return []
    found = rows[["neurons", "validation"]].drop_duplicates().itertuples(index=False)
    return sorted((int(neurons), str(validation)) for neurons, validation in found)


def _shares(tables: Tables) -> pd.Series:
    """Share of time with an extreme event in the training series of each case."""
    return tables.rows("dataset").set_index("case")["training_event_share"]


def _with_margin(mean: float, margin: float, digits: int, signed: bool = True) -> str:
    if np.isnan(mean):
        return ""
    text = f"{mean:{'+' if signed else ''}.{digits}f}"
    return text if np.isnan(margin) else f"{text} ± {fixed(margin, digits)}"


# -- training sets ---------------------------------------------------------------------------------


def training_sets(tables: Tables) -> str:
    """Shares of events of the training sets, and scores of their networks (RV)."""
    shares, sizes = _shares(tables), [n for n, strategy in _networks(tables) if strategy == "RV"]
    columns = [(score, size) for size in sizes for score in (F_SCORES[1], SCORES[3])]
    found = [
        score.by_training_set(tables, neurons=size, validation="RV") for score, size in columns
    ]
    rows = []
    for case in shares.drop(CASE, errors="ignore").sort_values().index:
        values = [
            fixed(float(table.loc[case].mean()), score.digits) if case in table.index else ""
            for (score, _), table in zip(columns, found, strict=True)
        ]
        rows.append([fixed(float(shares[case])), *values])
    head = [f"{score.title}, {size} neurons" for score, size in columns]
    return markdown(["share of time with an event", *head], rows)


def own_share(tables: Tables) -> str:
    """Share of events in the first ten kept series, which the paper's campaign is trained on."""
    return fixed(float(_shares(tables)[CASE]))


def share_of_all(tables: Tables) -> str:
    """Share of events in all kept series."""
    return fixed(tables.number("dataset", "event_share", case=CASE))


# -- beside the published values -------------------------------------------------------------------


def _published(score: Score, neurons: int, validation: str) -> float:
    time = {} if score.time_lt is None else {"prediction_time_lt": score.time_lt}
    rows = published_rows(
        score.table, score.metric, reynolds=400, neurons=neurons, validation=validation, **time
    )
    return float(rows["p50"].iloc[0]) if len(rows) == 1 else float("nan")


def _interval(score: Score, tables: Tables, **where: Any) -> tuple[float, float, int]:
    """Mean over training sets, and the margin for what other training and test data give.

    The margin is the root of the sum of two variances: of a further training set beside the mean of
    these, and of two choices of the test series, ours and the authors'. The training sets give its
    degrees of freedom.
    """
    values = score.by_training_set(tables, **where)
    if values.empty:
        return float("nan"), float("nan"), 0
    means = values.mean(axis=1).to_numpy()
    count = len(means)
    of_sets = float(np.var(means, ddof=1)) * (1 + 1 / count) if count > 1 else float("nan")
    error = score.sampling_error(tables, **where)
    of_test = 0.0 if np.isnan(error) else 2 * error**2
    margin = student_quantile(count - 1, CONFIDENCE) * np.sqrt(of_sets + of_test)
    return float(means.mean()), float(margin), count


def beside_published(authors: Tables, own: Tables, paper: Tables) -> str:
    """Published medians beside those with the authors' choices, ours, and the paper's campaign."""
    rows = []
    for neurons, validation in _networks(authors):
        where: dict[str, Any] = {"neurons": neurons, "validation": validation}
        for score in SCORES:
            published = _published(score, neurons, validation)
            mean, margin, _ = _interval(score, authors, **where)
            ours = score.by_training_set(own, **where)
            campaign = score.rows(paper, case=CASE, **where)
            inside = "" if np.isnan(published) else "outside"
            if abs(published - mean) <= margin:
                inside = "inside"
            rows.append(
                [
                    f"{neurons} {validation}",
                    score.title,
                    fixed(published, score.digits),
                    _with_margin(mean, margin, score.digits, signed=False),
                    inside,
                    "" if ours.empty else fixed(float(ours.to_numpy().mean()), score.digits),
                    "" if campaign.empty else fixed(campaign[score.metric].median(), score.digits),
                ]
            )
    head = ["network", "", "paper", "authors' choices", "", "our choices", "the paper's campaign"]
    return markdown(head, rows)


def _published_scores(neurons: int, validation: str) -> Iterator[tuple[str, Score]]:
    """Everything that is published of a size and strategy and that these campaigns have."""
    for metric in ("precision", "recall", "f_score"):
        rows = published_rows(
            "classification", metric, reynolds=400, neurons=neurons, validation=validation
        )
        for time in rows["prediction_time_lt"]:
            yield "classification", Score(metric, "classification", metric, float(time), 3)
    for kind, score in (("horizon", SCORES[2]), ("objective", SCORES[3])):
        if not np.isnan(_published(score, neurons, validation)):
            yield kind, score


def agreement(authors: Tables, paper: Tables) -> str:
    """Number of published values inside intervals without and with other training sets."""
    counts: dict[str, list[int]] = {}
    for neurons, validation in _networks(authors):
        where: dict[str, Any] = {"neurons": neurons, "validation": validation}
        for kind, score in _published_scores(neurons, validation):
            campaign = score.rows(paper, case=CASE, **where)
            if campaign.empty or score.by_training_set(authors, **where).empty:
                continue
            published = _published(score, neurons, validation)
            median = float(campaign[score.metric].median())
            test = 1.96 * score.sampling_error(paper, case=CASE, **where)
            mean, margin, _ = _interval(score, authors, **where)
            found = counts.setdefault(kind, [0, 0, 0])
            found[0] += 1
            found[1] += int(abs(published - median) <= test)
            found[2] += int(abs(published - mean) <= margin)
    rows = [[kind, *map(str, found)] for kind, found in counts.items()]
    rows = [row if row[0] != "objective" else [*row[:2], "", row[3]] for row in rows]
    head = ["", "published values", "inside: the paper's campaign, test data alone"]
    return markdown([*head, "inside: the authors' choices, training sets as well"], rows)


# -- analysis of variance --------------------------------------------------------------------------


def _paired(score: Score, authors: Tables, own: Tables, **where: Any) -> pd.DataFrame:
    """Authors' choices less ours, of the networks that both campaigns have."""
    both = [score.by_training_set(tables, **where) for tables in (authors, own)]
    if any(table.empty for table in both):
        return pd.DataFrame()
    return (both[0] - both[1]).dropna(axis=1, how="all").dropna()


def variance_table(authors: Tables, own: Tables) -> str:
    """Standard deviation that each factor causes, by size, strategy and score.

    Training sets and seeds are crossed factors of the campaign with the authors' choices; what is
    left is their interaction. Choices are a third factor, of the networks that both campaigns have.
    """
    rows = []
    for neurons, validation in _networks(authors):
        where: dict[str, Any] = {"neurons": neurons, "validation": validation}
        for score in SCORES:
            values = score.by_training_set(authors, **where).dropna()
            if values.empty:
                continue
            found = analysis_of_variance(values.to_numpy())
            parts = [one.standard_deviation for one in (*found.factors, found.residual)]
            choices = float("nan")
            paired = _paired(score, authors, own, **where)
            if len(paired) > 1:
                authors_values = values.loc[paired.index, paired.columns].to_numpy()
                both = np.stack([authors_values, authors_values - paired.to_numpy()], axis=-1)
                choices = analysis_of_variance(both).factors[-1].standard_deviation
            parts += [score.sampling_error(authors, **where), choices]
            digits = score.digits
            rows.append(
                [
                    f"{neurons} {validation}",
                    score.title,
                    fixed(found.mean, digits),
                    *(fixed(part, digits) for part in parts),
                ]
            )
    head = ["network", "", "mean", "training sets", "seeds", "both together (rest)", "test series"]
    return markdown([*head, "choices"], rows)


def differences_table(authors: Tables, own: Tables, paper: Tables) -> str:
    """Distance of published values from the paper's campaign (RV), by size and score.

    The difference is the sum of three: the choices on the same training sets and seeds, the five
    training sets beside the campaign's own with our choices, and what is left between the published
    value and the five training sets with the authors' choices.
    """
    shares = _shares(authors)
    rows = []
    for neurons, validation in _networks(authors):
        where: dict[str, Any] = {"neurons": neurons, "validation": validation}
        for score in SCORES:
            campaign = score.rows(paper, case=CASE, **where)
            paired = _paired(score, authors, own, **where)
            published = _published(score, neurons, validation)
            if validation != "RV" or campaign.empty or np.isnan(published) or paired.empty:
                continue
            median = float(campaign[score.metric].median())
            theirs = score.by_training_set(authors, **where)[paired.columns].loc[paired.index]
            choices, margin = mean_and_margin(paired.mean(axis=1).tolist(), CONFIDENCE)
            ours = (theirs - paired).mean(axis=1).tolist()
            sets, of_sets = mean_and_margin([value - median for value in ours], CONFIDENCE)
            left = published - median - choices - sets
            slope, of_slope = slope_and_margin(
                shares[theirs.index].tolist(), theirs.mean(axis=1).tolist(), CONFIDENCE
            )
            parts = [(published - median, np.nan), (choices, margin), (sets, of_sets)]
            parts += [(left, np.nan), (MORE_EVENTS * slope, MORE_EVENTS * of_slope)]
            texts = [_with_margin(mean, error, score.digits) for mean, error in parts]
            rows.append([f"{neurons} {validation}", score.title, *texts])
    head = ["network", "", "paper - its campaign here", "choices", "other training sets", "left"]
    return markdown([*head, f"{MORE_EVENTS:g} more share of events"], rows)


# -- the state and the network ---------------------------------------------------------------------


def gap_table(campaigns: Sequence[tuple[str, Tables]]) -> str:
    """The distance of networks from a perfect F-score, as parts of the state and of the network."""
    rows = []
    for name, tables in campaigns:
        for neurons, validation in _networks(tables):
            where: dict[str, Any] = {"neurons": neurons, "validation": validation}
            for score in F_SCORES:
                noisy = score.by_training_set(tables, **where)
                true = score.by_training_set(tables, TRUE, **where)
                if true.empty:
                    continue
                both = (noisy + 0 * true).dropna(axis=1, how="all").dropna()
                true = true.loc[both.index, both.columns]
                parts = ((true - both) / (1 - both)).mean(axis=1).tolist()
                share, margin = mean_and_margin([100 * part for part in parts], CONFIDENCE)
                rows.append(
                    [
                        f"{neurons} {validation}",
                        name,
                        score.title,
                        fixed(float(both.to_numpy().mean())),
                        fixed(float(true.to_numpy().mean())),
                        f"{_with_margin(share, margin, 0, signed=False)} %",
                    ]
                )
    head = ["network", "choices", "", "noisy washouts", "true washouts"]
    return markdown([*head, "part of the gap to 1 that true washouts close"], rows)

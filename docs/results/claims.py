"""Claims of the paper, and what our tables say about each.

A claim is a function of the tables of the paper's campaign whose docstring is the rule by which it
agrees. Its bar is what the paper itself says or draws, and stands with the claim as its source; a
claim for which the paper gives no bar is not testable, whatever our numbers are. A number agrees if
our whole interval lies within a margin of the paper's number. `MARGINS` fixes the margins, which
are ours, independently of the results. An interval that is wider than its margin cannot agree.
Intervals are over the test data, without the scatter over training series.
"""

import inspect
import itertools
import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache, wraps
from typing import Any

from kept_tables import Tables, published_rows, published_value, table, text

RV = {"forecaster": "esn", "validation": "RV"}
SSV = {"forecaster": "esn", "validation": "SSV"}
TRAINING = {"forecaster": "training"}
CASE = "Re400"
EVENT_THRESHOLD = 0.1
AN_ORDER = 10.0
"""The factor that is one order of magnitude."""
MARGINS = {
    "share of series": ("relative", 0.05),
    "Lyapunov exponent": ("relative", 0.03),
    "share of starting points followed by an event": ("relative", 0.15),
    "precision, recall, F-score": ("absolute", 0.05),
    "largest precision, largest recall": ("absolute", 0.01),
    "PH_ee": ("LT", 0.5),
    "exceedance under control": ("relative", 0.25),
}
"""Largest difference at which two numbers of a kind agree."""
DENSITY = {"kantorovich": "Kantorovich metric", "mean_log_error": "mean logarithmic error"}
PROFILES = {"nrmse_u": "NRMSE u", "nrmse_uu": "NRMSE u^2", "nrmse_uv": "NRMSE uv"}


@dataclass(frozen=True)
class Finding:
    """Verdict on a claim."""

    paper: str  #: the paper's numbers, as text
    ours: str  #: our numbers with their intervals
    #: "yes", "nearly", "undecided", "no"; of several: "3 yes, 1 nearly"; `NOT_TESTABLE`
    agrees: str
    why: str = ""  #: reason of a disagreement, or a remark


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, and the function that tests it."""

    text: str
    section: str
    source: str  #: the paper's words, or its figure, that give the bar; "" if none does
    find: Callable[[Tables], Finding]


CLAIMS: list[Claim] = []
"""All claims, in the order of the page."""

NOT_TESTABLE = "not testable"
"""Verdict on a claim for which the paper gives no bar."""

NOT_KEPT = (
    "the largest error of the forecast velocity during an event is about 5 % of its range (II, "
    "figure 3): the figure `midplane_planes` of a campaign shows it",
    "in the midplane, the error of the mean square velocity is smaller than the error of the "
    "training set (V, figure 15): the figure `midplane_mean_square` of a campaign has both",
    "1.5 LT pass on average from the start of control to the event (VI): the windows of the "
    "strategy alone allow 1 to 2 LT",
)
"""Claims that the kept tables cannot judge."""


def claim(
    words: str, section: str, source: str = ""
) -> Callable[[Callable[[Tables], Finding]], Callable[..., Any]]:
    """Make a function a claim of the paper; without a source of its bar it is not testable."""

    def add(find: Callable[[Tables], Finding]) -> Callable[[Tables], Finding]:
        def found(tables: Tables) -> Finding:
            finding = find(tables)
            return finding if source else replace(finding, agrees=NOT_TESTABLE)

        CLAIMS.append(Claim(words, section, source, wraps(find)(found)))
        return find

    return add


def margins_table() -> str:
    """Table of the margins of each kind of number."""
    cells = [
        (kind, "margin", f"{100 * margin:g} %" if unit == "relative" else f"{margin:g} {unit}")
        for kind, (unit, margin) in MARGINS.items()
    ]
    return table("", [(kind, head, cell.removesuffix(" absolute")) for kind, head, cell in cells])


@cache
def findings(tables: Tables) -> list[Finding]:
    """Findings of all claims."""
    return [claim.find(tables) for claim in CLAIMS]


def claims_table(tables: Tables) -> str:
    """Table of all claims: the paper's numbers, ours, whether they agree, and by which rule."""
    cells = []
    for claim, finding in zip(CLAIMS, findings(tables), strict=True):
        rule = " ".join(str(inspect.getdoc(claim.find)).split()).removeprefix("Agrees ")
        columns = {"section": claim.section, "paper": finding.paper, "ours": finding.ours}
        columns |= {"agrees": finding.agrees, "rule": rule, "reason or remark": finding.why}
        cells += [(claim.text, head, cell) for head, cell in columns.items()]
    return table("claim", cells)


def sources_table() -> str:
    """Table of the bars of all claims: where the paper gives them."""
    return table(
        "claim", [(each.text, "source of its bar", each.source or "none") for each in CLAIMS]
    )


def verdicts_of(tables: Tables) -> dict[str, int]:
    """Number of claims that agree, agree nearly, agree in part, or disagree.

    ``nearly``: Those of which no part disagrees, but that are not "yes" as a whole. ``mixed``: Some
    parts disagree. ``claims``: All that have a bar; ``untestable``: The others.
    """
    verdicts = [finding.agrees for finding in findings(tables)]
    counts = {answer: verdicts.count(answer) for answer in ("yes", "no", NOT_TESTABLE)}
    untestable = counts.pop(NOT_TESTABLE)
    counts["mixed"] = sum(bool(re.search(r"\d no", answer)) for answer in verdicts)
    claims = len(CLAIMS) - untestable
    nearly = claims - sum(counts.values())
    return {**counts, "nearly": nearly, "claims": claims, "untestable": untestable}


def verdicts_by_margin(tables: Tables, factor: float) -> dict[str, int]:
    """`verdicts_of` if all margins were so many times as wide."""
    kept = dict(MARGINS)
    try:
        MARGINS.update({kind: (unit, factor * margin) for kind, (unit, margin) in kept.items()})
        findings.cache_clear()
        return verdicts_of(tables)
    finally:
        MARGINS.update(kept)
        findings.cache_clear()


def verdict(kind: str, paper: float, low: float, high: float, digit: float = 0.0) -> str:
    """Whether our interval is equivalent to the paper's number, by the margin of its kind.

    ``digit``: Last digit of the paper's number, which is rounded.
    """
    unit, margin = MARGINS[kind]
    margin = margin * (abs(paper) if unit == "relative" else 1.0) + digit / 2
    if abs(paper - (low + high) / 2) > margin:
        return "no"
    if paper - margin <= low and high <= paper + margin:
        return "yes"
    return "nearly" if high - low <= 2 * margin else "undecided"


def reaches(kind: str, paper: float, ours: Any) -> str:
    """Whether our lower end, or only our median (nearly), reaches the paper's less the margin."""
    least = paper - MARGINS[kind][1]
    return _graded(ours.low >= least, nearly=ours.p50 >= least)


def larger(first: Any, other: Any) -> str:
    """Whether the median of some networks is larger than that of others, beyond their scatter.

    Yes if the difference is more than 1.96 of its standard errors, which follow from quartiles of
    networks as for a normal distribution; nearly if it is positive.
    """
    error = math.hypot(*(_error_of_median(row) for row in (first, other)))
    return _beyond(first.p50 - other.p50, 1.96 * error)


def _beyond(difference: float, half: float) -> str:
    """Whether a difference is positive beyond half its interval; nearly if it is positive alone."""
    return _graded(difference > half, nearly=difference > 0)


def _graded(agrees: bool, *, nearly: bool) -> str:
    if agrees:
        return "yes"
    return "nearly" if nearly else "no"


def _error_of_median(row: Any) -> float:
    deviation = (row.p75 - row.p25) / 1.349
    return float(math.sqrt(math.pi / 2 / row.networks) * deviation)


def all_of(holds: Iterable[bool | str]) -> str:
    """Verdict on a claim that is the sum of several comparisons (truth values or verdicts)."""
    verdicts = [hold if isinstance(hold, str) else ("yes" if hold else "no") for hold in holds]
    counts = {answer: verdicts.count(answer) for answer in ("yes", "nearly", "undecided", "no")}
    counts = {answer: count for answer, count in counts.items() if count}
    if len(counts) == 1:
        return verdicts[0]
    return ", ".join(f"{count} {answer}" for answer, count in counts.items())


def _f(tables: Tables, time: float, case: str = CASE, metric: str = "f_score", **of: Any) -> Any:
    return tables.row("classification", metric, case=case, prediction_time_lt=time, **of)


def _horizon(tables: Tables, case: str = CASE, **of: Any) -> Any:
    return tables.row("horizon", "mean_horizon_lt", case=case, **of)


def _exceedance(tables: Tables, state: str, **of: Any) -> Any:
    return tables.row("control", f"exceedance_{state}", **of)


def _with_ends(row: Any, digits: int = 3) -> str:
    """Median with the interval of one network."""
    low, middle, high = (f"{end:.{digits}f}" for end in (row.low, row.p50, row.high))
    return f"{middle} ({low} to {high})"


# -- data ------------------------------------------------------------------------------------------


@claim(
    "series of 2000 that do not laminarise, Re = 400",
    "II B",
    'II B: "the dataset consists of 1436 time series" of 2000',
)
def series_kept(tables: Tables) -> Finding:
    """Agrees if our 95 % interval (Wilson) lies within the margin."""
    row = tables.rows("dataset", case=CASE).iloc[0]
    n, share, z = row["series_generated"], row["series_kept"] / row["series_generated"], 1.96
    middle = (share + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * math.sqrt(share * (1 - share) / n + z**2 / (4 * n**2))
    low, high = n * (middle - half), n * (middle + half)
    ours = f"{row['series_kept']} ({low:.0f} to {high:.0f})"
    return Finding("1436", ours, verdict("share of series", 1436, low, high))


@claim(
    "leading Lyapunov exponents, Re = 400, 600, 800, 1000",
    "II A, IV C",
    "II A, IV C: the exponents",
)
def exponents(tables: Tables) -> Finding:
    """Agrees if our interval lies within the margin and half a unit of the paper's last digit."""
    rows = tables.rows("dataset").to_dict("records")
    name, verdicts = "lyapunov_exponent", []
    for row in rows:
        ends = row[f"{name}_given"], row[f"{name}_low"], row[f"{name}_high"]
        verdicts.append(verdict("Lyapunov exponent", *ends, digit=1e-4))
    cell = f"{{{name}:.4f}} ({{{name}_low:.4f}} to {{{name}_high:.4f}})"
    paper, ours = (
        ", ".join(text(template, row) for row in rows)
        for template in (f"{{{name}_given:.4f}}", cell)
    )
    differ = [
        f"{row['reynolds']:g}" for row, answer in zip(rows, verdicts, strict=True) if answer == "no"
    ]
    growth = [f"{row[f'{name}_by_growth']:.4f}" for row in rows]
    why = f"not at Re = {', '.join(differ)}; by the growth of perturbations {', '.join(growth)}"
    return Finding(paper, ours, all_of(verdicts), why if differ else "")


@claim(
    "share of starting points followed by an event in the window (base rate), Re = 400",
    "IV A",
    'IV A: "9000 starting points, which ... consist of 360 extreme events"; the authors\' files '
    "score 6914",
)
def events_after_the_points(tables: Tables) -> Finding:
    """Agrees if our 95 % interval (Poisson) of the share at 5 LT lies within the margin."""
    where = {"forecaster": "equations", "case": CASE, "prediction_time_lt": 5}
    (row,) = tables.rows("classification", **where).to_dict("records")
    events = row["true_positive"] + row["false_negative"]
    points = events + row["false_positive"] + row["true_negative"]
    low, high = ((events + side * 1.96 * math.sqrt(events)) / points for side in (-1, 1))
    # the authors' files score 6914 of 9000 points, outside of events
    paper, scored = 360, 6914
    return Finding(
        f"{paper} of 9000, or of {scored} scored points: {paper / scored:.4f}",
        f"{events} of {points} scored points: {events / points:.4f} ({low:.4f} to {high:.4f})",
        verdict("share of starting points followed by an event", paper / scored, low, high),
    )


# -- time-accurate prediction ----------------------------------------------------------------------


def _pairs(tables: Tables, metric: str, **where: Any) -> list[str]:
    """Whether RV's median is larger than SSV's, by case, size and prediction time."""
    rows = tables.rows("classification_percentiles", forecaster="esn", metric=metric, **where)
    keys = ["case", "neurons", "prediction_time_lt"]
    verdicts = []
    for _, pair in rows.groupby(keys):
        of = pair.set_index("validation")
        verdicts.append(larger(of.loc["RV"], of.loc["SSV"]))
    return verdicts


def _horizons_larger(tables: Tables, case: str, neurons: int) -> str:
    where = {"case": case, "neurons": neurons, "metric": "mean_horizon_lt"}
    rv, ssv = (tables.rows("horizon_percentiles", **where, **of).iloc[0] for of in (RV, SSV))
    return larger(rv, ssv)


@claim(
    "RV outperforms SSV in precision, recall and F-score, Re = 400",
    "IV A",
    'IV A: "outperforms the Single Shot Validation in all the figures of merit"; figure 8',
)
def recycle_beats_single_shot(tables: Tables) -> Finding:
    """Agrees if RV's median is larger beyond the scatter of networks; nearly if it is larger."""
    metrics = ("precision", "recall", "f_score")
    better = {metric: _pairs(tables, metric, case=CASE) for metric in metrics}
    counts = [f"{name.replace('_', '-')}: {all_of(pairs)}" for name, pairs in better.items()]
    ours = f"{'; '.join(counts)} ({len(better['recall'])} sizes and prediction times)"
    return Finding("always", ours, all_of(itertools.chain(*better.values())))


@claim(
    "F-score 3 LT ahead: 1500 neurons with RV exceed 3000 with SSV",
    "IV A",
    'IV A: "F_RV = 0.79, which is greater than ... F_SSV = 0.76"',
)
def tuning_beats_size(tables: Tables) -> Finding:
    """Agrees if the median is larger beyond the scatter of networks; nearly if it is larger."""
    rv, ssv = _f(tables, 3, neurons=1500, **RV), _f(tables, 3, neurons=3000, **SSV)
    ours = f"{_with_ends(rv)} {'>' if rv.p50 > ssv.p50 else '<='} {_with_ends(ssv)}"
    return Finding("0.79 > 0.76", ours, larger(rv, ssv))


@claim(
    "F-score 2 LT and 3 LT ahead",
    "IV A",
    'IV A: "F >= 0.9 for 2LTs prediction time and up to F = 0.8 for 3LTs"',
)
def two_and_three_times_ahead(tables: Tables) -> Finding:
    """Agrees if the interval of the best size is above 0.9 - margin (2 LT), and at 0.8 (3 LT)."""
    two, three = (
        max((_f(tables, time, neurons=n, **RV) for n in tables.sizes(CASE)), key=lambda e: e.p50)
        for time in (2, 3)
    )
    ours = f"up to {_with_ends(two)} and {_with_ends(three)}"
    kind = "precision, recall, F-score"
    agrees = all_of([reaches(kind, 0.9, two), verdict(kind, 0.8, three.low, three.high)])
    return Finding(">= 0.9 and up to 0.8", ours, agrees)


@claim(
    "events predicted 2 LT ahead, and false alarms",
    "IV A",
    'IV A: "almost all the events (90 %) ... with only a few false positives (10 %)"',
)
def most_events_two_ahead(tables: Tables) -> Finding:
    """Agrees if the intervals of recall and precision of 2000 neurons lie within the margin."""
    recall, right = (_f(tables, 2, metric=m, neurons=2000, **RV) for m in ("recall", "precision"))
    false = f"{1 - right.p50:.3f} ({1 - right.high:.3f} to {1 - right.low:.3f})"
    ours = f"{_with_ends(recall)} predicted, {false} of the alarms false"
    kind = "precision, recall, F-score"
    agrees = all_of(verdict(kind, 0.9, score.low, score.high) for score in (recall, right))
    return Finding("90 %, 10 % false", ours, agrees)


@claim(
    "largest precision and recall",
    "VII",
    'VII: "large precision (up to 98 %) and recall (up to 99 %)"',
)
def largest_scores(tables: Tables) -> Finding:
    """Agrees if the largest medians are the paper's, within the margin."""
    precision, recall = (
        tables.rows("classification_percentiles", metric=metric, **RV)["p50"].max()
        for metric in ("precision", "recall")
    )
    ours = f"{100 * precision:.1f} % and {100 * recall:.1f} %"
    kind = "largest precision, largest recall"
    agrees = all_of(
        verdict(kind, *numbers) for numbers in ((0.98, *[precision] * 2), (0.99, *[recall] * 2))
    )
    return Finding("up to 98 % and 99 %", ours, agrees)


@claim("events predicted more than five Lyapunov times ahead", "abstract, VII")
def five_times_ahead(tables: Tables) -> Finding:
    """The paper does not say how many of the events must be predicted, or alarms be right."""
    recalls = {n: _f(tables, 5, metric="recall", neurons=n, **RV) for n in tables.sizes(CASE)}
    size, recall = max(recalls.items(), key=lambda item: item[1].p50)
    right = _f(tables, 5, metric="precision", neurons=size, **RV)
    shares = f"{_with_ends(recall)} of the events, {_with_ends(right)} of the alarms are right"
    theirs = [published_value("classification", metric, **_AT_FIVE) for metric in _SHARES]
    why = "published medians of 2000 neurons: {:.3f} of the events, {:.3f} of the alarms"
    return Finding("up to more than 5 LT", f"5 LT ahead {shares}", "", why.format(*theirs))


_SHARES = ("recall", "precision")
_AT_FIVE: dict[str, Any] = {"reynolds": 400, "neurons": 2000, "prediction_time_lt": 5.0, **RV}


@claim(
    "F-score from 500 to 1000 neurons, 3 LT ahead, RV",
    "IV A",
    'IV A: "a significant improvement in the performance between 500 and 1000 neurons"',
)
def small_networks_improve(tables: Tables) -> Finding:
    """Agrees if the median is larger beyond the scatter of networks; nearly if it is larger."""
    small, large = (_f(tables, 3, neurons=n, **RV) for n in (500, 1000))
    ours = f"{_with_ends(small)} and {_with_ends(large)}"
    return Finding("a significant improvement", ours, larger(large, small))


@claim("F-score from 1500 neurons on, 3 LT ahead, RV", "IV A")
def size_levels_off(tables: Tables) -> Finding:
    """The paper does not say what is approximately constant."""
    scores = {n: _f(tables, 3, neurons=n, **RV).p50 for n in tables.sizes(CASE) if n >= 1500}
    ours = ", ".join(f"{n}: {score:.3f}" for n, score in scores.items())
    return Finding("approximately constant", ours, "")


@claim(
    "RV outperforms SSV in the prediction horizon",
    "IV B",
    'IV B: "outperforms the Single Shot Validation in all the figures of merit"; figure 11',
)
def recycle_beats_single_shot_in_horizon(tables: Tables) -> Finding:
    """Agrees if RV's median is larger beyond the scatter of networks; nearly if it is larger."""
    gains = [
        _horizon(tables, neurons=n, **RV).p50 - _horizon(tables, neurons=n, **SSV).p50
        for n in tables.sizes(CASE)
    ]
    ours = f"by {min(gains):.2f} to {max(gains):.2f} LT at {len(gains)} sizes"
    agrees = all_of(_horizons_larger(tables, CASE, n) for n in tables.sizes(CASE))
    return Finding("at all sizes", ours, agrees)


@claim(
    "mean PH_ee: 1000 neurons with RV equal 2500 with SSV",
    "IV B",
    'IV B: "4.23 LTs ... approximately the same ... 4.22 LTs"',
)
def tuning_beats_size_in_horizon(tables: Tables) -> Finding:
    """Agrees if the interval of 1000 lies within the margin of the median of 2500."""
    rv, ssv = _horizon(tables, neurons=1000, **RV), _horizon(tables, neurons=2500, **SSV)
    ours = f"{_with_ends(rv, 2)} and {_with_ends(ssv, 2)} LT"
    return Finding("4.23 and 4.22 LT", ours, verdict("PH_ee", ssv.p50, rv.low, rv.high))


@claim(
    "mean PH_ee of the largest networks",
    "IV B",
    'IV B: "up to almost 5LTs in advance on average"',
)
def horizon_of_large_networks(tables: Tables) -> Finding:
    """Agrees if the interval of the best size lies within the margin of 5 LT."""
    best = max((_horizon(tables, neurons=n, **RV) for n in tables.sizes(CASE)), key=lambda e: e.p50)
    agrees = verdict("PH_ee", 5.0, best.low, best.high)
    return Finding("almost 5 LT", f"{_with_ends(best, 2)} LT", agrees)


# -- Reynolds numbers ------------------------------------------------------------------------------


def _grows(before: Any, later: Any) -> str:
    """Whether a number is larger than a number from independent test data."""
    half = math.hypot(*((row.high - row.low) / 2 for row in (before, later)))
    return _beyond(later.p50 - before.p50, half)


@claim(
    "mean PH_ee with the Reynolds number",
    "IV C",
    'IV C: "increasing the Reynolds number increases the prediction horizon"; figure 12 (a)',
)
def horizon_grows(tables: Tables) -> Finding:
    """Agrees if it grows beyond the combined half-width of both intervals (2000 neurons, RV)."""
    horizons = [_horizon(tables, case, neurons=2000, **RV) for case in tables.cases()]
    higher = [_grows(before, later) for before, later in itertools.pairwise(horizons)]
    ours = ", ".join(_with_ends(horizon, 2) for horizon in horizons) + " LT"
    return Finding("grows", ours, all_of(higher))


@claim(
    "F-score at Re = 600, 800, 1000 and at 400, 3 LT ahead",
    "IV C",
    'IV C: "the F-score deteriorates from Re = 400 to the other cases"; figure 12 (b)',
)
def score_falls(tables: Tables) -> Finding:
    """Agrees if F is lower than at 400 beyond the combined half-width of both intervals."""
    first, *others = (_f(tables, 3, case, neurons=2000, **RV) for case in tables.cases())
    ours = f"{', '.join(map(_with_ends, others))} and {_with_ends(first)}"
    return Finding("lower", ours, all_of(_grows(row, first) for row in others))


@claim("F-score at Re = 600, 800 and 1000, 3 LT ahead", "IV C")
def scores_are_similar(tables: Tables) -> Finding:
    """The paper does not say what is similar."""
    scores = [_f(tables, 3, case, neurons=2000, **RV).p50 for case in tables.cases()[1:]]
    ours = ", ".join(f"{score:.3f}" for score in scores)
    return Finding("similar to each other", ours, "")


@claim(
    "RV outperforms SSV at Re = 600, 800, 1000",
    "IV C",
    'IV C: "outperforms ... in all figures of merit in the new range of Reynolds values"',
)
def recycle_everywhere(tables: Tables) -> Finding:
    """Agrees if RV's median is larger beyond the scatter of networks; nearly if it is larger."""
    others = [case for case in tables.cases() if case != CASE]
    better = _pairs(tables, "f_score", case=others, neurons=2000)
    horizons = [_horizons_larger(tables, case, 2000) for case in others]
    ours = (
        f"F-score: {all_of(better)} ({len(better)} cases and prediction times), "
        f"PH_ee: {all_of(horizons)} ({len(horizons)} cases)"
    )
    return Finding("always", ours, all_of([*better, *horizons]))


# -- long-term statistics --------------------------------------------------------------------------


def _error(tables: Tables, metric: str, **of: Any) -> Any:
    return tables.row("statistics", metric, case=CASE, **of)


def _improves(tables: Tables, metrics: dict[str, str], digits: int) -> Finding:
    """Whether errors of each size lie below the training set's."""
    texts, holds, theirs = [], [], []
    for metric, title in metrics.items():
        ours = [_error(tables, metric, neurons=n, **RV) for n in tables.sizes(CASE)]
        training = _error(tables, metric, **TRAINING).p50
        holds += [_graded(row.p75 < training, nearly=row.p50 < training) for row in ours]
        values = ", ".join(f"{row.p50:.{digits}g}" for row in ours)
        texts.append(f"{values} (training set {training:.{digits}g})")
        published = published_value("statistics", metric, reynolds=400, **TRAINING)
        networks = published_rows("statistics", metric, reynolds=400, **RV)
        worse = networks["neurons"][networks["p50"] >= published]
        theirs += [f"the {title} of {size:g} neurons" for size in worse]
    why = "the error of the training set depends on the choice of ten series"
    if theirs:
        why += f"; by the authors' own files it fails for {' and '.join(theirs)}"
    agrees = all_of(holds)
    return Finding("at all sizes", "; ".join(texts), agrees, "" if agrees == "yes" else why)


@claim(
    "the density of k improves on the training set (Kantorovich metric; mean logarithmic error)",
    "V",
    'V: "the networks improve the statistics with respect to the training set in all cases"',
)
def density_improves(tables: Tables) -> Finding:
    """Agrees if each size's upper quartile is below the training set's; nearly if the median is."""
    return _improves(tables, DENSITY, 3)


@claim(
    "the density of k does not improve with size",
    "V",
    'V: "no significant improvement ... when increasing their size"; quartiles of figure 13 (b, c)',
)
def density_and_size(tables: Tables) -> Finding:
    """Agrees if no larger network's quartiles lie below a smaller one's."""
    sizes = tables.sizes(CASE)
    errors = [[_error(tables, metric, neurons=n, **RV) for n in sizes] for metric in DENSITY]
    pairs = [pair for of_metric in errors for pair in itertools.combinations(of_metric, 2)]
    better = [larger.p75 < smaller.p25 for smaller, larger in pairs]
    ours = (
        f"in {sum(better)} of {len(pairs)} pairs of sizes the larger one's quartiles are below the "
        "smaller one's"
    )
    return Finding("no significant improvement", ours, all_of(not larger for larger in better))


@claim(
    "profiles improve on the training set (NRMSE of u; u^2; uv)",
    "V",
    'V: "the ESN improves the statistics with respect to the available data"; figure 14 (d to f)',
)
def profiles_improve(tables: Tables) -> Finding:
    """Agrees if each size's upper quartile is below the training set's; nearly if the median is."""
    return _improves(tables, PROFILES, 2)


@claim(
    "the flow field improves less on the training set than the kinetic energy",
    "V",
    'V: "a smaller improvement in the statistics of the flowfield than in the statistics of the '
    'kinetic energy"',
)
def flow_improves_less(tables: Tables) -> Finding:
    """Agrees if errors of profiles fall by a smaller factor than the density's, at each size."""

    def theirs(metric: str, **network: Any) -> float:
        return published_value("statistics", metric, reynolds=400, **network)

    def factors(error: Callable[..., float], neurons: float) -> list[float]:
        """Geometric means of the errors of the training set over those of networks."""
        return [
            math.prod(
                error(metric, **TRAINING) / error(metric, neurons=neurons, **RV)
                for metric in metrics
            )
            ** (1 / len(metrics))
            for metrics in (PROFILES, DENSITY)
        ]

    ours = {
        n: factors(lambda metric, **of: float(_error(tables, metric, **of).p50), n)
        for n in tables.sizes(CASE)
    }
    texts = [f"{n}: {field:.2f} and {density:.2f}" for n, (field, density) in ours.items()]
    agrees = all_of(field < density for field, density in ours.values())
    sizes = published_rows("statistics", "kantorovich", reynolds=400, **RV)["neurons"]
    published = [factors(theirs, size) for size in sizes]
    less = sum(field < density for field, density in published)
    why = f"by the authors' own files at {less} of {len(published)} sizes"
    return Finding(
        "smaller than for the kinetic energy",
        f"profiles and density, by neurons: {', '.join(texts)}",
        agrees,
        "" if agrees == "yes" else why,
    )


# -- control ---------------------------------------------------------------------------------------


@claim(
    "exceedance under control, Re = 400 and 600, 1 and 2 LT ahead",
    "VI",
    "the authors' files, in our definition",
)
def exceedances(tables: Tables) -> Finding:
    """Agrees if our 95 % interval lies within the margin (2000 neurons, RV)."""
    paper, ours, verdicts, beyond = [], [], [], []
    for reynolds, time in itertools.product((400, 600), (1.0, 2.0)):
        where: dict[str, Any] = {"case": f"Re{reynolds}", "prediction_time_lt": time}
        exceedance = _exceedance(tables, "controlled", neurons=2000, **where, **RV)
        of = {"reynolds": reynolds, "neurons": 2000, "prediction_time_lt": time, **RV}
        theirs = published_value("control", "exceedance_controlled", **of)
        paper.append(f"{theirs:.4f}")
        ours.append(_with_ends(exceedance, 4))
        verdicts.append(
            verdict("exceedance under control", theirs, exceedance.low, exceedance.high)
        )
        perfect = tables.medians(
            "control", "exceedance_controlled", forecaster="equations", **where
        )
        if verdicts[-1] != "yes" and len(perfect) and perfect["p50"].iloc[0] > theirs:
            beyond.append(f"Re = {reynolds}, {time:g} LT ({perfect['p50'].iloc[0]:.4f})")
    why = "not in the text: the authors' files, in our definition"
    if beyond:
        why += f"; at {', '.join(beyond)} the true equations leave more than the paper's networks"
    return Finding(", ".join(paper), ", ".join(ours), all_of(verdicts), why)


@claim(
    "the shorter prediction time leaves less exceedance",
    "VI",
    'VI: "an improvement in the suppression of the tail as the prediction time decreases"',
)
def nearer_is_better(tables: Tables) -> Finding:
    """Agrees if the median is smaller beyond the scatter of networks; nearly if it is smaller."""
    left_of = tables.rows("control_percentiles", metric="exceedance_controlled", neurons=2000, **RV)
    texts, verdicts = [], []
    for case, pair in left_of.groupby("case", sort=False):
        near, far = (pair[pair["prediction_time_lt"] == time].iloc[0] for time in (1, 2))
        texts.append(f"{case}: {near.p50:.4f} and {far.p50:.4f}")
        verdicts.append(larger(far, near))
    return Finding("at all Re", ", ".join(texts), all_of(verdicts))


def _factor(factor: float) -> str:
    return f"{factor:.1f}" if math.isfinite(factor) else "the whole tail"


@claim(
    "extreme events become rarer by control, 1 and 2 LT ahead",
    "abstract, VII",
    'abstract: "decreases the occurrence of extreme events up to one order of magnitude"',
)
def rarer(tables: Tables) -> Finding:
    """Agrees if the exceedance is divided by 10 in some case; nearly if its median alone is."""
    texts, largest = [], []
    for time in (1.0, 2.0):
        factors = []
        for case in tables.cases():
            where = {"case": case, "neurons": 2000, "prediction_time_lt": time, **RV}
            free, left = (_exceedance(tables, s, **where) for s in ("uncontrolled", "controlled"))
            middle, low, high = (free.p50 / end for end in (left.p50, left.high, left.low))
            factors.append((middle, low, high, case))
        largest.append(max(factors))
        middle, low, high, case = largest[-1]
        texts.append(f"{time:g} LT ahead by {middle:.1f} ({low:.1f} to {high:.1f}, {case})")
    middle, low, *_ = max(largest)
    return Finding(
        "by up to one order of magnitude",
        f"divided at most {'; '.join(texts)}",
        _graded(low >= AN_ORDER, nearly=middle >= AN_ORDER),
        "far beyond the threshold the density decreases by more: next claim",
    )


@claim(
    "the density's tail decreases beyond k_e, 1 and 2 LT ahead",
    "VI",
    'VI: "the tail of the PDF decreases in all cases analysed by up to one order of magnitude"; '
    "figure 18",
)
def tail_decreases(tables: Tables) -> Finding:
    """Agrees if time above each level falls in all cases, and tenfold in some.

    The highest level is exceeded for a thousandth of the time without control.
    """
    largest: dict[Any, dict[str, float]] = {}
    smallest = math.inf
    densities = tables.rows("control_density", neurons=2000, **RV)
    for (case, time), bins in densities.groupby(["case", "prediction_time_lt"], sort=False):
        bins = bins[bins["low"] >= EVENT_THRESHOLD].sort_values("low", ascending=False)
        without, controlled = (
            (bins[f"density_{state}"] * (bins["high"] - bins["low"])).cumsum()
            for state in ("uncontrolled", "controlled")
        )
        ratios = (without / controlled)[without >= 1e-3]
        largest.setdefault(time, {})[str(case)] = ratios.max()
        smallest = min(smallest, ratios.min())
    texts, counts = [], []
    for time, by_case in sorted(largest.items()):
        cells = ", ".join(f"{_factor(ratio)} ({case})" for case, ratio in by_case.items())
        texts.append(f"{time:g} LT ahead up to {cells}")
        far = sum(ratio >= AN_ORDER for ratio in by_case.values())
        counts.append(f"{time:g} LT ahead at {far} of {len(by_case)}")
    most = max(ratio for by_case in largest.values() for ratio in by_case.values())
    return Finding(
        "in all cases, by up to one order of magnitude",
        f"time beyond a level is divided by {smallest:.1f} at least; {'; '.join(texts)}",
        all_of([smallest > 1, most >= AN_ORDER]),
        f"by {AN_ORDER:g} or more {', '.join(counts)} Reynolds numbers",
    )

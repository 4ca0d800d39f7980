"""Warning signs of weak results: each function tests for one and returns its findings.

What counts as a sign stands here, once, with its reason. None of them is an error: a finding is for
a person to look at.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray

EDGE_SHARE = 0.5
"""Of the networks of an ensemble with an optimum on the edge of what was searched: single optima
lie there by chance, the grid has points in its corners; most of them tell of a box too small."""

EDGE_TOLERANCE = 0.01
"""Of the width of the box, in logarithms: the optimiser's steps near the edge are not finer."""

FEW_EVENTS = 30
"""An average over so many events has a standard error of a fifth of their spread."""

FEW_POSITIVES = 30
"""A recall of one half has a standard error of 0.09 with so many positives, and F no better one."""

LOST_RUNS = 0.5
"""Share of long runs that leave the chaotic phase, from which the rest is a biased selection."""

DIVERGED_RUNS = 0.01
"""Of long runs: a flow of bounded energy has none that diverge."""

EXPONENT_DIFFERENCE = 0.1
"""Relative, from the published exponent: all times in Lyapunov times change by as much."""

OWN_EXPONENT_DIFFERENCE = 0.1
"""Relative, from an exponent that was estimated from series: the standard error of a neighbour
estimate (`burstcast.statistics.neighbour_divergence`)."""

OUTSIDE_BINS = 0.001
"""Of the samples of the observable: as much as tails hold that extreme events are about."""

UNRESOLVED_ENERGY = 2e-4
"""Share of the energy in the smallest scales. The turbulent flow of docs/sensors.md has 4e-5 with
wavenumbers up to 10, and 1e-3 up to 7, where it bursts twice as often."""

NOISE_OVER_INCREMENT = 1.0
"""Standard deviation of the noise over the root mean square of what a component changes by from one
sample to the next: beyond it, a step shows more noise than dynamics."""

TREND = 0.5
"""Drift of a component's mean over a record, in standard deviations of the component: the end of
the record then has another climate than the training series."""

TREND_ERRORS = 3.0
"""Standard errors that a drift must be from zero."""


@dataclass(frozen=True)
class Finding:
    """Finding of a test for a warning sign."""

    warning: str  #: which sign it is: the name of the function
    text: str  #: what was found, with the numbers


def optimum_on_edge(
    name: str, values: Sequence[float], low: float, high: float, negligible: float = 0.0
) -> list[Finding]:
    """Optima of an ensemble's networks on the edges of the search range, on a logarithmic scale.

    ``low``, ``high``: Bounds of the search, positive; if they are equal, there is no edge.
    ``negligible``: Value below which all values do the same: a lower bound there is no edge.
    """
    if not (len(values) and high > low):
        return []
    place = np.log(np.asarray(values) / low) / np.log(high / low)
    found = []
    for side, bound, there in (
        ("lower", low, place <= EDGE_TOLERANCE),
        ("upper", high, place >= 1.0 - EDGE_TOLERANCE),
    ):
        is_edge = side == "upper" or low > negligible
        if is_edge and there.mean() >= EDGE_SHARE:
            text = f"{name} at its {side} bound {bound:g} in {there.sum()} of {there.size} networks"
            found.append(Finding("optimum_on_edge", text))
    return found


def few_events(events: int, asked: int, threshold: float, largest: float) -> list[Finding]:
    """No events, or too few for averages over them.

    ``events``, ``asked``: Events that there are to forecast, and how many were asked for.
    ``threshold``, ``largest``: Threshold of an event, and largest value of the observable.
    """
    if largest < threshold:
        text = (
            f"no event: the threshold {threshold:g} is above all of the observable, {largest:.4g}"
        )
    elif events < min(FEW_EVENTS, asked):
        text = f"{events} events to forecast, {asked} were asked for"
    else:
        return []
    return [Finding("few_events", text)]


def few_positives(prediction_times_lt: Sequence[float], positives: Sequence[int]) -> list[Finding]:
    """Scores from few starting points that an event follows, by the prediction time."""
    few = [
        (time, count)
        for time, count in zip(prediction_times_lt, positives, strict=True)
        if count < FEW_POSITIVES
    ]
    if not few:
        return []
    times = ", ".join(f"{time:g}" for time, _ in few)
    least, most = min(count for _, count in few), max(count for _, count in few)
    counted = f"{least}" if least == most else f"{least} to {most}"
    return [Finding("few_positives", f"{counted} positives at {times} LT")]


def nothing_to_calibrate_with(washout_maxima: FloatArray, threshold: float) -> list[Finding]:
    """No starting point in the training series from which a forecast counts.

    ``washout_maxima``: Largest observable of the washout of each starting point, ``(points,)``.
    ``threshold``: Event threshold; a washout that reaches it is of no use for a forecast.
    """
    if (washout_maxima < threshold).any():
        return []
    text = (
        f"no calibration of probabilities: events are under way in the washouts of all "
        f"{len(washout_maxima)} starting points in the training series"
    )
    return [Finding("nothing_to_calibrate_with", text)]


def no_better_than_permanent_alarm(
    prediction_times_lt: Sequence[float], f_scores: Sequence[float], permanent: Sequence[float]
) -> list[Finding]:
    """F-scores that an alarm at every time has as well.

    ``f_scores``: Median F-scores of an ensemble at these times; NaN where they are undefined.
    ``permanent``: F-scores of a permanent alarm; NaN where nothing happened.
    """
    found = [
        (time, score, other)
        for time, score, other in zip(prediction_times_lt, f_scores, permanent, strict=True)
        if score <= other
    ]
    if not found:
        return []
    listed = ", ".join(f"{time:g} LT {score:.2f} ({other:.2f})" for time, score, other in found)
    text = f"F-scores no better than the F-scores of a permanent alarm, in brackets: {listed}"
    return [Finding("no_better_than_permanent_alarm", text)]


def lost_long_runs(lost: Sequence[float], diverged: Sequence[float]) -> list[Finding]:
    """Long runs that leave the chaotic phase, or diverge.

    ``lost``, ``diverged``: Shares of each network's runs that laminarise, settle or diverge, and
    that diverge.
    """
    found = []
    for shares, limit, what in (
        (np.asarray(diverged), DIVERGED_RUNS, "diverge"),
        (np.asarray(lost), LOST_RUNS, "leave the chaotic phase"),
    ):
        there = shares > limit
        if there.any():
            text = (
                f"in {there.sum()} of {there.size} forecasters, up to {shares.max():.0%} of the "
                f"long runs {what}"
            )
            found.append(Finding("lost_long_runs", text))
    return found


def ill_conditioned_readout(solvers: Sequence[str]) -> list[Finding]:
    """Ridge regressions that rounding has made indefinite (`burstcast.networks.readout`)."""
    indefinite = sum(solver != "cholesky" for solver in solvers)
    if not indefinite:
        return []
    text = f"the ridge regression of {indefinite} of {len(solvers)} networks is indefinite"
    return [Finding("ill_conditioned_readout", text)]


def exponents_differ(
    leading: tuple[float, float, float],
    growth: tuple[float, float, float],
    published: float | None,
) -> list[Finding]:
    """Leading Lyapunov exponents that contradict one another.

    ``leading``, ``growth``: By QR factorisation and by the growth of perturbations: mean, ends of
    the interval; NaN where it was not computed.
    """
    found = []
    # of measured series there is none by growth
    if np.isfinite(growth[0]) and max(leading[1], growth[1]) > min(leading[2], growth[2]):
        text = (
            f"by QR factorisation {leading[0]:.4g} ({leading[1]:.4g} to {leading[2]:.4g}), by the "
            f"growth of perturbations {growth[0]:.4g} ({growth[1]:.4g} to {growth[2]:.4g})"
        )
        found.append(Finding("exponents_differ", text))
    if published is not None and abs(leading[0] - published) > EXPONENT_DIFFERENCE * published:
        text = f"computed {leading[0]:.4g}, published {published:.4g}"
        found.append(Finding("exponents_differ", text))
    return found


def no_exponent(estimated: float) -> list[Finding]:
    """No Lyapunov exponent that could be estimated from series.

    ``estimated``: Leading Lyapunov exponent; NaN where the series show none.
    """
    if not np.isnan(estimated):
        return []
    text = (
        "the training series show no Lyapunov exponent: neighbouring states do not part, or none "
        "are found; scores count in the published Lyapunov time"
    )
    return [Finding("no_exponent", text)]


def own_exponents_differ(
    estimated: tuple[float, float, float], own: Sequence[float]
) -> list[Finding]:
    """An exponent estimated from series, the unit of time, that forecasters' own flows contradict.

    ``own``: Leading Lyapunov exponents of the own flows of an ensemble's forecasters; NaN where
    there is none.
    """
    known = np.asarray(own)[np.isfinite(own)]
    if not known.size or known.min() <= estimated[0] <= known.max():
        return []
    median = float(np.median(known))
    if median <= 0 or abs(median - estimated[0]) <= OWN_EXPONENT_DIFFERENCE * estimated[0]:
        return []
    text = (
        f"estimated from the series {estimated[0]:.4g} ({estimated[1]:.4g} to {estimated[2]:.4g}), "
        f"of forecasters' own flows {median:.4g} ({known.min():.4g} to {known.max():.4g} of "
        f"{known.size}). To count in the forecasters' exponent: "
        f"lyapunov: {{published_exponent: {median:.4g}}}"
    )
    return [Finding("own_exponents_differ", text)]


def no_chaos_learnt(estimated: float, own: Sequence[float]) -> list[Finding]:
    """Forecasters whose own flows are not chaotic: the median of their exponents is not positive.

    ``estimated``: Leading Lyapunov exponent that was estimated from the series. ``own``: Leading
    Lyapunov exponents of the own flows of an ensemble's forecasters; NaN where there is none.
    """
    known = np.asarray(own)[np.isfinite(own)]
    if not known.size or np.median(known) > 0:
        return []
    text = (
        f"the forecasters have learnt no chaos: the leading exponents of their own flows are "
        f"{known.min():.4g} to {known.max():.4g} (of {known.size}), estimated from the series "
        f"{estimated:.4g}"
    )
    return [Finding("no_chaos_learnt", text)]


def outside_bins(below: int, above: int, inside: int) -> list[Finding]:
    """Samples of the observable that no bin of its density holds."""
    samples = below + above + inside
    if not samples or (below + above) / samples <= OUTSIDE_BINS:
        return []
    text = f"{below / samples:.2%} of the observable below the bins, {above / samples:.2%} above"
    return [Finding("outside_bins", text)]


def noise_drowns_components(states: FloatArray, noise: float) -> list[Finding]:
    """Components that change less from sample to sample than the noise does.

    ``states``: Training series without noise, ``(series, time, component)``. ``noise``: Its
    standard deviation, in standard deviations of each component.
    """
    increments = np.sqrt(np.nanmean(np.diff(states, axis=1) ** 2, axis=(0, 1)))
    levels = noise * np.nanstd(states, axis=(0, 1))
    # a component that does not vary has no noise either
    drowned = np.flatnonzero(levels > NOISE_OVER_INCREMENT * increments)
    if not drowned.size:
        return []
    ratio = (levels[drowned] / np.maximum(increments[drowned], np.finfo(float).tiny)).max()
    names = ", ".join(map(str, drowned))
    text = f"component {names}: the noise is up to {ratio:.3g} times what it changes by in a sample"
    return [Finding("noise_drowns_components", text)]


def unresolved_flow(energy: FloatArray) -> list[Finding]:
    """Test whether a truncated flow has much energy in its smallest scales."""
    share = float(energy.mean())
    if share <= UNRESOLVED_ENERGY:
        return []
    text = f"the largest wavenumbers hold {share:.2g} of the energy: the flow is not resolved"
    return [Finding("unresolved_flow", text)]


def slow_trend(
    start: FloatArray, states: FloatArray, names: Sequence[str], training: int
) -> list[Finding]:
    """Components whose means drift over a record: straight lines through the means of its series.

    Means of neighbouring series are alike. The standard error of a slope is raised for that, by the
    correlation of each residual with the next, as for an autoregressive process of first order.

    ``start``: Time of the first sample of each series, ``(series,)``.
    """
    if len(start) < 4 or not np.ptp(start):
        return []
    time = (start - start.mean()) / np.ptp(start)
    means = np.nanmean(states, axis=1)
    slopes = time @ means / (time @ time)
    residuals = means - means.mean(axis=0) - np.outer(time, slopes)
    squares = np.sum(residuals**2, axis=0)
    lagged = np.sum(residuals[1:] * residuals[:-1], axis=0)
    # a line that fits exactly leaves nothing to correlate
    alike = np.clip(lagged / np.maximum(squares, np.finfo(float).tiny), 0.0, 0.99)
    error = np.sqrt(squares / (len(start) - 2) / (time @ time) * (1 + alike) / (1 - alike))
    drift = slopes / np.maximum(np.nanstd(states, axis=(0, 1)), np.finfo(float).tiny)
    strong = (np.abs(drift) >= TREND) & (np.abs(slopes) >= TREND_ERRORS * error)
    if not strong.any():
        return []
    listed = ", ".join(
        f"{names[one]} by {drift[one]:+.2g}" for one in np.flatnonzero(strong).tolist()
    )
    share = (start[training:].mean() - start[:training].mean()) / np.ptp(start)
    between = f", {share:.0%} of that from training to the others" if training < len(start) else ""
    text = f"means drift over the record, in standard deviations: {listed}{between}"
    return [Finding("slow_trend", text)]

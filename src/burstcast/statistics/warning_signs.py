"""Warning signs of weak results: each function tests for one and yields its findings, in words.

None of them is an error: a finding is for a person to look at.
"""

from collections.abc import Iterator, Sequence

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

INVALID_FORECASTS = 0.01
"""Share of forecasts, or of decisions: beyond it, divergence is a warning sign."""

EXPONENT_DIFFERENCE = 0.1
"""Relative, from the given exponent: all times in Lyapunov times change by as much."""

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


def optimum_on_edge(
    name: str, values: Sequence[float], low: float, high: float, negligible: float = 0.0
) -> Iterator[str]:
    """Optima of an ensemble's networks on the edges of the search range, on a logarithmic scale.

    If the bounds are equal, there is no edge; nor is a lower bound below a ``negligible`` value.
    """
    if not (len(values) and high > low):
        return
    place = np.log(np.asarray(values) / low) / np.log(high / low)
    for side, bound, there in (
        ("lower", low, place <= EDGE_TOLERANCE),
        ("upper", high, place >= 1.0 - EDGE_TOLERANCE),
    ):
        is_edge = side == "upper" or low > negligible
        if is_edge and there.mean() >= EDGE_SHARE:
            yield f"{name} at its {side} bound {bound:g} in {there.sum()} of {there.size} networks"


def few_events(events: int, asked: int, threshold: float, largest: float) -> Iterator[str]:
    """No events, or too few for averages over them."""
    if largest < threshold:
        yield f"no event: the threshold {threshold:g} is above all of the observable, {largest:.4g}"
    elif events < min(FEW_EVENTS, asked):
        yield f"{events} events to forecast, {asked} were asked for"


def few_positives(prediction_times_lt: Sequence[float], positives: Sequence[int]) -> Iterator[str]:
    """Scores from few starting points that an event follows, by the prediction time."""
    few = [
        (time, count)
        for time, count in zip(prediction_times_lt, positives, strict=True)
        if count < FEW_POSITIVES
    ]
    if not few:
        return
    times = ", ".join(f"{time:g}" for time, _ in few)
    least, most = min(count for _, count in few), max(count for _, count in few)
    counted = f"{least}" if least == most else f"{least} to {most}"
    yield f"{counted} positives at {times} LT"


def nothing_to_calibrate_with(washout_maxima: FloatArray, threshold: float) -> Iterator[str]:
    """No starting point whose largest washout observable is below the event threshold."""
    if not (washout_maxima < threshold).any():
        yield (
            f"no calibration of probabilities: events are under way in the washouts of all "
            f"{len(washout_maxima)} starting points in the training series"
        )


def no_better_than_permanent_alarm(
    prediction_times_lt: Sequence[float], f_scores: Sequence[float], permanent: Sequence[float]
) -> Iterator[str]:
    """Median F-scores of an ensemble that an alarm at every time has as well; NaN: undefined."""
    points = [
        (time, score, other)
        for time, score, other in zip(prediction_times_lt, f_scores, permanent, strict=True)
        if score <= other
    ]
    if not points:
        return
    listed = ", ".join(f"{time:g} LT {score:.2f} ({other:.2f})" for time, score, other in points)
    yield f"F-scores no better than the F-scores of a permanent alarm, in brackets: {listed}"


def invalid_forecasts(
    prediction_times_lt: Sequence[float], shares: Sequence[float]
) -> Iterator[str]:
    """Shares of an ensemble's forecasts that are invalid, by the prediction time; NaN: none."""
    many = [
        f"{time:g} LT {share:.2%}"
        for time, share in zip(prediction_times_lt, shares, strict=True)
        if share > INVALID_FORECASTS
    ]
    if many:
        yield f"forecasts that are not finite, or far outside of the training: {', '.join(many)}"


def fallback_decisions(shares: Sequence[float]) -> Iterator[str]:
    """Shares of the decisions of runs of control that no valid forecast stands behind."""
    many = np.asarray(shares)
    there = many > INVALID_FORECASTS
    if there.any():
        yield (
            f"in {there.sum()} of {there.size} runs of control, up to {many[there].max():.0%} of "
            "the decisions have no valid forecast: the fallback made them"
        )


def escaped_flows(shares: Sequence[float]) -> Iterator[str]:
    """Shares of the flows of runs of control that leave the range of floating-point numbers."""
    some = np.asarray(shares)
    there = some > 0
    if there.any():
        yield (
            f"in {there.sum()} of {there.size} runs of control, up to {some[there].max():.2g} of "
            "the flows leave the range of floating-point numbers under actuation, and do not count"
        )


def lost_long_runs(lost: Sequence[float], diverged: Sequence[float]) -> Iterator[str]:
    """Shares of each network's long runs that leave the chaotic phase, or diverge."""
    for shares, limit, what in (
        (np.asarray(diverged), DIVERGED_RUNS, "diverge"),
        (np.asarray(lost), LOST_RUNS, "leave the chaotic phase"),
    ):
        there = shares > limit
        if there.any():
            yield (
                f"in {there.sum()} of {there.size} forecasters, up to {shares.max():.0%} of the "
                f"long runs {what}"
            )


def ill_conditioned_readout(solvers: Sequence[str]) -> Iterator[str]:
    """Ridge regressions that rounding has made indefinite (`burstcast.networks.readout`)."""
    indefinite = sum(solver != "cholesky" for solver in solvers)
    if indefinite:
        yield f"the ridge regression of {indefinite} of {len(solvers)} networks is indefinite"


def exponents_differ(
    leading: tuple[float, float, float],
    growth: tuple[float, float, float],
    given: float | None,
) -> Iterator[str]:
    """Leading exponents by QR and by growth, with their intervals, that contradict one another."""
    # of measured series there is none by growth
    if np.isfinite(growth[0]) and max(leading[1], growth[1]) > min(leading[2], growth[2]):
        yield (
            f"by QR factorisation {leading[0]:.4g} ({leading[1]:.4g} to {leading[2]:.4g}), by the "
            f"growth of perturbations {growth[0]:.4g} ({growth[1]:.4g} to {growth[2]:.4g})"
        )
    if given is not None and abs(leading[0] - given) > EXPONENT_DIFFERENCE * given:
        yield f"computed {leading[0]:.4g}, given {given:.4g}"


def no_exponent(estimated: float) -> Iterator[str]:
    """No Lyapunov exponent that could be estimated from series: it is NaN."""
    if np.isnan(estimated):
        yield (
            "the training series show no Lyapunov exponent: neighbouring states do not part, or "
            "none are found; scores count in the given Lyapunov time"
        )


def own_exponents_differ(
    estimated: tuple[float, float, float], learnt: Sequence[float]
) -> Iterator[str]:
    """An estimate, the unit of time, that exponents of an ensemble's own flows contradict."""
    exponents = np.asarray(learnt)[np.isfinite(learnt)]
    if not exponents.size or exponents.min() <= estimated[0] <= exponents.max():
        return
    median = float(np.median(exponents))
    if median <= 0 or abs(median - estimated[0]) <= OWN_EXPONENT_DIFFERENCE * estimated[0]:
        return
    yield (
        f"estimated from the series {estimated[0]:.4g} ({estimated[1]:.4g} to {estimated[2]:.4g}), "
        f"of forecasters' own flows {median:.4g} ({exponents.min():.4g} to {exponents.max():.4g} "
        f"of {exponents.size}). To count in the forecasters' exponent: "
        f"lyapunov: {{given_exponent: {median:.4g}}}"
    )


def no_chaos_learnt(estimated: float, learnt: Sequence[float]) -> Iterator[str]:
    """Forecasters without chaos: the median exponent of their own flows is not positive."""
    exponents = np.asarray(learnt)[np.isfinite(learnt)]
    if not exponents.size or np.median(exponents) > 0:
        return
    yield (
        f"the forecasters have learnt no chaos: the leading exponents of their own flows are "
        f"{exponents.min():.4g} to {exponents.max():.4g} (of {exponents.size}), "
        f"estimated from the series {estimated:.4g}"
    )


def outside_bins(below: int, above: int, inside: int) -> Iterator[str]:
    """Samples of the observable that no bin of its density holds."""
    samples = below + above + inside
    if not samples or (below + above) / samples <= OUTSIDE_BINS:
        return
    yield f"{below / samples:.2%} of the observable below the bins, {above / samples:.2%} above"


def noise_drowns_components(states: FloatArray, noise: float) -> Iterator[str]:
    """Components of series that change less from sample to sample than the noise does.

    ``noise``: Its standard deviation, in standard deviations of each component.
    """
    increments = np.sqrt(np.nanmean(np.diff(states, axis=1) ** 2, axis=(0, 1)))
    levels = noise * np.nanstd(states, axis=(0, 1))
    # a component that does not vary has no noise either
    drowned = np.flatnonzero(levels > NOISE_OVER_INCREMENT * increments)
    if not drowned.size:
        return
    ratio = (levels[drowned] / np.maximum(increments[drowned], np.finfo(float).tiny)).max()
    names = ", ".join(map(str, drowned))
    yield f"component {names}: the noise is up to {ratio:.3g} times what it changes by in a sample"


def unresolved_flow(energy: FloatArray) -> Iterator[str]:
    """Test whether a truncated flow has much energy in its smallest scales."""
    share = float(energy.mean())
    if not share <= UNRESOLVED_ENERGY:
        yield f"the largest wavenumbers hold {share:.2g} of the energy: the flow is not resolved"


def slow_trend(
    start: FloatArray, states: FloatArray, names: Sequence[str], training: int
) -> Iterator[str]:
    """Components whose means drift over a record: straight lines through the means of its series.

    The standard error of a slope is raised by the correlation of each residual with the next, as
    for an autoregressive process of first order. ``start``: Time of the first sample,
    ``(series,)``.
    """
    if len(start) < 4 or not np.ptp(start):
        return
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
        return
    listed = ", ".join(
        f"{names[component]} by {drift[component]:+.2g}"
        for component in np.flatnonzero(strong).tolist()
    )
    share = (start[training:].mean() - start[:training].mean()) / np.ptp(start)
    between = f", {share:.0%} of that from training to the others" if training < len(start) else ""
    yield f"means drift over the record, in standard deviations: {listed}{between}"

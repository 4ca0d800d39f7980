"""Lyapunov exponents of a forecaster's own flow, by the QR method along its long runs.

The trajectories must not leave the chaotic phase, to which the exponents belong.
"""

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.resampling import (
    Estimate,
    bootstrap_weights,
    mean_with_interval,
    percentile_interval,
)
from burstcast.forecasters.base import Forecaster
from burstcast.systems.lyapunov import (
    LyapunovSpectrum,
    alignment_of,
    kaplan_yorke_dimension,
    tangent_growth,
)

RUNS_PER_BATCH = 8
"""Runs that are linearised side by side: bounds the memory, changes no result."""


def forecaster_spectrum(
    forecaster: Forecaster,
    washouts: FloatArray,
    steps: int,
    orthonormalisation_steps: int,
    exponents: int,
    sampling_interval: float,
    generator: np.random.Generator,
) -> LyapunovSpectrum:
    """Leading Lyapunov exponents of a forecaster along long runs, ``(runs, exponents)``.

    The perturbations align over the first quarter of a run (`alignment_of`). ``washouts``: Observed
    states up to the start of each run, ``(runs, steps, dimension)``. NaN for exponents that are
    missing (a forecaster has no more than components of its memory) or unresolved.
    """
    alignment = alignment_of(steps, orthonormalisation_steps)
    intervals = (steps - alignment) // orthonormalisation_steps
    if intervals < 1:
        raise ValueError(
            f"{steps} steps are too few for exponents with {orthonormalisation_steps} steps "
            "between two factorisations"
        )

    def advance(memory: FloatArray, tangent: FloatArray) -> tuple[FloatArray, FloatArray]:
        memory, columns = forecaster.advance_tangent(
            memory, np.ascontiguousarray(tangent.transpose(1, 2, 0)), orthonormalisation_steps
        )
        return memory, np.ascontiguousarray(columns.transpose(2, 0, 1))

    rates = [np.empty((0, exponents))]
    duration = intervals * orthonormalisation_steps * sampling_interval
    for start in range(0, len(washouts), RUNS_PER_BATCH):
        batch = washouts[start : start + RUNS_PER_BATCH]
        memory = forecaster.start(np.ascontiguousarray(batch.transpose(1, 2, 0)))
        size, runs = memory.shape
        tangent = generator.standard_normal((runs, size, min(exponents, size)))
        growth = tangent_growth(
            advance,
            memory,
            np.linalg.qr(tangent).Q,
            intervals,
            alignment_intervals=alignment // orthonormalisation_steps,
        )
        missing = np.full((runs, exponents - growth.shape[1]), np.nan)
        rates.append(np.concatenate([growth / duration, missing], axis=1))
    return LyapunovSpectrum(exponents=np.concatenate(rates), duration=duration)


def summarise(
    exponents: FloatArray, confidence: float, resamples: int, generator: np.random.Generator
) -> tuple[Estimate, tuple[float, float, float]]:
    """Average exponents ``(runs, exponents)`` over runs, with Student's intervals.

    Also the Kaplan-Yorke dimension of the mean exponents with the ends of its interval; it is no
    mean and has percentile bootstrap intervals over runs. NaN for exponents that are not known, and
    for intervals of a single run.
    """
    runs, count = exponents.shape
    unknown = np.full(count, np.nan)
    if runs < 2:
        mean = exponents[0] if runs else unknown
        nan = float("nan")
        return Estimate(mean, unknown, unknown), (kaplan_yorke_dimension(mean), nan, nan)
    estimate = mean_with_interval(exponents, confidence)
    samples = bootstrap_weights(runs, resamples, generator) @ exponents / runs
    dimensions = np.array([kaplan_yorke_dimension(sample) for sample in samples])
    low, high = percentile_interval(dimensions, confidence)
    return estimate, (kaplan_yorke_dimension(estimate.mean), low, high)

"""A test whether the observations of a washout are like those of the training series.

The first half of a washout is continued by the model, and compared with the second half. What the
errors are like is known from training series that the model has not learnt from (hindcasts): they
are those of its flow, its noise, and its own imperfection. Two numbers sum up the errors, in units
of their root mean square at each lead and component: their mean square, and the mean product of
neighbours in time. A washout is inconsistent if these two lie further from their mean over the
hindcasts, in the metric of their covariance, than a share of the hindcasts do. This share is the
rate of false alarms, whatever the kind is and however good (a rank test against a reference sample,
as a conformal prediction is: Vovk, Gammerman & Shafer, Algorithmic Learning in a Random World,
2005).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.left_out import LeftOut
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasts.probabilities import refitted_without
from burstcast.forecasts.windows import POINTS_PER_BATCH

LEAST_WASHOUT = 6
"""Samples of a washout that has two halves to compare."""
_LEAST_HINDCASTS = 40
"""Hindcasts without which there is no test."""
_HINDCASTS, _HINDCAST_SERIES = 400, 4
"""Hindcasts of a test, and series that are left out for them, where there are as many."""
ALPHA = 0.05
"""Rate of false alarms."""
_MANY = 0.2
"""Share of odd washouts beyond twice the rate of false alarms that users are warned of."""
_CHANCE = 0.01
"""Probability of as many odd washouts by chance, above which users are not warned."""


@dataclass(frozen=True)
class ConsistencyTest:
    """The errors of hindcasts of training series."""

    scale: FloatArray  #: root mean square errors, ``(leads, dimension)``
    centre: FloatArray  #: mean of the two numbers, ``(2,)``
    metric: FloatArray  #: inverse of their covariance, ``(2, 2)``
    distances: FloatArray  #: squared distances of the hindcasts, rising, ``(hindcasts,)``

    @classmethod
    def of(cls, errors: FloatArray) -> Self | None:
        """Test by errors of `hindcast_errors`, ``(points, leads, dimension)``.

        They are of washouts in series that the forecaster has not learnt from. None if too few are
        finite, or all are zero.
        """
        errors = errors[np.isfinite(errors).all(axis=(1, 2))]
        if len(errors) < _LEAST_HINDCASTS or not errors.any():
            return None
        scale = np.sqrt(np.square(errors).mean(axis=0))
        scale = np.where(scale > 0, scale, 1.0)
        numbers = _numbers(errors / scale)
        centre: FloatArray = numbers.mean(axis=0)
        metric = np.asarray(np.linalg.pinv(np.cov(numbers.T), hermitian=True), dtype=np.float64)
        return cls(scale, centre, metric, np.sort(_distances(numbers - centre, metric)))

    @classmethod
    def left_out(
        cls,
        forecaster: Forecaster,
        training: FloatArray,
        case: ForecastingCase,
        washouts: FloatArray,
        series: IntArray,
        left_out: Sequence[LeftOut] | None = None,
    ) -> Self | None:
        """Test by hindcasts of training series that a refitted forecaster has not learnt from.

        ``washouts``, ``series``: Washouts in training series, ``(points, steps, dimension)``, and
        the row of the series of each, ``(points,)``. Other arguments as of
        `burstcast.forecasts.probabilities.refitted_without`. None if washouts are too short for
        forecasts from their first halves, or hindcasts too few.
        """
        steps = washouts.shape[1]
        if len(training) < 2 or not starts_from_half(forecaster, washouts):
            return None
        errors: list[FloatArray] = []
        refits = refitted_without(forecaster, training, case, steps, series, left_out)
        for here, refitted in refits:
            errors.append(hindcast_errors(refitted, washouts[here]))
            if len(errors) >= _HINDCAST_SERIES and sum(map(len, errors)) >= _HINDCASTS:
                break
        return cls.of(np.concatenate(errors)) if errors else None

    def p_values(self, forecaster: Forecaster, washouts: FloatArray) -> FloatArray:
        """Share of the hindcasts of training series at least as odd as each one, ``(points,)``.

        Above zero; 0 only where the forecast of the second half is not finite.
        """
        errors = hindcast_errors(forecaster, washouts)
        with np.errstate(over="ignore", invalid="ignore"):
            apart = _distances(_numbers(errors / self.scale) - self.centre, self.metric)
        odder = len(self.distances) - np.searchsorted(self.distances, apart)
        return np.where(np.isfinite(apart), (1 + odder) / (1 + len(self.distances)), 0.0)

    def finding(self, p_values: FloatArray) -> Iterator[str]:
        """A sentence about washouts of which many more are odd than in the training series."""
        from scipy.special import bdtrc  # the module is read when a campaign is planned

        odd, count = int((p_values <= ALPHA).sum()), len(p_values)
        share = odd / max(1, count)
        # of few washouts, so many may be odd by chance
        if share > 2 * ALPHA + _MANY and bdtrc(odd - 1, count, ALPHA) < _CHANCE:
            yield (
                f"{share:.0%} of the washouts are unlike those of the training series ({ALPHA:.0%} "
                "there): the flow, its noise or the gain of a sensor differs from what the "
                "forecaster has learnt (scores_by_consistency, consistent)"
            )

    def record(self) -> dict[str, Any]:
        """Lists from which `restore` recreates the test."""
        return {name: np.asarray(values).tolist() for name, values in vars(self).items()}

    @classmethod
    def restore(cls, record: Mapping[str, Any]) -> Self:
        """Make a test from its record."""
        arrays: dict[str, Any]
        names = [entry.name for entry in fields(cls)]
        arrays = {name: np.array(record[name], dtype=np.float64) for name in names}
        shape = arrays["centre"].shape, arrays["metric"].shape, arrays["scale"].ndim
        if shape != ((2,), (2, 2), 2):
            raise ValueError("the test of consistency is none")
        return cls(**arrays)


def starts_from_half(forecaster: Forecaster, washouts: FloatArray) -> bool:
    """Whether washouts ``(points, steps, dimension)`` are long enough for `hindcast_errors`.

    Filters and past values may take more than the first half.
    """
    steps = washouts.shape[1]
    if steps < LEAST_WASHOUT:
        return False
    try:
        forecaster.start(np.ascontiguousarray(washouts[:1, : steps // 2].transpose(1, 2, 0)))
    except ValueError:
        return False
    return True


def hindcast_errors(forecaster: Forecaster, washouts: FloatArray) -> FloatArray:
    """Errors of forecasts of the second half of washouts from the first, ``(points, leads, ...)``.

    ``washouts``: ``(points, steps, dimension)``; NaN where a forecast is invalid.
    """
    half, parts = washouts.shape[1] // 2, []
    for first in range(0, max(1, len(washouts)), POINTS_PER_BATCH):
        some = washouts[first : first + POINTS_PER_BATCH]
        batch = np.ascontiguousarray(some.transpose(1, 2, 0))
        with np.errstate(over="ignore", invalid="ignore"):
            memory = forecaster.start(np.ascontiguousarray(batch[:half]))
            forecast = forecaster.valid(forecaster.advance(memory, len(batch) - half)[0])
            parts.append((forecast - batch[half:]).transpose(2, 0, 1))
    return np.concatenate(parts)


def rank_histogram(members: FloatArray, truth: FloatArray) -> FloatArray:
    """How often the truth has each rank among the members of an ensemble, ``(members + 1,)``.

    Level for a reliable ensemble (Hamill, Monthly Weather Review 129, 2001). ``members``:
    ``(members, points)``; points with a member that is not finite do not count. ``truth``:
    ``(points,)``.
    """
    sound = np.isfinite(members).all(axis=0)
    rank = (members[:, sound] < truth[sound]).sum(axis=0)
    return np.bincount(rank, minlength=len(members) + 1).astype(np.float64)


def spread_and_error(members: FloatArray, truth: FloatArray) -> tuple[float, float]:
    """Root mean square spread of an ensemble, and error of its mean.

    Both are equal for a reliable ensemble, whose spread counts the finite number of members
    (Fortin et al., Journal of Hydrometeorology 15, 2014). Arguments: as of `rank_histogram`.
    """
    count = len(members)
    sound = np.asarray(np.isfinite(members).all(axis=0))
    some = members[:, sound]
    if count < 2 or not sound.any():
        return float("nan"), float("nan")
    variance = (count + 1) / count * some.var(axis=0, ddof=1).mean()
    error = np.square(some.mean(axis=0) - truth[sound]).mean()
    return float(np.sqrt(variance)), float(np.sqrt(error))


def _numbers(errors: FloatArray) -> FloatArray:
    """Mean square, and mean product of neighbours in time, of scaled errors, ``(points, 2)``."""
    square = np.square(errors).mean(axis=(1, 2))
    neighbours = (errors[:, 1:] * errors[:, :-1]).mean(axis=(1, 2))
    square = np.maximum(square, np.finfo(float).tiny)
    # logarithms of squares are closer to normal
    return np.stack([np.log(square), neighbours / square], axis=1)


def _distances(numbers: FloatArray, metric: FloatArray) -> FloatArray:
    """Squared lengths of vectors ``(points, 2)``."""
    lengths: FloatArray = np.einsum("pi,ij,pj->p", numbers, metric, numbers)
    return lengths

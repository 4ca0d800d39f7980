"""Distances of long-term statistics from a reference, and their sampling floor.

Source: section "Statistical prediction of extreme events" of the paper; the sampling floor is ours.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import NUMBER, OBSERVABLE
from burstcast.statistics.densities import kantorovich_metric, mean_logarithmic_error
from burstcast.statistics.profiles import normalised_root_mean_square_error
from burstcast.statistics.reductions import LongTermStatistics, SeriesReductions
from burstcast.systems.mfe_modes import ProfileMatrices


@dataclass(frozen=True)
class StatisticsErrors:
    """Distances between two long-term statistics; NaN where one is not defined."""

    #: kantorovich metric of the observable's densities, in units of the observable
    kantorovich: float
    mean_log_error: float  #: mean logarithmic error of the densities
    #: nrmse_u, nrmse_uu, nrmse_uv: normalised root mean square errors of the profiles of u, u^2 and
    #: uv
    nrmse_u: float
    nrmse_uu: float
    nrmse_uv: float


def compare(
    reference: LongTermStatistics,
    candidate: LongTermStatistics,
    matrices: ProfileMatrices | None,
) -> StatisticsErrors:
    """Distances of a candidate from the reference, on the same bins; NaN without any states.

    ``matrices``: Of the flow's modes at equally spaced heights; None for a system without modes.
    """
    errors = [float("nan")] * 3
    if matrices is not None and candidate.moments.count > 0:
        moments = reference.moments, candidate.moments
        both = (matrices.profiles(each.mean, each.mean_product) for each in moments)
        errors = list(map(normalised_root_mean_square_error, *both))
    histograms = reference.histogram, candidate.histogram
    return StatisticsErrors(
        kantorovich_metric(*histograms), mean_logarithmic_error(*histograms), *errors
    )


def sampling_floor(
    series: SeriesReductions,
    matrices: ProfileMatrices | None,
    splits: int,
    generator: np.random.Generator,
    sample: int | None = None,
) -> list[StatisticsErrors]:
    """Measures between two independent parts of the true data: the scale of the sampling error.

    Whole series are drawn without replacement into a ``sample``, by default a half, which is
    compared with the series that are left. With a sample as large as a network's, the floor is what
    a perfect network would show against the data; between halves it is about twice that of a
    perfect network that ran for ever. The spread over splits, which share their data, is not the
    error of their mean.
    """
    size = len(series) // 2 if sample is None else sample
    if not 0 < size < len(series):
        raise ValueError(f"{len(series)} series cannot be split into {size} and the rest")
    measures = []
    for _ in range(splits):
        order = generator.permutation(len(series))
        measures.append(
            compare(
                series.merged(np.sort(order[size:])), series.merged(np.sort(order[:size])), matrices
            )
        )
    return measures


def floor_variables(splits: Sequence[StatisticsErrors]) -> dict[str, Variable]:
    """Variables of the file of a `sampling_floor`: each measure of each split."""
    numbers = Variable(("split",), np.arange(len(splits)), NUMBER, "random split of the data")
    return {
        "split": numbers,
        **{
            field.name: Variable(
                ("split",),
                np.array([getattr(measures, field.name) for measures in splits]),
                OBSERVABLE if field.name == "kantorovich" else NUMBER,
                f"{field.name} between the parts of the split",
            )
            for field in fields(StatisticsErrors)
        },
    }


def nearest(reference: LongTermStatistics, candidates: Sequence[LongTermStatistics]) -> int | None:
    """Position of the candidate with the smallest Kantorovich metric from the reference, if any."""
    distances = [
        kantorovich_metric(reference.histogram, candidate.histogram) for candidate in candidates
    ]
    if np.isnan(distances).all():
        return None
    return int(np.nanargmin(distances))


@dataclass(frozen=True)
class BestNetwork:
    """The network with the statistics nearest to the data's."""

    statistics: LongTermStatistics
    label: str  #: what figures call it


def best_network(
    reference: LongTermStatistics,
    networks: Mapping[tuple[int, int], LongTermStatistics],
) -> BestNetwork | None:
    """Network, of those of one size by neurons and seed, with the smallest Kantorovich metric."""
    best = nearest(reference, [*networks.values()])
    if best is None:
        return None
    which = f"best of {len(networks)}: " if len(networks) > 1 else ""
    neurons, seed = [*networks][best]
    label = f"ESN ({neurons} neurons, {which}seed {seed})"
    return BestNetwork(networks[neurons, seed], label)

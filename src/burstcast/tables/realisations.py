"""Scores of networks, over choices of the training series and over seeds."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from burstcast.data.training_realisations import realisation_of, variance_components


def scatter_of_families(
    scores: pd.DataFrame, kinds: Sequence[str], keys: Sequence[str], metrics: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """Rows of the scatter of each metric, of cases that differ by their training series only.

    ``kinds``: Kinds of forecasters: what stands for none, as the sampling floor does, has other
    rows than seeds. ``keys``: Key columns of an ensemble beside the key columns of its case.
    """
    bases = scores["case"].map(lambda case: realisation_of(case)[0])
    for base in dict.fromkeys(bases[bases != scores["case"]]):
        of_family = scores[bases == base]
        numbers = of_family.get("reynolds", pd.Series(dtype=np.float64)).dropna()
        reynolds = float(numbers.iloc[0]) if len(numbers) else None
        if reynolds is not None and reynolds.is_integer():
            reynolds = int(reynolds)
        of_family = of_family[of_family["forecaster"].isin(kinds)]
        for values, members in of_family.groupby(list(keys), dropna=False, sort=False):
            for metric in metrics:
                groups = [
                    of_set[metric].dropna().to_numpy(dtype=np.float64)
                    for _, of_set in members.groupby("case")
                ]
                scatter = variance_components(groups)
                yield {
                    "case": base,
                    "reynolds": reynolds,
                    **dict(zip(keys, values, strict=True)),
                    "metric": metric,
                    "mean": scatter.mean,
                    "standard_deviation_over_training_sets": scatter.between,
                    "standard_deviation_over_seeds": scatter.within,
                    "training_sets": scatter.groups,
                    "networks": scatter.values,
                }

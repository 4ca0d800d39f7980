"""What seeds hide: the scatter of scores over choices of the training series, and over seeds."""

from pathlib import Path
from typing import Any

import numpy as np

from burstcast.training_realisations import variance_components
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.tables import write_tables


@job
def separate_scatter(*, scores: list[str], tables: list[str], settings: Settings) -> None:
    """Write both standard deviations of each metric, by forecaster, size and strategy."""
    rows: list[dict[str, Any]] = []
    for path in scores:
        found, scattered = read_table(path), settings["scattered"][Path(path).stem]
        for family in settings["families"]:
            of_family = found[found["case"].isin(family["cases"])]
            # what stands for no forecaster, as the sampling floor does, has other rows than seeds
            of_family = of_family[of_family["forecaster"].isin(settings["kinds"])]
            keys = scattered["by"][2:]  # the case is that of the family
            for values, members in of_family.groupby(keys, dropna=False, sort=False):
                for metric in scattered["percentiles"]:
                    groups = [
                        one[metric].dropna().to_numpy(dtype=np.float64)
                        for _, one in members.groupby("case")
                    ]
                    scatter = variance_components(groups)
                    rows.append(
                        {
                            **family["keys"],
                            **dict(zip(keys, values, strict=True)),
                            "metric": metric,
                            "mean": scatter.mean,
                            "standard_deviation_over_training_sets": scatter.between,
                            "standard_deviation_over_seeds": scatter.within,
                            "training_sets": scatter.groups,
                            "networks": scatter.values,
                        }
                    )
    write_tables(tables, settings, training_realisations=rows)

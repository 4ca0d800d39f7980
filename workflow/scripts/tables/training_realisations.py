"""What seeds hide: the scatter of scores over choices of the training series, and over seeds."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from burstcast.data.training_realisations import realisation_of, variance_components
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.tables import write_tables
from burstcast_workflow.stages.canonical import canonical


@job
def separate_scatter(*, scores: list[str], tables: list[str], settings: Settings) -> None:
    """Write both standard deviations of each metric, by forecaster, size and strategy."""
    rows: list[dict[str, Any]] = []
    for path in scores:
        found, scattered = read_table(path), settings["scattered"][Path(path).stem]
        bases = found["case"].map(lambda case: realisation_of(case)[0])
        for base in dict.fromkeys(bases[bases != found["case"]]):
            of_family = found[bases == base]
            known = of_family.get("reynolds", pd.Series(dtype=np.float64)).dropna()
            reynolds = canonical(float(known.iloc[0])) if len(known) else None
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
                    )
    write_tables(tables, settings, training_realisations=rows)

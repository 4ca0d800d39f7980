"""What seeds hide: the scatter of scores over choices of the training series, and over seeds."""

from typing import Any

import numpy as np

from burstcast.training_realisations import variance_components
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table, write_rows
from burstcast_workflow.identifiers import KEYS
from burstcast_workflow.table_metrics import SUMMARIES


def separate_scatter(*, tables: list[str], table: str, settings: Settings) -> None:
    """Write both standard deviations of each metric, by forecaster, size and strategy."""
    rows: list[dict[str, Any]] = []
    for name, path in zip(settings["names"], tables, strict=True):
        summary, found = SUMMARIES[name], read_table(path)
        for family in settings["families"]:
            of_family = found[found["case"].isin(family["cases"])]
            # what stands for no forecaster, as the sampling floor does, has other rows than seeds
            of_family = of_family[of_family["forecaster"].isin(settings["kinds"])]
            keys = [*KEYS[2:-1], *summary.keys]
            for values, members in of_family.groupby(keys, dropna=False, sort=False):
                for metric in summary.metrics:
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
    write_rows(table, rows)


if __name__ == "__main__":
    run_job(snakemake, separate_scatter)  # noqa: F821 - Snakemake puts it there

"""Our percentiles beside the paper's published ones.

    python benchmarks/compare_with_paper.py results/paper

Prints a Markdown table for each kind of result that both have; docs/results.md is made of them.
"""

import sys
from pathlib import Path
from typing import Any

import pandas as pd

from burstcast.published import published_percentiles

PUBLISHED = Path(__file__).resolve().parent.parent / "resources" / "published_percentiles.csv"

TABLES = ("classification", "horizon", "hyperparameters", "statistics")
KEYS = ["reynolds", "forecaster", "neurons", "validation", "metric"]


def compare(results: Path) -> pd.DataFrame:
    """One row for each published percentile that the results have, too."""
    parts = [pd.DataFrame(columns=["table"])]
    for name in TABLES:
        path = results / "tables" / f"{name}_percentiles.csv"
        if not path.exists():
            continue
        keys = [*KEYS, *(["prediction_time_lt"] if name == "classification" else [])]
        paper = published_percentiles(pd.read_csv(PUBLISHED), name)
        both = paper.merge(pd.read_csv(path), on=keys, suffixes=("", "_ours"))
        rows = both.to_dict("records")
        parts.append(
            both[keys].assign(
                table=name,
                paper=[_range(row, "") for row in rows],
                ours=[_range(row, "_ours") for row in rows],
                networks=both["networks"],
            )
        )
    return pd.concat(parts, ignore_index=True)


def _range(row: dict[Any, Any], suffix: str) -> str:
    low, middle, high = (row[f"{name}{suffix}"] for name in ("p25", "p50", "p75"))
    return f"{middle:.4g}" if pd.isna(low) else f"{middle:.4g} ({low:.4g} to {high:.4g})"


def main() -> None:
    """Print the tables."""
    table = compare(Path(sys.argv[1]))
    for name, part in table.groupby("table", sort=False):
        print(f"\n### {name}\n")
        columns = [
            column for column in part.columns if column != "table" and not part[column].isna().all()
        ]
        print("| " + " | ".join(columns) + " |")
        print("|" + "---|" * len(columns))
        for row in part[columns].to_dict("records"):
            cells = ["" if pd.isna(value) else str(value) for value in row.values()]
            print("| " + " | ".join(cell.removesuffix(".0") for cell in cells) + " |")


if __name__ == "__main__":
    main()

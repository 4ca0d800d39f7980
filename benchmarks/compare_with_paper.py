"""Our percentiles beside the paper's published ones, in our definitions.

    python benchmarks/compare_with_paper.py results/paper

Prints a Markdown table for each kind of result that both have, and what lies outside our intervals
(`burstcast.published.compare` says what that means).
"""

import sys
from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from burstcast.published import compare, intervals_of_control
from burstcast_workflow.harness.tables import read_table

PUBLISHED = Path(__file__).resolve().parent.parent / "resources" / "published_percentiles.csv"

TABLES = ("classification", "horizon", "hyperparameters", "statistics", "control")
KEYS = ["case", "forecaster", "neurons", "validation", "prediction_time_lt", "metric"]


def comparison(results: Path) -> pd.DataFrame:
    """What of the tables of a campaign is published, too: `burstcast.published.compare`."""

    def tables(names: Iterable[str], ending: str) -> dict[str, pd.DataFrame]:
        paths = {name: results / "tables" / f"{name}{ending}.csv" for name in names}
        return {name: read_table(path) for name, path in paths.items() if path.exists()}

    intervals = tables(TABLES, "_intervals")
    control = tables(("control", "control_strategies"), "")
    if len(control) == 2:
        intervals["control"] = intervals_of_control(
            control["control_strategies"], control["control"]
        )
    return compare(read_table(PUBLISHED), tables(TABLES, "_percentiles"), intervals)


def _shown(rows: pd.DataFrame) -> pd.DataFrame:
    def range_of(prefix: str) -> list[str]:
        middle, low, high = (rows[f"{prefix}{name}"] for name in ("p50", "p25", "p75"))
        return [
            f"{value:.4g}" if pd.isna(first) else f"{value:.4g} ({first:.4g} to {last:.4g})"
            for value, first, last in zip(middle, low, high, strict=True)
        ]

    shown = rows[KEYS].assign(
        published=range_of("published_"),
        ours=range_of(""),
        networks=rows["networks"],
        interval=[
            "" if pd.isna(low) else f"{low:.4g} to {high:.4g}"
            for low, high in zip(rows["low"], rows["high"], strict=True)
        ],
        inside=rows["inside"].map({True: "yes", False: "no"}),
    )
    return shown.loc[:, shown.notna().any()]


def main() -> None:
    """Print the tables."""
    for kind, rows in comparison(Path(sys.argv[1])).groupby("kind", sort=False):
        shown = _shown(rows)
        print(f"\n### {kind}: {rows['inside'].sum()} of {rows['inside'].count()} inside\n")
        print("| " + " | ".join(shown.columns) + " |")
        print("|" + "---|" * len(shown.columns))
        for row in shown.itertuples(index=False):
            cells = ["" if pd.isna(value) else str(value) for value in row]
            print("| " + " | ".join(cell.removesuffix(".0") for cell in cells) + " |")


if __name__ == "__main__":
    main()

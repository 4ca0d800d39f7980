"""Our percentiles beside the paper's published ones.

    python benchmarks/compare_with_paper.py results/paper

Prints a Markdown table for each kind of result that both have; docs/results.md is made of them.
"""

import sys
from pathlib import Path

import pandas as pd

PUBLISHED = Path(__file__).resolve().parent.parent / "resources" / "published_percentiles.csv"

# published kind and metric -> our table and metric
KINDS = {
    "classification": ("classification", {}),
    "horizon": ("horizon", {"mean_prediction_horizon": "mean_horizon_lt"}),
    "hyper": ("hyperparameters", {"objective_log10_mse": "objective"}),
    "statistics": ("statistics", {"mle": "mean_log_error"}),
}


def compare(results: Path) -> pd.DataFrame:
    """One row for each published percentile that the results have, too."""
    rows = []
    for kind, published in pd.read_csv(PUBLISHED).groupby("kind", sort=False):
        if kind not in KINDS:
            continue
        name, metrics = KINDS[kind]
        path = results / "tables" / f"{name}_percentiles.csv"
        if not path.exists():
            continue
        ours = pd.read_csv(path)
        for row in published.to_dict("records"):
            match = ours[
                (ours["reynolds"] == row["reynolds"])
                & (ours["metric"] == metrics.get(row["metric"], row["metric"]))
            ]
            if row["validation"] == "TRAIN":
                match = match[match["forecaster"] == "training"]
            else:
                match = match[
                    (match["neurons"] == row["neurons"])
                    & (match["validation"] == row["validation"])
                ]
            if "prediction_time_lt" in match and not pd.isna(row["prediction_time"]):
                match = match[match["prediction_time_lt"] == row["prediction_time"]]
            for found in match.to_dict("records"):
                rows.append(
                    {
                        "kind": kind,
                        "neurons": row["neurons"],
                        "validation": row["validation"],
                        "PT": row["prediction_time"],
                        "metric": row["metric"],
                        "paper": _range(row),
                        "ours": _range(found),
                        "networks": found["networks"],
                    }
                )
    return pd.DataFrame(rows)


def _range(row: dict[str, float]) -> str:
    if pd.isna(row["p25"]):
        return f"{row['p50']:.4g}"
    return f"{row['p50']:.4g} ({row['p25']:.4g} to {row['p75']:.4g})"


def main() -> None:
    """Print the tables."""
    table = compare(Path(sys.argv[1]))
    for kind, part in table.groupby("kind", sort=False):
        print(f"\n### {kind}\n")
        columns = [column for column in part.columns[1:] if not part[column].isna().all()]
        print("| " + " | ".join(columns) + " |")
        print("|" + "---|" * len(columns))
        for row in part[columns].to_dict("records"):
            cells = ["" if pd.isna(value) else str(value) for value in row.values()]
            print("| " + " | ".join(cell.removesuffix(".0") for cell in cells) + " |")


if __name__ == "__main__":
    main()

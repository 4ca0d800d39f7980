"""Print scores of a finished campaign as a table in Markdown.

Usage: python scores.py RESULTS TIME..., with prediction times in Lyapunov times. Of networks, the
committee is shown; probabilities are calibrated. Each cell has a score and its confidence interval
over test series.
"""

import sys
from pathlib import Path

import pandas as pd

COLUMNS = ["brier_skill", "roc_area", "alarm_f_score"]

results, *times = sys.argv[1:]
scores = pd.read_csv(Path(results) / "tables" / "probability_scores.csv")
kept = scores[(scores["probability"] == "calibrated") & scores["metric"].isin(COLUMNS)]
kept = kept[kept["seed"].isna() & kept["prediction_time_lt"].isin(map(float, times))]
print("| source of alarms | LT |", " | ".join(COLUMNS), "|")
print("|---|---|", "---|" * len(COLUMNS), sep="")
for (time, alarm), rows in kept.groupby(["prediction_time_lt", "alarm"], sort=False):
    cells = rows.set_index("metric")[["value", "low", "high"]]
    written = [
        "" if pd.isna(value) else f"{value:z.2f} ({low:z.2f}\N{EN DASH}{high:z.2f})"
        for value, low, high in cells.reindex(COLUMNS).itertuples(index=False)
    ]
    print(f"| {alarm} | {time:g} |", " | ".join(written), "|")

"""F of crossings with a tolerance in time: an alarm a little too early or too late is no miss.

An event counts as forecast if the forecast has a crossing in the event's window, or in this window
moved to either side by the tolerance; an alarm is false if the flow has none in any of the three.
As in the table `classification`, starting points at which an event is under way are not scored.

::

    PYTHONPATH=examples/kolmogorov python examples/kolmogorov/tolerance.py RESULTS > tolerance.csv
"""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from burstcast.base.arrays import BoolArray
from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.forecasts.scores import ContingencyTable
from burstcast.forecasts.windows import WindowSummaries, crosses
from kolmogorov_flow import KolmogorovFlow

RESOLUTION_LT = 0.125
"""Length of the stored windows, and the tolerance, in Lyapunov times."""
PREDICTION_TIMES_LT = (0.5, 1.0, 1.5, 2.0)
_WINDOWS = round(1 / RESOLUTION_LT)
_THRESHOLD = float(str(KolmogorovFlow.case_defaults["event_threshold"]))


def crossings(summaries: WindowSummaries, time_lt: float, tolerance: int) -> list[BoolArray]:
    """Crossings in the window at a prediction time, and in those moved by the tolerance."""
    first = round(time_lt / RESOLUTION_LT) - 1
    moved = (0, -tolerance, tolerance) if tolerance else (0,)
    return [crosses(summaries, first + by, _WINDOWS, _THRESHOLD) for by in moved]


def rows_of(case: Path) -> Iterator[dict[str, Any]]:
    """Scores of each forecast of a case."""
    names = ("first", "largest", "series", "washout_maximum")
    arrays = read_netcdf(case / "evaluation_set.nc", *names)
    truth, series = WindowSummaries(arrays["first"], arrays["largest"]), arrays["series"]
    scored = arrays["washout_maximum"] < _THRESHOLD
    of_series = (series == np.unique(series)[:, None]) * scored.astype(np.int64)
    weights = bootstrap_weights(len(of_series), 1000, np.random.default_rng(0))
    always = WindowSummaries.always_crossing(truth.first.shape)
    forecasts = {"permanent_alarm": always}
    for path in sorted(case.glob("*/*/forecast.nc")):
        arrays = read_netcdf(path)
        if "first" in arrays:
            forecasts[path.parent.name] = WindowSummaries(arrays["first"], arrays["largest"])
    for forecaster, forecast in forecasts.items():
        for time_lt in PREDICTION_TIMES_LT:
            for tolerance in (0, 1):
                events = crossings(truth, time_lt, tolerance)
                alarms = crossings(forecast, time_lt, tolerance)
                event, near_event = events[0], np.any(events, axis=0)
                alarm, near_alarm = alarms[0], np.any(alarms, axis=0)
                outcomes = [event & near_alarm, alarm & ~near_event, event & ~near_alarm]
                outcomes.append(~np.any(outcomes, axis=0))
                counts = [of_series @ outcome for outcome in outcomes]
                scores = ContingencyTable(*(count.sum() for count in counts))
                samples = ContingencyTable(*(weights @ count for count in counts))
                low, high = percentile_interval(samples.f_score, 0.95)
                yield {
                    "case": case.name,
                    "forecaster": forecaster,
                    "prediction_time_lt": time_lt,
                    "tolerance_lt": tolerance * RESOLUTION_LT,
                    "base_rate": events[0][scored].mean(),
                    "f_score": float(scores.f_score),
                    "low": low,
                    "high": high,
                }


if __name__ == "__main__":
    results = Path(sys.argv[1])
    pd.DataFrame(list(rows_of(results / "invariants"))).to_csv(sys.stdout, index=False)

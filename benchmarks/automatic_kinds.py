"""Brier skill of ``kind="auto"`` beside the best single kind by hindsight, as a table in Markdown.

::

    python benchmarks/automatic_kinds.py RECORD ...

Records are those of benchmarks/default_forecasters.py, with fewer series, and sunspots and el_nino,
which statsmodels has (pip install statsmodels). Every kind that "auto" tries is fitted alone, and
scored on test series that nothing was chosen by; the best of them is the best by hindsight.
Networks have 100 neurons, two members and one search.
"""

import argparse
import time
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
from default_forecasters import SIMULATED, Record, record_of
from threadpoolctl import threadpool_limits

from burstcast import EventForecaster
from burstcast.event_forecaster.choice import KINDS

NETWORKS = {"neurons": 100, "members": 2, "searches": 1, "grid": 3, "bayesian_points": 3}
TRAINING = {"lorenz96": 8, "lorenz63": 8, "shear_flow": 4, "fitzhugh_nagumo": 6}
"""Training series of simulated records."""
TESTS = 20
"""Test series of simulated records."""


def sunspots() -> Record:
    """Yearly numbers of sunspots since 1700: two centuries train, one tests."""
    from statsmodels.datasets import sunspots as source

    states = source.load_pandas().data[["SUNACTIVITY"]].to_numpy(dtype=np.float64)
    settings = {"observable": 0, "event_threshold": {"quantile": 0.8}, "prediction_times": 2}
    settings |= {"window": 3, "start_spacing": 1, "calibration_spacing": 1}
    return Record("sunspots, 200 and 109 years", [states[:200], states[200:]], 1, settings)


def el_nino() -> Record:
    """Monthly temperature of the sea off Peru beside its mean of the month, with the season."""
    from statsmodels.datasets import elnino as source

    table = source.load_pandas().data.drop(columns="YEAR").to_numpy(dtype=np.float64)
    anomaly = (table - table[:40].mean(axis=0)).ravel()
    angle = 2 * np.pi * np.arange(len(anomaly)) / 12
    states = np.column_stack([anomaly, np.cos(angle), np.sin(angle)])
    settings = {"observable": 0, "event_threshold": {"quantile": 0.8}, "prediction_times": 3}
    settings |= {"window": 3, "start_spacing": 1, "calibration_spacing": 1}
    return Record("El Nino, 480 and 252 months", [states[:480], states[480:]], 1, settings)


def short_record(name: str) -> Record:
    """A record by its name, with few series of those that are simulated."""
    if name in (made := {"sunspots": sunspots, "el_nino": el_nino}):
        return made[name]()
    record = record_of(name)
    if name in SIMULATED:
        training, first = TRAINING[name], record.training
        states = np.asarray(record.series)
        series = np.concatenate([states[:training], states[first : first + TESTS]])
        record = replace(record, series=series, training=training)
    settings = {"prediction_times": 1.0, **record.settings}
    if name not in SIMULATED:  # durations in samples, of which a unit of the records has one or six
        samples = settings.pop("lyapunov_time") / settings.pop("sampling_interval", 1.0)
        for each in ("prediction_times", "washout", "start_spacing", "calibration_spacing"):
            settings[each] = round(settings[each] * samples)
        settings["window"] = round(samples)
    return replace(record, settings=settings)


def skill(record: Record, kind: str) -> tuple[EventForecaster, Any, float]:
    """Fitted forecaster, Brier skill of the test with its interval, and seconds of the fit."""
    forecaster = EventForecaster(kind=kind, **NETWORKS, **record.settings)
    begun = time.process_time()
    forecaster.fit(record.series[: record.training])
    seconds = time.process_time() - begun
    scores = forecaster.scores(record.series[record.training :], interval=True)
    return forecaster, scores["brier_skill"], seconds


def row(record: Record) -> str:
    """A row of the table: the choice, the best by hindsight, and what the choice loses."""
    skills = {}
    for kind in KINDS:
        try:
            _, skills[kind], seconds = skill(record, kind)
        except ValueError as error:
            print(f"# {kind}: {error}", flush=True)
        else:
            value, low, high = skills[kind]
            print(f"# {kind}: {value:.3f} ({low:.3f} to {high:.3f}), {seconds:.0f} s", flush=True)
    forecaster, chosen, seconds = skill(record, "auto")
    for trial in forecaster.choices_:
        print(f"#   {trial.kind}: {trial.brier_skill:.3f} ({trial.low:.3f} to {trial.high:.3f})")
    best = max(skills, key=lambda kind: skills[kind].value)
    value, low, high = skills[best]
    inside = "yes" if chosen.value >= low else "no"
    none = any(each.startswith("no kind beats") for each in forecaster.warnings_)
    verdict = ", with the warning that none beats the base rate" if none else ""
    return (
        f"| {record.title} | `{forecaster.kind_}`{verdict} | {chosen.value:.2f} | `{best}` | "
        f"{value:.2f} ({low:.2f} to {high:.2f}) | {value - chosen.value:.3f} | {inside} | "
        f"{seconds:.0f} |"
    )


def main() -> None:
    """Print a row for each record."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records", nargs="+")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    print(
        "| record | `auto` takes | Brier skill | best by hindsight | Brier skill | loss |", end=""
    )
    print(" within the interval | seconds |\n|---|---|---|---|---|---|---|---|", flush=True)
    with threadpool_limits(1):
        for name in given.records:
            print(row(short_record(name)), flush=True)


if __name__ == "__main__":
    main()

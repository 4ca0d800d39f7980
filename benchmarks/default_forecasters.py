"""Scores of `EventForecaster` with the library's defaults, as a table in Markdown.

::

    python benchmarks/default_forecasters.py [--kinds KIND ...] [--csv FILE] RECORD ...
    python benchmarks/default_forecasters.py table

Records are lorenz96, lorenz63, shear_flow and fitzhugh_nagumo, simulated with noise in all series,
and glucose.csv and fulda.csv as examples/real_records/extract.py writes them. Forecasters have
their defaults, but for those that a record in Lyapunov times of half an hour or a day needs. Scores
are of one test set at 1, 2 and 3 Lyapunov times; seconds are the processor's, of one thread.
benchmarks/default_forecasters.csv keeps the rows; "table" prints the first table of
benchmarks/measured.md from it.
"""

import argparse
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from burstcast import EventForecaster
from burstcast.base.arrays import FloatArray
from burstcast.data.dataset import component_scales, generate_ensemble, observed_series
from burstcast.data.records import measured_series
from burstcast.systems.fitzhugh_nagumo import FitzHughNagumoPair
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.lorenz96 import Lorenz96
from burstcast.systems.mfe import MoehlisFaisstEckhardt

TIMES = (1, 2, 3)
CLASSIFIERS = ("esn_direct", "precursor")
KINDS = ("esn", "nvar", "quadratic_filtered", *CLASSIFIERS)


@dataclass(frozen=True)
class Record:
    """Series, how many of them train, and settings of forecasters that know their unit of time."""

    title: str  #: name, size and sampling
    series: FloatArray | list[FloatArray]
    training: int
    settings: dict[str, Any]
    options: dict[str, dict[str, Any]] = field(default_factory=dict)  #: by kind


def noisy(states: FloatArray, noise: float) -> FloatArray:
    """Series as an observer sees them."""
    return observed_series(states, 0, noise, component_scales(states), 0, "defaults")


def energy(states: FloatArray) -> FloatArray:
    """Energy of states ``(..., component)`` of Lorenz 96."""
    return np.asarray(np.square(states).mean(axis=-1) / 2)


def lorenz96() -> Record:
    """Twenty series of forty Lyapunov times."""
    start = 8 + np.random.default_rng(0).normal(size=(10, 60))
    states = integrate(Lorenz96(variables=10), start, 0.01, 2000 + 3996, stride=4)[500:].transpose(
        2, 0, 1
    )
    settings = {"observable": energy, "lyapunov_time": 1 / 1.2, "sampling_interval": 0.04}
    title = "Lorenz 96, 10 variables, 20 x 1000 samples 0.04 apart, 1 % noise"
    return Record(title, noisy(states, 0.01), 20, settings)


def lorenz63() -> Record:
    """Twenty series of 22 Lyapunov times."""
    start = np.array([[1.0], [1.0], [20.0]]) + np.random.default_rng(0).normal(size=(3, 60))
    states = integrate(Lorenz63(), start, 0.01, 1000 + 2500, stride=2)[500:].transpose(2, 0, 1)
    settings = {"observable": 2, "event_threshold": 40.0, "lyapunov_time": 1 / 0.9056}
    title = "Lorenz 63, 20 x 1251 samples 0.02 apart, 1 % noise"
    return Record(title, noisy(states, 0.01), 20, {**settings, "sampling_interval": 0.02})


def shear_flow() -> Record:
    """Ten series of the paper's flow, without those that laminarise."""
    system, generator = MoehlisFaisstEckhardt(400.0), np.random.default_rng(0)
    start = np.zeros((9, 120))
    start[[0, 2]], start[3] = [[1.0], [0.07066]], -0.07076
    start[4] = 0.01 * generator.random(120)
    (batch,) = generate_ensemble(
        system,
        start,
        time_step=0.25,
        sampling_stride=4,
        transient_steps=800,
        kept_steps=16000,
        laminarisation_threshold=0.48,
    )
    settings = {"observable": system.observable, "event_threshold": 0.1}
    settings["observable"] = lambda states: system.observable(np.moveaxis(states, -1, 0))
    title = "shear flow, Re = 400, 10 x 4001 samples 1 apart, 1 % noise"
    settings |= {"lyapunov_time": 1 / 0.0163}
    return Record(title, noisy(batch.states[:50], 0.01), 10, settings)


def fitzhugh_nagumo() -> Record:
    """Twenty series of two coupled units."""
    start = np.zeros((4, 60))
    start[0] = 0.1 * np.random.default_rng(0).random(60)
    system = FitzHughNagumoPair()
    states = integrate(system, start, 0.5, 20000 + 24000, stride=4)[5000:].transpose(2, 0, 1)
    settings: dict[str, Any] = {"event_threshold": 0.6, "lyapunov_time": 1 / 0.00699}
    settings |= {"observable": lambda states: states[..., :2].mean(axis=-1)}
    title = "FitzHugh-Nagumo, 20 x 6001 samples 2 apart, 0.01 % noise"
    return Record(title, noisy(states, 0.0001), 20, {**settings, "sampling_interval": 2.0})


def glucose(path: str) -> Record:
    """Half days of one person; a unit of time is half an hour."""
    names = ["glucose", "current", "cycle_cos", "cycle_sin"]
    series = measured_series(path, "5 minutes", names, block=720, cut_gaps=True)
    settings = {"observable": lambda states: -states[..., 0], "event_threshold": -70.0}
    settings |= {"lyapunov_time": 30.0, "sampling_interval": 5.0, "washout": 2.0}
    options = {
        "esn_direct": {"start_spacing_lt": 0.5, "neurons": 300},
        "precursor": {"start_spacing_lt": 0.5, "classifier": "logistic", "lags_lt": (0.5, 1, 1.5)},
        "nvar": {},
        "quadratic_filtered": {"window_lt": 1.0},
    }
    settings |= {"start_spacing": 0.5, "calibration_spacing": 0.5}
    title = "glucose, 160 half days, samples 5 minutes apart, a unit of 30 minutes"
    return Record(title, series, 160, settings, options)


def fulda(path: str) -> Record:
    """Quarters of a river; a unit of time is a day."""
    names = ["q = log(discharge)", "wet = log(1 + rain)", "temperature", "cycle_cos", "cycle_sin"]
    series = measured_series(path, "1 day", names, block=90)
    settings = {"observable": lambda states: np.exp(states[..., 0]), "washout": 7.0}
    settings |= {"event_threshold": {"quantile": 0.9}, "lyapunov_time": 1.0}
    settings |= {"start_spacing": 1.0, "calibration_spacing": 1.0}
    options = {
        "esn_direct": {"start_spacing_lt": 1.0, "neurons": 300},
        "precursor": {"start_spacing_lt": 1.0, "classifier": "logistic", "lags_lt": (1, 2, 4)},
        "quadratic_filtered": {"window_lt": 1.0},
    }
    title = "Fulda, 20 quarters, samples a day apart, a unit of a day"
    return Record(title, series, 20, settings, options)


SIMULATED: dict[str, Callable[[], Record]] = {
    record.__name__: record for record in (lorenz96, lorenz63, shear_flow, fitzhugh_nagumo)
}


def record_of(name: str) -> Record:
    """Record by the name of a system or by the path of a table."""
    if name in SIMULATED:
        return SIMULATED[name]()
    return {"glucose": glucose, "fulda": fulda}[Path(name).stem](name)


KEPT = Path(__file__).with_suffix(".csv")


def scored(record: Record, kind: str) -> dict[str, Any]:
    """Scores of a forecaster, and the seconds of its fit."""
    options = record.options.get(kind)
    forecaster = EventForecaster(
        kind=kind, prediction_times=TIMES, options=options, **record.settings
    )
    start = time.process_time()
    forecaster.fit(record.series[: record.training])
    seconds = time.process_time() - start
    scores = [forecaster.scores(record.series[record.training :], at) for at in TIMES]
    names = ("alarm_f_score", "brier_skill", "permanent_f_score")
    return {
        "record": record.title[:1].upper() + record.title.partition(",")[0][1:],
        "forecaster": kind,
        "events": scores[0]["events"],
        **{
            f"{name}_{at}": score[name]
            for name in names
            for at, score in zip(TIMES, scores, strict=True)
        },
        "seconds": seconds,
        "warnings": len(forecaster.warnings_),
    }


def cells(row: Mapping[str, Any], name: str) -> str:
    """A score at all prediction times."""
    return " ".join(f"{row[f'{name}_{at}']:z.2f}" for at in TIMES)


def table(rows: pd.DataFrame) -> str:
    """Markdown of kept rows, with the permanent alarm of each record."""
    lines = ["| series | forecaster | F-score | Brier skill | seconds |", "|---|---|---|---|---|"]
    for record, of_record in rows.groupby("record", sort=False):
        each = of_record.to_dict("records")
        permanent = cells(each[0], "permanent_f_score")
        lines.append(f"| {record} | always-alarm forecast | {permanent} | | |")
        for row in each:
            name = f"`{row['forecaster']}`" + ", the default" * (row["forecaster"] == "esn")
            scores = " | ".join(cells(row, score) for score in ("alarm_f_score", "brier_skill"))
            lines.append(f"| | {name} | {scores} | {row['seconds']:.0f} |")
    return "\n".join(lines)


def main() -> None:
    """Print a table for each record, or that of all kept rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records", nargs="+")
    parser.add_argument("--kinds", nargs="+", default=KINDS)
    parser.add_argument("--csv", type=Path)
    given = parser.parse_args()
    if given.records == ["table"]:
        print(table(pd.read_csv(KEPT)))
        return
    warnings.simplefilter("ignore")
    rows = []
    for name in given.records:
        record = record_of(name)
        print(f"\n{record.title}\n")
        print("| forecaster | F | Brier skill | seconds |\n|---|---|---|---|")
        for kind in given.kinds:
            row = scored(record, kind)
            rows.append(row)
            permanent = cells(row, "permanent_f_score")
            print(f"# {kind}: always alarm {permanent}, {row['events']} events", end="")
            print(f", {row['warnings']} warnings")
            scores = " | ".join(cells(row, score) for score in ("alarm_f_score", "brier_skill"))
            print(f"| {kind} | {scores} | {row['seconds']:.1f} |", flush=True)
            if given.csv:
                pd.DataFrame(rows).to_csv(given.csv, index=False, float_format="%.6g")


if __name__ == "__main__":
    main()

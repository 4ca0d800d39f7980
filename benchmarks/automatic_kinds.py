"""Brier skill of ``kind="auto"`` beside the best single kind by hindsight, as a table in Markdown.

::

    python benchmarks/automatic_kinds.py [--kinds KIND ...] RECORD ...

Records are those of benchmarks/default_forecasters.py, and sunspots and el_nino, which statsmodels
has (pip install statsmodels). Every kind that "auto" tries is scored on test series that nothing
was chosen by; the best of them is the best by hindsight. Networks have 100 neurons, two members and
one search. The record of sunspots or El Nino is cut into six blocks, of which four train, in all 15
ways; ``sunspots:11`` has a washout of 11 samples.
"""

import argparse
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from default_forecasters import Record, record_of
from threadpoolctl import threadpool_limits

from burstcast import EventForecaster
from burstcast.base.arrays import FloatArray
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.data.starting_points import SeriesPoints
from burstcast.event_forecaster.choice import KINDS, best_kind, findings, tried
from burstcast.event_forecaster.score_intervals import blocks_of

NETWORKS = {"neurons": 100, "members": 2, "searches": 1, "grid": 3, "bayesian_points": 3}
BLOCKS, TRAINING_BLOCKS = 6, 4
"""Parts of a single record, and how many of them train."""
RESAMPLES, CONFIDENCE = 2000, 0.95


@dataclass(frozen=True)
class Comparison:
    """The choice and the kinds by hindsight, in one test."""

    chosen: str
    warned: bool  #: whether a warning says that no kind beats the base rate
    events: int  #: starting points of the test that an event follows
    points: int  #: starting points of the test
    skills: Mapping[str, FloatArray]  #: Brier skill, then resampled, ``(1 + resamples,)``, by kind
    seconds: float  #: of all fits

    @property
    def best(self) -> str:
        """Best kind by hindsight."""
        return max(self.skills, key=lambda kind: self.skills[kind][0])

    def interval(self, kind: str) -> str:
        """Skill of a kind with its interval."""
        low, high = percentile_interval(self.skills[kind][1:], CONFIDENCE)
        return f"{self.skills[kind][0]:.2f} ({low:.2f} to {high:.2f})"

    def inside(self) -> bool:
        """Whether the skill of the choice lies within the interval of the best."""
        low, _ = percentile_interval(self.skills[self.best][1:], CONFIDENCE)
        return bool(self.skills[self.chosen][0] >= low)


def sunspots() -> tuple[str, list[FloatArray]]:
    """Yearly numbers of sunspots, 1700 to 2008."""
    from statsmodels.datasets import sunspots as source

    states = source.load_pandas().data[["SUNACTIVITY"]].to_numpy(dtype=np.float64)
    return "Sunspots, six blocks of 51 years", np.array_split(states, BLOCKS)


def el_nino() -> tuple[str, list[FloatArray]]:
    """Monthly temperature of the sea off Peru beside its mean of the month, with the season."""
    from statsmodels.datasets import elnino as source

    table = source.load_pandas().data.drop(columns="YEAR").to_numpy(dtype=np.float64)
    anomaly = (table - table.mean(axis=0)).ravel()
    angle = 2 * np.pi * np.arange(len(anomaly)) / 12
    states = np.column_stack([anomaly, np.cos(angle), np.sin(angle)])
    return "El Nino, six blocks of ten years", np.array_split(states, BLOCKS)


SPLIT = {"sunspots": (sunspots, 2.0), "el_nino": (el_nino, 3.0)}
"""Records that are split, and their prediction times in samples."""


def records(name: str) -> Iterator[Record]:
    """A record by its name, with a prediction time of one Lyapunov time, or its splits."""
    name, _, washout = name.partition(":")
    if name not in SPLIT:
        record = record_of(name)
        yield replace(record, settings={"prediction_times": 1.0, **record.settings})
        return
    source, ahead = SPLIT[name]
    title, blocks = source()
    settings: dict[str, Any] = {"event_threshold": {"quantile": 0.8}, "prediction_times": ahead}
    settings |= {"window": 3, "start_spacing": 1, "calibration_spacing": 1}
    if washout:
        title += f", a washout of {washout}"
        settings["washout"] = int(washout)
    for training in combinations(range(BLOCKS), TRAINING_BLOCKS):
        others = [number for number in range(BLOCKS) if number not in training]
        series = [blocks[number] for number in (*training, *others)]
        yield Record(title, series, TRAINING_BLOCKS, settings)


def compared(record: Record, kinds: Sequence[str]) -> Comparison | None:
    """Fit all kinds, choose as "auto" does, and score all in the test; None without an event."""
    forecaster = EventForecaster(kind="auto", **NETWORKS, **record.settings)
    begun = time.process_time()
    fitted, of_training, trials = tried(forecaster, record.series[: record.training], None, kinds)
    seconds = time.process_time() - begun
    for trial in trials:
        told = f"{trial.brier_skill:.3f} ({trial.low:.3f} to {trial.high:.3f})"
        print(f"#   {trial.kind}: {trial.remark or told} {trial.adapted}", flush=True)
    chosen = best_kind(of_training)
    warned = any("no kind beats" in text for text in findings(trials, chosen, 0))
    skills = {}
    for kind, each in fitted.items():
        made = each.outcomes(record.series[record.training :])
        if not made.happened.any():
            print(f"# no event follows any of {len(made.happened)} starting points", flush=True)
            return None
        blocks = blocks_of(SeriesPoints(made.series, _steps(made, each)), _reach(each))
        rate = made.happened.mean()
        sums = [
            np.bincount(blocks, weights=errors)
            for errors in ((made.probability - made.happened) ** 2, (rate - made.happened) ** 2)
        ]
        weights = bootstrap_weights(len(sums[0]), RESAMPLES, np.random.default_rng(0))
        weights = np.concatenate([np.ones((1, len(sums[0]))), weights])
        errors, reference = (weights @ each for each in sums)
        with np.errstate(divide="ignore", invalid="ignore"):
            skills[kind] = np.nan_to_num(1 - errors / reference, nan=0.0, neginf=0.0)
        print(f"#   {kind} in the test: {skills[kind][0]:.3f}", flush=True)
    return Comparison(chosen, warned, int(made.happened.sum()), len(made.happened), skills, seconds)


def _steps(made: Any, forecaster: EventForecaster) -> Any:
    return np.round(made.time / forecaster._timing.sampling_interval).astype(int)


def _reach(forecaster: EventForecaster) -> int:
    return forecaster._timing.boundaries[-1]


def row(record: Record, made: Comparison) -> str:
    """A row of the table: the choice, the best by hindsight, and what the choice loses."""
    loss = made.skills[made.best] - made.skills[made.chosen]
    low, high = percentile_interval(loss[1:], CONFIDENCE)
    verdict = ", warned" if made.warned else ""
    return (
        f"| {record.title.partition(', ')[0]} | {made.events} of {made.points} | "
        f"`{made.chosen}`{verdict} | {made.interval(made.chosen)} | `{made.best}` | "
        f"{made.interval(made.best)} | {loss[0]:.3f} ({low:.3f} to {high:.3f}) | "
        f"{'yes' if made.inside() else 'no'} | {made.seconds:.0f} |"
    )


def row_of_splits(title: str, splits: list[Comparison]) -> str:
    """A row of another table: means over splits, and how often the choice is inside."""
    kinds = [kind for kind in KINDS if all(kind in made.skills for made in splits)]
    means = {kind: np.mean([made.skills[kind][0] for made in splits]) for kind in kinds}
    best = max(means, key=lambda kind: means[kind])
    losses = [made.skills[best][0] - made.skills[made.chosen][0] for made in splits]
    times = {made.chosen: sum(each.chosen == made.chosen for each in splits) for made in splits}
    chosen = ", ".join(f"`{kind}` {number}" for kind, number in sorted(times.items()))
    mean = np.mean([made.skills[made.chosen][0] for made in splits])
    low, high = np.percentile(losses, [10, 90])
    return (
        f"| {title} | {np.mean([made.events for made in splits]):.0f} of "
        f"{np.mean([made.points for made in splits]):.0f} | {chosen} | "
        f"{sum(made.warned for made in splits)} | {mean:.2f} | `{best}` | {means[best]:.2f} | "
        f"{np.mean(losses):.3f} ({low:.3f} to {high:.3f}) | "
        f"{sum(made.inside() for made in splits)} of {len(splits)} |"
    )


def main() -> None:
    """Print a row for each record."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records", nargs="+")
    parser.add_argument("--kinds", nargs="+", default=KINDS)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    with threadpool_limits(1):
        for name in given.records:
            splits = list(records(name))
            made = []
            for record in splits:
                if (each := compared(record, given.kinds)) is not None:
                    made.append(each)
                    print(f"{'# ' if len(splits) > 1 else ''}{row(record, each)}", flush=True)
            if len(splits) > 1:
                print(row_of_splits(splits[0].title, made), flush=True)


if __name__ == "__main__":
    main()

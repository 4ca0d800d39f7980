"""The best kind of forecaster for a case of a campaign, before the campaign runs.

::

    burstcast choose RESULTS CASE [--kinds analogues,esn]

``snakemake --configfile ... -- RESULTS/CASE/ensemble.nc`` makes the series of the case before.
The kinds of ``EventForecaster(kind="auto")`` are fitted to the training series of the case, with
its observable, threshold, washout and prediction times, and scored by series that were left out.
"""

import sys
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.event_forecaster.choice import KINDS, Trial
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.systems.base import DynamicalSystem
from burstcast_workflow.harness.settings import JobSettings, at
from burstcast_workflow.jobs.cases import Clock, Sampling, System
from burstcast_workflow.opened import OpenedCampaign


class Choosing(JobSettings):
    """What the choice reads of a config."""

    system: System
    sampling: Sampling
    clock: Clock
    random_seed: int = at("random_seed")
    training_series: int = at("case.training.series")
    washout_lt: float = at("washout_lt")
    event_threshold: Any = at("case.event_threshold")
    prediction_times_lt: list[float] = at("classification.prediction_times_lt")
    window_lt: float = at("classification.window_lt")

    def unfitted(self, kinds: Sequence[str]) -> EventForecaster:
        """Unfitted forecaster of the case, whose durations are in Lyapunov times."""
        space = self.system.space

        def observable(states: FloatArray) -> FloatArray:
            return np.asarray(space.observable(np.moveaxis(states, -1, 0)))

        return EventForecaster(
            space if isinstance(space, DynamicalSystem) else observable,
            self.event_threshold,
            kind="auto",
            options={"kinds": list(kinds)},
            prediction_times=tuple(self.prediction_times_lt),
            window=self.window_lt,
            washout=self.washout_lt,
            lyapunov_time=self.clock.lyapunov_time * self.sampling.interval,
            sampling_interval=self.sampling.interval,
            sampling_stride=self.sampling.stride,
            random_seed=self.random_seed,
        )


def main(results: Path, case: str, kinds: str | None) -> int:
    """Print a table of all kinds and the choice; returns 1 where nothing can be chosen."""
    try:
        opened = OpenedCampaign(results)
        series = opened.series(case, 0, opened.training_series(case))
        settings = opened.settings(case, Choosing)
        forecaster = settings.unfitted(kinds.split(",") if kinds else KINDS)
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_: print(message, file=sys.stderr)
            forecaster.fit(series)
    except (ValueError, TypeError) as error:
        print(error, file=sys.stderr)
        return 1
    print("\n".join(table(forecaster.choices_, forecaster.kind_)))
    return 0


def table(trials: Sequence[Trial], chosen: str) -> Iterator[str]:
    """Lines of a table of what was tried."""
    width = max(len(trial.kind) for trial in trials)
    yield f"{'kind':{width}}  Brier skill  95 % interval   seconds"
    for trial in trials:
        if trial.remark:
            yield f"{trial.kind:{width}}  not fitted: {trial.remark}"
            continue
        interval = f"{trial.low:.3f} to {trial.high:.3f}"
        mark = "  chosen" if trial.kind == chosen else ""
        yield (
            f"{trial.kind:{width}}  {trial.brier_skill:11.3f}  {interval:>15}  "
            f"{trial.seconds:8.1f}{mark}"
        )
    yield from (trial.adapted for trial in trials if trial.adapted)

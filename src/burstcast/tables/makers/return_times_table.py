"""Return times of levels of the observable, in long runs with and without control."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from burstcast.base.declared import at, declaring, gathered
from burstcast.control.long_run import LongRunCounts
from burstcast.statistics.return_times import return_times
from burstcast.tables.cells import with_ends
from burstcast.tables.makers._control_runs import keys_of
from burstcast.tables.makers.registry import Gathered, Rows

COUNTS = tuple(field.name for field in fields(LongRunCounts))


@declaring
def make(
    *,
    runs: Sequence[Gathered] = gathered("long_runs/long_run.nc", " ".join(COUNTS)),
    noise: float = at("case.training.noise"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """A row for each long run and level; flows are the blocks of the dispersion."""
    rows: Rows = []
    for run in runs:
        counts = LongRunCounts(**{name: run.content[name] for name in COUNTS})
        times = counts.steps / int(run.content["steps_per_lyapunov_time"])
        found = return_times(counts.events, times, counts.level, confidence)
        steps = int(counts.steps.sum())
        of_run = {
            **keys_of(run, noise),
            "flows": len(counts.steps),
            "lyapunov_times": found.time,
            "laminarisations": int(counts.laminarisations.sum()),
            "escapes": int(counts.escapes.sum()),
            "control_fraction": float(counts.actuated_steps.sum() / steps),
        }
        # without an event there is neither a return time nor an upper end
        ends = (np.where(np.isfinite(end), end, np.nan) for end in (found.return_time, found.high))
        exceedance = counts.exceeding.sum(axis=0) / steps
        columns = (counts.level, found.events, *ends, found.low, found.dispersion, exceedance)
        rows += [
            {
                **of_run,
                "return_level": float(level),
                "events": int(events),
                **with_ends("return_time", float(time), float(low), float(high)),
                "dispersion": float(dispersion),
                "independent": not clustered,
                "exceedance": float(share),
            }
            for level, events, time, high, low, dispersion, share, clustered in zip(
                *columns, found.clustered, strict=True
            )
        ]
    return {"return_times": rows}

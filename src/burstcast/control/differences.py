"""Comparisons of runs of control that differ by forecaster or strategy.

Runs are compared on the same flows, resampled alike: effects of the choice of flows on both runs
cancel, and the interval of a difference is narrower than the intervals of the runs suggest.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from burstcast.arrays import IntArray
from burstcast.control.records import Span
from burstcast.statistics.resampled_score import ResampledScore

COMPARED = ("relative_exceedance", "control_fraction")
"""Scores whose differences are computed: remaining exceedance and costs."""


@dataclass(frozen=True)
class ComparedRun:
    """Flows, identity and scores of a run that is compared."""

    forecaster: str | None  #: None for strategies without forecasts
    strategy: str  #: strategy, with all settings and conditions
    rows: IntArray  #: rows of its flows, ``(flows,)``
    span: Span
    #: scores of `burstcast.control.records.score_flows`; `COMPARED` at least
    scores: Mapping[str, ResampledScore]

    def is_comparable(self, other: "ComparedRun") -> bool:
        """Whether two runs share their flows, and differ by forecaster or strategy, not by both.

        Runs without a forecaster are compared with all others.
        """
        alike = self.strategy == other.strategy or self.forecaster == other.forecaster
        somebody = None not in (self.forecaster, other.forecaster)
        same_flows = self.span == other.span and np.array_equal(self.rows, other.rows)
        return same_flows and (alike or not somebody)


def paired_differences(
    runs: Sequence[ComparedRun],
) -> Iterator[tuple[ComparedRun, ComparedRun, str, ResampledScore]]:
    """Differences of the scores `COMPARED` between all runs that are comparable.

    Yields a run, the other, the name of a score, and the first one's score less the other's.
    """
    for run, other in combinations(runs, 2):
        if run.is_comparable(other):
            for name in COMPARED:
                yield run, other, name, run.scores[name] - other.scores[name]

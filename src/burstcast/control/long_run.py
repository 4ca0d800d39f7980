"""Long runs of control: flows that go on for as long as asked, of which only counts are kept.

`burstcast.control.loop.simulate` keeps all states, and compares each flow with itself without
control. Rare events need flows that last longer than the free flow does before it laminarises, and
more of them than fit into memory. Here flows advance by segments, and each segment is counted and
forgotten.

A flow that laminarises crosses every level of the observable on its way. That excursion, from the
last crossing of the lowest level on, is counted as a laminarisation and not as an event of any
level. Neither is an excursion that is under way when a flow has settled. Another flow takes its
place: a copy of one that is still turbulent, perturbed by a small random amount (Burdzy, Holyst &
March, Communications in Mathematical Physics 214, 2000). The copy counts once it has settled, when
it has forgotten its origin. So it is with a flow that leaves the range of floating-point numbers
under actuation, which is counted as escaped.
"""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import NUMBER, OBSERVABLE
from burstcast.control.experiment import ControlExperiment
from burstcast.control.loop import FLOWS_PER_BATCH, RunningFlows, observable_of
from burstcast.control.policy import Policy
from burstcast.control.timing import Timing
from burstcast.data.laminarisation import first_laminar_step

PERTURBATION = 1e-4
"""Perturbation of a copied flow, in standard deviations of each component over the flows."""
_SEGMENT_LT = 4.0
"""Length of a segment in Lyapunov times: bounds the memory."""


def _of_flow(meaning: str) -> Described:
    return Described("flow", NUMBER, meaning)


@dataclass(frozen=True)
class LongRunCounts:
    """Counts of each flow of a long run, in which laminarisations are replaced."""

    level: Annotated[FloatArray, Described("level", OBSERVABLE, "levels of the observable")]
    #: upward crossings of each level in excursions that do not laminarise, ``(flows, levels)``
    events: Annotated[IntArray, Described("flow level", NUMBER, "events of the level")]
    #: steps at or above each level, ``(flows, levels)``
    exceeding: Annotated[IntArray, Described("flow level", NUMBER, "steps at or above the level")]
    #: settled steps before the flow, or a copy in its place, laminarises
    steps: Annotated[IntArray, _of_flow("counted steps")]
    actuated_steps: Annotated[IntArray, _of_flow("counted steps under actuation")]
    decisions: Annotated[IntArray, _of_flow("looks, whether they count or not")]
    laminarisations: Annotated[IntArray, _of_flow("laminarisations in the counted steps")]
    #: flows that left the range of floating-point numbers under actuation, and were replaced
    escapes: Annotated[IntArray, _of_flow("escapes from the range of numbers, likewise")]


class ObservationNoise:
    """Observation noise of each flow, drawn stretch by stretch from a stream of its own.

    ``scale``: Standard deviation of the noise of each component, ``(components,)``.
    """

    def __init__(self, experiment: ControlExperiment, scale: FloatArray) -> None:
        self.scale = scale
        self._streams = [
            random_streams.stream(experiment.root_seed, "long control noise", experiment.case, row)
            for row in experiment.series
        ]

    def draw(self, steps: int) -> FloatArray:
        """Noise of the next steps of all flows, ``(flows, steps, components)``."""
        shape = steps, len(self.scale)
        draws = [stream.standard_normal(shape) for stream in self._streams]
        return np.asarray(draws).reshape(-1, *shape) * self.scale


class EndlessFlows(RunningFlows):
    """Flows of which the last steps are in memory; the numbers of steps move along with them."""

    def __init__(
        self, experiment: ControlExperiment, timing: Timing, noise_scale: FloatArray | None
    ) -> None:
        flows, stride = len(experiment.washouts), timing.schedule.sampling_stride
        self.experiment, self.timing, self.rows = experiment, timing, np.arange(flows)
        self._stride, (self._shortest, longest) = stride, timing.pauses
        #: steps of a segment, which follow ``timing.first_look``
        self.segment = max(self._shortest, timing.schedule.steps(_SEGMENT_LT))
        self.end = timing.first_look + self.segment  #: last step of the segment
        steps = self.end + 1 + max(self._shortest, longest, -(-timing.effect[1] // stride))
        self.states = np.empty((flows, steps, experiment.system.dimension))
        self.states[:, : timing.schedule.washout] = experiment.washouts
        self.acting: ByteArray = np.zeros((flows, steps * stride), dtype=np.uint8)
        self.clock = np.full(flows, timing.first_look, dtype=np.int64)
        self._stop = self.clock.copy()
        self.escape_step = np.full(flows, -1, dtype=np.int64)
        self._number = np.zeros(flows, dtype=np.int64)
        self._looks: list[tuple[IntArray, IntArray, BoolArray, BoolArray]] = []
        self._source = None if noise_scale is None else ObservationNoise(experiment, noise_scale)
        self._noise = None if self._source is None else self._source.draw(steps)

    def _leave(self) -> None:
        """Flows never leave."""

    @property
    def _last_step(self) -> int:
        """Step at which a flow of the segment is over."""
        return self.end

    @property
    def decisions(self) -> IntArray:
        """Number of looks at each flow so far, ``(flows,)``."""
        return self._number

    def run_segment(self, policy: Policy) -> None:
        """Bring all flows to the end of the segment, or a little beyond it."""
        while (moving := np.flatnonzero(self.clock < self.end)).size:
            due = np.flatnonzero((self.clock == self._stop) & (self.clock < self.end))
            if due.size:
                self._act(due, np.asarray(policy(self._look(due, self._noise))).astype(np.uint8))
                self._looks.clear()
            self._advance(moving)
            self._end_escaped(moving)

    def forget_segment(self) -> None:
        """Let the end of the segment become the start of the next one."""
        for history, count in ((self.states, self.segment), (self.acting, self._in_segment)):
            history[:, :-count] = history[:, count:].copy()
        self.acting[:, -self._in_segment :] = 0
        if self._noise is not None and self._source is not None:
            fresh = self._source.draw(self.segment)
            self._noise = np.concatenate([self._noise[:, self.segment :], fresh], axis=1)
        self.escape_step[:] = -1
        self.clock -= self.segment
        self._stop -= self.segment

    @property
    def _in_segment(self) -> int:
        """Integration steps of a segment."""
        return self.segment * self._stride

    def replace(self, flows: IntArray, by: IntArray, perturbation: FloatArray) -> None:
        """Let flows go on as perturbed copies of others; ``perturbation``: ``(flows, dim)``."""
        for history in (self.states, self.acting, self.clock, self._stop):
            history[flows] = history[by]
        self.states[flows, self.clock[flows]] += perturbation

    def of_segment(self) -> tuple[FloatArray, BoolArray]:
        """Observable of the segment and of the step before it, and whether actuation led to a step.

        ``(flows, segment + 1)`` and ``(flows, segment)``; NaN from where a flow has escaped.
        """
        first, stop, stride = self.timing.first_look, self.end + 1, self._stride
        # a flow is very large before it is not finite
        with np.errstate(over="ignore", invalid="ignore"):
            observable = observable_of(self.experiment.system, self.states[:, first:stop])
        return observable, self.acting[
            :, (first + 1) * stride - 1 : self.end * stride : stride
        ] != 0


class _Counting:
    """Counts of flows while they are simulated, segment by segment."""

    def __init__(
        self, flows: int, levels: FloatArray, settling: int, laminarisation_threshold: float | None
    ) -> None:
        self.levels, self.settling, self.threshold = levels, settling, laminarisation_threshold
        #: steps of each flow since its start, or since it was copied
        self.age = np.zeros(flows, dtype=np.int64)
        #: whether the flow has been below all levels since it settled
        self.was_low = np.zeros(flows, dtype=bool)
        #: pending: events since the flow was last below all levels, ``(flows, levels)``
        self.pending, self.events, self.exceeding = np.zeros(
            (3, flows, len(levels)), dtype=np.int64
        )
        self.steps, self.actuated = np.zeros((2, flows), dtype=np.int64)
        self.laminarisations, self.escapes = np.zeros((2, flows), dtype=np.int64)

    def add(self, observable: FloatArray, actuated: BoolArray) -> IntArray:
        """Count a segment (`EndlessFlows.of_segment`); flows that laminarise in it, or escape.

        A flow that escapes has left what counts as soon as it is as large as a laminar one.
        """
        steps = observable.shape[1] - 1
        number = np.arange(1, steps + 1)
        lost = ~np.isfinite(observable[:, 1:])
        escaped = lost.any(axis=1)
        laminar = first_laminar_step(observable[:, 1:], self.threshold) + 1
        until = np.where(laminar > 0, laminar, steps + 1)
        until = np.where(escaped, np.minimum(until, lost.argmax(axis=1) + 1), until)
        leaves = until <= steps
        settled = self.age[:, np.newaxis] + number > self.settling
        counted = settled & (number < until[:, np.newaxis])
        # the excursion that is under way at the end, or where the flow laminarises
        last = np.minimum(until - 1, steps)[:, np.newaxis]
        low = (observable < self.levels.min()) & (np.arange(steps + 1) <= last)
        since = np.where(low.any(axis=1), steps - low[:, ::-1].argmax(axis=1), 0)
        self.pending[low.any(axis=1)] = 0
        # an excursion that was under way when the flow settled is no event
        begun = low[:, :-1] & (self.age[:, np.newaxis] + number > self.settling)
        begun[:, 0] |= self.was_low & (self.age > 0)
        begun = np.logical_or.accumulate(begun, axis=1)
        self.was_low = begun[:, -1]
        for column, level in enumerate(self.levels):
            above = observable >= level
            crosses = above[:, 1:] & ~above[:, :-1] & counted & begun
            self.events[:, column] += crosses.sum(axis=1)
            self.exceeding[:, column] += (above[:, 1:] & counted).sum(axis=1)
            self.pending[:, column] += (crosses & (number > since[:, np.newaxis])).sum(axis=1)
        self.events[leaves] -= self.pending[leaves]
        self.pending[leaves] = 0
        self.steps += counted.sum(axis=1)
        self.actuated += (actuated & counted).sum(axis=1)
        while_counting = leaves & (self.age + until > self.settling)
        self.laminarisations += while_counting & ~escaped
        self.escapes += while_counting & escaped
        self.age += steps
        return np.flatnonzero(leaves)


def run_long(
    experiment: ControlExperiment,
    timing: Timing,
    policy: Policy,
    *,
    levels: Sequence[float],
    laminarisation_threshold: float | None,
    noise_scale: FloatArray | None = None,
) -> LongRunCounts:
    """Run flows under control and count their events.

    Each flow goes on for the schedule's ``quiet_lt``, in which it settles and nothing counts, and
    for ``span_lt`` after it, rounded up to whole segments of four Lyapunov times.

    Parameters
    ----------
    experiment
        Flows and actuation; ``quiet_starts`` has no effect.
    timing
        Looks and actuation of the strategy.
    policy
        What decides at each look.
    levels
        Levels of the observable whose events are counted.
    laminarisation_threshold
        Value of the observable above which a flow is laminar; None: flows never are.
    noise_scale
        Standard deviation of the observation noise of each component, ``(components,)``; None:
        policies see the truth.

    Returns
    -------
    LongRunCounts
        Counts of each flow.

    Raises
    ------
    FloatingPointError
        If a flow leaves the range of floating-point numbers without actuation, or all flows of a
        batch do under it within the same segment.
    RuntimeError
        If all flows of a batch laminarise or escape within the same segment, so that none is left
        to copy.
    """
    parts = []
    for first in range(0, len(experiment.washouts), FLOWS_PER_BATCH):
        some = slice(first, first + FLOWS_PER_BATCH)
        batch = dataclasses.replace(
            experiment, washouts=experiment.washouts[some], series=experiment.series[some]
        )
        flows = EndlessFlows(batch, timing, noise_scale)
        parts.append(_run_batch(flows, policy, np.asarray(levels, float), laminarisation_threshold))
    joined = {
        entry.name: np.concatenate([getattr(part, entry.name) for part in parts])
        for entry in dataclasses.fields(LongRunCounts)
        if entry.name != "level"
    }
    return LongRunCounts(level=np.asarray(levels, dtype=np.float64), **joined)


def _run_batch(
    flows: EndlessFlows, policy: Policy, levels: FloatArray, laminarisation_threshold: float | None
) -> LongRunCounts:
    experiment, schedule = flows.experiment, flows.timing.schedule
    settling = max(flows.timing.settling, schedule.steps(schedule.quiet_lt))
    counts = _Counting(len(flows.rows), levels, settling, laminarisation_threshold)
    generator = random_streams.stream(
        experiment.root_seed, "laminarised flows", experiment.case, experiment.series.start
    )
    spread = PERTURBATION * experiment.washouts[:, -1].std(axis=0)
    for _ in range(-(-(settling + flows.timing.span) // flows.segment)):
        flows.run_segment(policy)
        left = counts.add(*flows.of_segment())
        flows.forget_segment()
        if not left.size:
            continue
        turbulent = np.setdiff1d(flows.rows, left)
        if not turbulent.size:
            raise RuntimeError(
                f"all {len(flows.rows)} flows laminarised or left the range of floating-point "
                f"numbers within {_SEGMENT_LT:g} Lyapunov times: a long run needs more flows, "
                "control.flows"
            )
        perturbation = spread * generator.standard_normal((len(left), len(spread)))
        flows.replace(left, generator.choice(turbulent, len(left)), perturbation)
        counts.age[left] = 0
    return LongRunCounts(
        levels,
        counts.events,
        counts.exceeding,
        counts.steps,
        counts.actuated,
        flows.decisions,
        counts.laminarisations,
        counts.escapes,
    )

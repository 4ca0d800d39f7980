"""When a controlled flow is looked at, what an alarm sets off, and which steps count.

Steps are numbered like the samples of the series from which a flow starts: step 0 is the first
input of the washout. Integration step i leads from i to i + 1 time steps after step 0.
"""

from dataclasses import dataclass

from burstcast.base import durations


@dataclass(frozen=True)
class Schedule:
    """Durations of an experiment, which all strategies are given."""

    washout: int  #: inputs of the washout; the last one is the step of the first look
    #: the least that flows go on, in Lyapunov times after the first look, before their steps count
    quiet_lt: float
    span_lt: float  #: how long each flow counts, in Lyapunov times
    delay_lt: float  #: time from a decision to its effect, in Lyapunov times
    #: actuation_start_lt, actuation_duration_lt: what an alarm for a window sets off: start, from
    #: the window's first step, and length, in Lyapunov times
    actuation_start_lt: float
    actuation_duration_lt: float
    steps_per_lyapunov_time: int
    sampling_stride: int  #: integration steps in a step
    time_step: float  #: of the integration, in time units

    def __post_init__(self) -> None:
        if self.steps(self.span_lt) < 1:
            raise ValueError("the span of control must last a step")
        if self.washout < 1:
            raise ValueError(f"a forecast needs at least one input, not {self.washout}")
        if self.sampling_stride < 1:
            raise ValueError(f"the stride must be at least one step, not {self.sampling_stride}")
        if self.quiet_lt < 0:
            raise ValueError(f"the steps that count begin after the first, not {self.quiet_lt}")
        if self.delay_lt < 0:
            raise ValueError(f"the delay must not be negative, not {self.delay_lt}")

    def steps(self, duration_lt: float) -> int:
        """Whole steps in a duration in Lyapunov times, rounded down."""
        return durations.steps(duration_lt, self.steps_per_lyapunov_time)

    def integration_steps(self, duration_lt: float) -> int:
        """Whole integration steps in a duration in Lyapunov times, rounded down."""
        return durations.steps(duration_lt, self.steps_per_lyapunov_time * self.sampling_stride)


@dataclass(frozen=True)
class Timing:
    """Timing of a strategy: its looks, the effect of an alarm, and the steps that count.

    The span that counts has the same length in all flows. If it ended with the first stretch
    without an alarm, how long a flow runs would depend on what happens in it, and long or short
    flows would weigh the wrong way in the statistics.
    """

    schedule: Schedule
    #: steps from a look to the next one: without an alarm, and after one, which is no less
    pauses: tuple[int, int]
    #: first integration step under actuation after an alarm, and the first free one after it
    effect: tuple[int, int]
    settling: int  #: steps after the first look that do not count, whatever ``quiet_lt`` says

    @property
    def first_look(self) -> int:
        """Step of the first look."""
        return self.schedule.washout - 1

    @property
    def last_look(self) -> int:
        """Last step at which an alarm could still change a step that counts."""
        stride = self.schedule.sampling_stride
        return (self.counted_until * stride - self.effect[0] - 1) // stride

    @property
    def most_looks(self) -> int:
        """Most looks that a flow can have."""
        return max(0, (self.last_look - self.first_look) // self.pauses[0] + 1)

    @property
    def span(self) -> int:
        """Steps of each flow that count."""
        return self.schedule.steps(self.schedule.span_lt)

    @property
    def counted_from(self) -> int:
        """Last step before the steps that count."""
        return self.first_look + max(self.settling, self.schedule.steps(self.schedule.quiet_lt))

    @property
    def counted_until(self) -> int:
        """Last step that counts."""
        return self.counted_from + self.span

    @property
    def counted(self) -> slice:
        """Steps that count."""
        return slice(self.counted_from + 1, self.counted_until + 1)

    @property
    def length(self) -> int:
        """Steps of a flow, washout included."""
        return self.counted_until + 1

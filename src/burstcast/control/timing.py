"""When a controlled flow is watched, and which of its steps count.

Steps are numbered like the samples of the series from which a flow starts: step 0 is the first
input of the washout.
"""

import abc
from dataclasses import dataclass

from burstcast import durations


@dataclass(frozen=True, kw_only=True)
class Clock(abc.ABC):
    """Base class of timings: the first forecast, and the steps that count.

    The span that counts has the same length in all flows. If it ended with the first stretch
    without an alarm, how long a flow runs would depend on what happens in it, and long or short
    flows would weigh the wrong way in the statistics.

    Attributes
    ----------
    span_lt
        How long each flow counts, in Lyapunov times; positive.
    washout
        Inputs of the washout; the last one is the step at which the forecast is made.
    steps_per_lyapunov_time
        Steps of a forecast in a Lyapunov time.
    sampling_stride
        Integration steps in a step of a forecast.
    time_step
        Time step of the integration, in time units.
    quiet_lt
        The least that flows go on, in Lyapunov times after the first forecast, before their steps
        count; not negative.
    """

    span_lt: float
    washout: int
    steps_per_lyapunov_time: int
    sampling_stride: int
    time_step: float
    quiet_lt: float = 0.0

    def __post_init__(self) -> None:
        """Check the settings common to all timings.

        Raises
        ------
        ValueError
            If the span is shorter than one step, or a number is too small.
        """
        if self.span_steps < 1:
            raise ValueError("the span of control must last a step")
        if self.washout < 1:
            raise ValueError(f"a forecast needs at least one input, not {self.washout}")
        if self.sampling_stride < 1:
            raise ValueError(f"the stride must be at least one step, not {self.sampling_stride}")
        if self.quiet_lt < 0:
            raise ValueError(f"the steps that count begin after the first, not {self.quiet_lt}")

    def steps(self, duration_lt: float) -> int:
        """Whole steps in a duration in Lyapunov times, rounded down."""
        return durations.steps(duration_lt, self.steps_per_lyapunov_time)

    @property
    @abc.abstractmethod
    def settling_steps(self) -> int:
        """Steps after the first forecast that do not count, whatever `quiet_lt` says."""

    @property
    @abc.abstractmethod
    def most_forecasts(self) -> int:
        """Most looks that the monitor can have at a flow."""

    @property
    def span_steps(self) -> int:
        """Steps of each flow that count."""
        return self.steps(self.span_lt)

    @property
    def first_forecast(self) -> int:
        """Step of the first forecast."""
        return self.washout - 1

    @property
    def counted_from(self) -> int:
        """Last step before the counted steps."""
        return self.first_forecast + max(self.settling_steps, self.steps(self.quiet_lt))

    @property
    def counted_until(self) -> int:
        """Last step that counts."""
        return self.counted_from + self.span_steps

    @property
    def length(self) -> int:
        """Steps of a flow, washout included."""
        return self.counted_until + 1


@dataclass(frozen=True, kw_only=True)
class Timing(Clock):
    """The paper's timing: consecutive windows, common to all flows.

    A forecast made at step t covers the window from t + prediction time to t + prediction time +
    window. Without an alarm the next forecast is made one window later, so that windows follow on
    one another without a gap; after an alarm it is made at the end of the alarm's window. The
    stretch of one prediction time between that and the next window is covered by no forecast.

    Steps count from the end of the first window, for ``span_lt``, in each flow: flows are chosen to
    be free of events up to there (see `burstcast.control.simulation.simulate`), so that earlier
    steps say nothing.

    Attributes
    ----------
    prediction_time_lt
        Time from a forecast to the start of its window, in Lyapunov times; positive.
    window_lt
        Length of the window in Lyapunov times; positive.
    """

    prediction_time_lt: float
    window_lt: float

    def __post_init__(self) -> None:
        """Check that no duration is shorter than one step.

        Raises
        ------
        ValueError
            If one is.
        """
        super().__post_init__()
        if self.window_start < 1 or self.window_steps < 1:
            raise ValueError("the prediction time and window of control must last a step")

    @property
    def settling_steps(self) -> int:
        """Steps up to the end of the first window, before which nothing could be done."""
        return self.window_end

    @property
    def window_start(self) -> int:
        """Steps from a forecast to the first step of its window."""
        return self.steps(self.prediction_time_lt)

    @property
    def window_end(self) -> int:
        """Steps from a forecast to the last step of its window: and to the next after an alarm."""
        return self.steps(self.prediction_time_lt + self.window_lt)

    @property
    def window_steps(self) -> int:
        """Steps from a forecast without an alarm to the next."""
        return self.window_end - self.window_start

    @property
    def most_forecasts(self) -> int:
        """Most forecasts that a flow can see: one per window, up to the last step that counts."""
        return (self.counted_until - self.first_forecast) // self.window_steps + 1


@dataclass(frozen=True, kw_only=True)
class DecisionTiming(Clock):
    """Decisions at equal intervals, each on what is done until the next takes effect.

    A decision made at step t switches the actuation on or off from t + delay to t + delay +
    interval.

    Attributes
    ----------
    interval_lt
        Time from one decision to the next, in Lyapunov times; one step at least.
    delay_lt
        Time from a decision to its effect, in Lyapunov times; not negative.
    """

    interval_lt: float
    delay_lt: float = 0.0

    def __post_init__(self) -> None:
        """Check the interval and the delay.

        Raises
        ------
        ValueError
            If the interval is shorter than one step, or the delay negative.
        """
        super().__post_init__()
        if self.interval < 1:
            raise ValueError("the interval between two decisions must last a step")
        if self.delay_lt < 0:
            raise ValueError(f"the delay must not be negative, not {self.delay_lt}")

    @property
    def settling_steps(self) -> int:
        """Steps before the first decision takes effect."""
        return self.delay

    @property
    def interval(self) -> int:
        """Steps from one decision to the next."""
        return self.steps(self.interval_lt)

    @property
    def delay(self) -> int:
        """Steps from a decision to its effect."""
        return self.steps(self.delay_lt)

    @property
    def most_forecasts(self) -> int:
        """Decisions in each flow: as long as one could still change a step that counts."""
        last = self.counted_until - 1 - self.delay  # the step of the last such decision
        return (last - self.first_forecast) // self.interval + 1

"""When a controlled flow is monitored, and which of its steps count.

Steps are numbered like the samples of the test series from which a flow starts: step 0 is the first
input of the washout.
"""

from dataclasses import dataclass

from burstcast import durations


@dataclass(frozen=True)
class Timing:
    """Clock of monitoring: the same for every flow, whatever happens in it.

    A forecast made at step t covers the window from t + prediction time to t + prediction time +
    window. Without an alarm the next forecast is made one window later, so that windows follow on
    one another without a gap; after an alarm it is made at the end of the alarm's window. The
    stretch of one prediction time between that and the next window is covered by no forecast.

    Steps count from the end of the first window, for ``span_lt``, in each flow: flows are chosen to
    be free of events up to there (see `burstcast.control.flows.run_controlled_flows`), so that
    earlier steps say nothing. The span has the same length in all flows. If it ended with the first
    stretch without an alarm, how long a flow runs would depend on what happens in it, and long or
    short flows would weigh the wrong way in the statistics.

    Attributes
    ----------
    prediction_time_lt
        From a forecast to the start of its window, in Lyapunov times; positive.
    window_lt
        Length of the window in Lyapunov times; positive.
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
    """

    prediction_time_lt: float
    window_lt: float
    span_lt: float
    washout: int
    steps_per_lyapunov_time: int
    sampling_stride: int
    time_step: float

    def __post_init__(self) -> None:
        """Check that no duration is shorter than one step.

        Raises
        ------
        ValueError
            If one is.
        """
        if self.window_start < 1 or self.window_steps < 1 or self.span_steps < 1:
            raise ValueError("the prediction time, window and span of control must last a step")
        if self.washout < 1:
            raise ValueError(f"a forecast needs at least one input, not {self.washout}")
        if self.sampling_stride < 1:
            raise ValueError(f"the stride must be at least one step, not {self.sampling_stride}")

    @property
    def window_start(self) -> int:
        """Steps from a forecast to the first step of its window."""
        return durations.steps(self.prediction_time_lt, self.steps_per_lyapunov_time)

    @property
    def window_end(self) -> int:
        """Steps from a forecast to the last step of its window: and to the next after an alarm."""
        return durations.steps(
            self.prediction_time_lt + self.window_lt, self.steps_per_lyapunov_time
        )

    @property
    def window_steps(self) -> int:
        """Steps from a forecast without an alarm to the next."""
        return self.window_end - self.window_start

    @property
    def span_steps(self) -> int:
        """Steps of each flow that count."""
        return durations.steps(self.span_lt, self.steps_per_lyapunov_time)

    @property
    def first_forecast(self) -> int:
        """Step of the first forecast."""
        return self.washout - 1

    @property
    def counted_from(self) -> int:
        """Last step before those that count."""
        return self.first_forecast + self.window_end

    @property
    def counted_until(self) -> int:
        """Last step that counts."""
        return self.counted_from + self.span_steps

    @property
    def length(self) -> int:
        """Steps of a flow, washout included."""
        return self.counted_until + 1

    @property
    def most_forecasts(self) -> int:
        """Most forecasts that a flow can see: one per window, up to the last step that counts."""
        return (self.window_end + self.span_steps) // self.window_steps + 1

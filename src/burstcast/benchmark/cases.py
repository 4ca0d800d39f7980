"""Cases of the benchmark: system, observation, prediction windows. They are frozen.

A case that changes in anything but its words gets another version. Forecasts name the version that
they were made for, and are scored by no other.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.benchmark.records import GLUCOSE, glucose
from burstcast.discovery import suggestion
from burstcast.forecast.horizon import HorizonSearch
from burstcast.forecast.windows import window_boundaries
from burstcast.observation.velocity_sensors import VelocitySensors
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.kolmogorov import KolmogorovFlow
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.state_space import StateSpace, component_names

SEED = 2026
"""Seed of the benchmark: results in the leaderboard are of this one."""


@dataclass(frozen=True, kw_only=True)
class BenchmarkCase:
    """One case of the benchmark; by default with settings of Racca & Magri.

    Durations in Lyapunov times end in ``_lt``.
    """

    name: str  #: what forecasts call it
    version: int = 1
    about: str  #: one sentence for the page of an export
    ensemble_name: str  #: in streams of random numbers: cases that share it share their true series
    system: DynamicalSystem | MeasuredSeries  #: the equations; for a record, what was measured
    #: names of the components of the state, or of the readings of the sensors, that are observed.
    #: The observable is observed too, as a component of its own, where it cannot be computed from
    #: them.
    observed: tuple[str, ...]
    noise: float = 0.01  #: of the observation, in standard deviations of each component
    #: event_threshold, laminarisation_threshold: in units of the observable
    event_threshold: float = 0.1
    laminarisation_threshold: float | None = None
    #: initial_state, perturbed_component, perturbation: initial conditions
    #: (`burstcast.data.dataset.initial_states`). Without an initial state, the system draws them.
    initial_state: tuple[float, ...] | None = None
    perturbed_component: int = 3
    perturbation: float = 0.01
    #: series, training_series, test_series: generated series; how many of the series that do not
    #: laminarise are for training and for the test
    series: int
    training_series: int = 10
    test_series: int
    #: time_step, transient, duration: of the integration, in time units
    time_step: float
    sampling_stride: int = 1  #: integration steps in a sample
    transient: float = 0.0
    duration: float
    #: sets the Lyapunov time, in inverse time units. For a record, which has no exponent that is
    #: known, any unit of time.
    lyapunov_exponent: float
    washout_lt: float  #: length of the washouts
    start_spacing_lt: float = 1.0  #: distance of two starting points
    #: window_lt, resolution_lt: length of the prediction windows, and of the intervals in them
    window_lt: float = 1.0
    resolution_lt: float = 0.5
    #: from the starting point to the first step of the prediction windows
    prediction_times_lt: tuple[float, ...]
    horizon_events: int  #: events whose prediction horizon is measured
    #: longest_lead_time_lt, lead_time_step_lt: the lead times that are tried
    longest_lead_time_lt: float
    lead_time_step_lt: float = 0.5
    #: error that is allowed, in units of the distance of the threshold from the mean observable
    tolerance: float = 0.2
    #: of the data under `SEED`: a machine that makes other numbers is found out. Empty: not
    #: checked.
    digest: str
    #: sensors that see the flow; None: the components of the state are observed themselves
    sensors: VelocitySensors | None = None
    #: returns measured series, ``(series, time, component)``, in the order of time; the first are
    #: for training. None: series are simulated.
    record: Callable[[], FloatArray] | None = None

    @cached_property
    def space(self) -> StateSpace:
        """Space of the observed states: the system itself, where the whole state is observed."""
        if self.sensors is None and self.observed == component_names(self.system):
            return self.system
        return MeasuredSeries(
            self.observed, "observable", self.system.observable_name, self.system.observable_symbol
        )

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the components of an observed state."""
        return component_names(self.space)

    @property
    def sampling_interval(self) -> float:
        """Time between two samples, in time units."""
        return self.time_step * self.sampling_stride

    @property
    def steps_per_lyapunov_time(self) -> int:
        """Steps of a forecast in a Lyapunov time."""
        return durations.steps_per_lyapunov_time(self.lyapunov_exponent, self.sampling_interval)

    def steps(self, duration_lt: float) -> int:
        """Steps of a forecast in a duration of Lyapunov times, rounded down."""
        return durations.steps(duration_lt, self.steps_per_lyapunov_time)

    @property
    def boundaries(self) -> tuple[int, ...]:
        """Steps at which windows begin and end (`burstcast.forecast.windows.window_boundaries`)."""
        reach = max(self.prediction_times_lt) + self.window_lt
        count = round(reach / self.resolution_lt) - 1
        return window_boundaries(self.resolution_lt, count, self.steps_per_lyapunov_time)

    def windows(self, prediction_time_lt: float) -> tuple[int, int]:
        """First of the windows between boundaries that make up a prediction window; how many."""
        first = round(prediction_time_lt / self.resolution_lt) - 1
        return first, round(self.window_lt / self.resolution_lt)

    @property
    def window_steps(self) -> list[tuple[int, int]]:
        """First and last step of each prediction window, counted from the starting point."""
        return [
            (self.steps(time), self.steps(time + self.window_lt))
            for time in self.prediction_times_lt
        ]

    def horizon_search(self, mean_observable: float) -> HorizonSearch:
        """Search for the prediction horizon of an event."""
        return HorizonSearch(
            longest_lead_time_lt=self.longest_lead_time_lt,
            lead_time_step_lt=self.lead_time_step_lt,
            tolerance=self.tolerance * (self.event_threshold - mean_observable),
            washout=self.steps(self.washout_lt),
            steps_per_lyapunov_time=self.steps_per_lyapunov_time,
        )


_MODES = component_names(MoehlisFaisstEckhardt(400.0))
_FLOW = KolmogorovFlow(40.0)
_SENSORS = VelocitySensors(_FLOW, (8, 8))


def _shear_flow(reynolds: float, **own: Any) -> BenchmarkCase:
    """A case of the nine-mode shear flow, with the settings of Racca & Magri."""
    return BenchmarkCase(
        ensemble_name=f"Re{reynolds:g}",
        system=MoehlisFaisstEckhardt(reynolds),
        laminarisation_threshold=0.48,
        initial_state=(1.0, 0.0, 0.07066, -0.07076, 0.0, 0.0, 0.0, 0.0, 0.0),
        time_step=0.25,
        sampling_stride=4,
        transient=200.0,
        duration=4000.0,
        washout_lt=0.5,
        prediction_times_lt=(1.0, 2.0, 3.0, 4.0, 5.0),
        horizon_events=100,
        longest_lead_time_lt=10.0,
        **{"observed": _MODES, **own},
    )


CASES: Mapping[str, BenchmarkCase] = {
    case.name: case
    for case in (
        _shear_flow(
            400.0,
            name="Re400",
            about="The nine-mode shear flow at Re = 400, all modes observed: events are frequent.",
            lyapunov_exponent=0.0163,
            series=120,
            test_series=60,
            digest="76bbe1e7c00d2f2e",
        ),
        _shear_flow(
            1000.0,
            name="Re1000",
            about="The nine-mode shear flow at Re = 1000, all modes observed: events are rare.",
            lyapunov_exponent=0.0121,
            series=140,
            test_series=120,
            digest="48acc8106c52ce12",
        ),
        _shear_flow(
            400.0,
            name="Re400_seven_modes",
            about="The nine-mode shear flow at Re = 400; the modes a8 and a9 are hidden, and the "
            "kinetic energy, which has a part in them, is observed as a component of its own.",
            lyapunov_exponent=0.0163,
            series=120,
            test_series=60,
            digest="998b92cfbb504b3e",
            observed=_MODES[:7],
        ),
        BenchmarkCase(
            name="Kolmogorov",
            about="The two-dimensional Kolmogorov flow at Re = 40, whose dissipation bursts; its "
            "velocity at 8 x 8 points and the dissipation are observed.",
            ensemble_name="Kolmogorov_flow",
            system=_FLOW,
            observed=_SENSORS.channels,
            event_threshold=0.195,
            series=22,
            test_series=12,
            time_step=0.05,
            sampling_stride=10,
            transient=300.0,
            duration=1000.0,
            lyapunov_exponent=0.122,
            washout_lt=1.0,
            prediction_times_lt=(0.5, 1.0, 1.5, 2.0, 3.0),
            horizon_events=40,
            longest_lead_time_lt=4.0,
            digest="93cade92a6b7661c",
            sensors=_SENSORS,
        ),
        BenchmarkCase(
            name="Glucose",
            about="Glucose of one person in mg/dl, and the current of the sensor, every five "
            "minutes; an event is a fall to 70 mg/dl. The unit of time (LT) is 20 minutes.",
            ensemble_name="Glucose",
            system=GLUCOSE,
            observed=GLUCOSE.component_names,
            noise=0.0,
            event_threshold=-70.0,
            series=266,
            training_series=130,
            test_series=136,
            time_step=5.0,
            duration=715.0,
            lyapunov_exponent=1 / 20,
            washout_lt=6.0,
            prediction_times_lt=(1.0, 2.0, 3.0),
            horizon_events=60,
            longest_lead_time_lt=4.5,
            digest="b42721b34d9f2000",
            record=glucose,
        ),
    )
}
"""The cases by name."""


def case_named(name: str) -> BenchmarkCase:
    """The case of this name."""
    if name not in CASES:
        raise ValueError(
            f"the benchmark has no case {name!r}{suggestion(name, list(CASES))}; its cases are "
            f"{', '.join(CASES)}"
        )
    return CASES[name]

"""What each stage costs on this machine, one thread.

::

    python benchmarks/bench.py [--sizes 500 1000 2000 3000] [--quick] [--write]

Each stage is timed at the size that ``config.yaml`` gives it for Re = 400, or at a part of it and
extrapolated; with how much of the machine's peak it reaches (dgemm, measured in between); and
against the same work in the textbook implementation (``textbook.py``), without compiled code (numpy
and the scipy backend) and in ReservoirPy (``reservoirpy_network.py``), in the same run. Starts of
jobs and plans are timed, too. Times are the processor's, the least of several repetitions: other
programs on the machine disturb them little. ``--write`` puts the tables into
benchmarks/measured.md.
"""

import argparse
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib.metadata import version
from pathlib import Path

import numpy as np
import textbook
import yaml
from planning import plan
from reservoirpy_network import ReservoirpyNetwork
from threadpoolctl import threadpool_info, threadpool_limits

from burstcast.base import durations
from burstcast.data.dataset import (
    SERIES_PER_BATCH,
    add_observation_noise,
    component_scales,
    generate_ensemble,
    initial_states,
)
from burstcast.data.starting_points import (
    crossing_points,
    horizon_events,
    segments,
    starting_points,
)
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.esn import NetworkForecaster, ReservoirSeed
from burstcast.forecasts.horizon import HorizonSearch, prediction_horizons
from burstcast.forecasts.windows import window_boundaries, window_forecasts
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.readout import MomentsAccumulator, solve_ridge
from burstcast.networks.reservoir import make_reservoir
from burstcast.networks.training import TrainingSeries, collect, train
from burstcast.networks.validation import validate
from burstcast.networks.validation_strategies.base import ValidationPlan
from burstcast.networks.validation_strategies.recycle import RecycleValidation
from burstcast.networks.validation_strategies.single_shot import SingleShotValidation
from burstcast.statistics.long_term import (
    LongTermSettings,
    long_term_starting_points,
    run_long_term,
)
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.lyapunov import lyapunov_spectrum, perturbation_growth
from burstcast.systems.registry import make_system
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load

ROOT = Path(__file__).resolve().parents[1]
DOCUMENT = ROOT / "benchmarks" / "measured.md"
CASE = "Re400"
SPECTRAL_RADIUS, INPUT_SCALING, TIKHONOV = 0.6, 1.0, 1e-9
# Operations of one hyperbolic tangent in the compiled backend, and of what joins its argument.
TANH_OPERATIONS = 33


# --- The machine ---------------------------------------------------------------------------------

STRATEGIES = (SingleShotValidation(), RecycleValidation())


def pin_to_one_core() -> None:
    """Keep this process, and the threads of BLAS, on one core (where the system can do that)."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    threadpool_limits(1)
    threads = {pool["internal_api"]: pool["num_threads"] for pool in threadpool_info()}
    if any(number != 1 for number in threads.values()):
        raise SystemExit(f"a library keeps several threads: {threads}")


def machine() -> str:
    """Processor, cores and BLAS in words."""
    processor = platform.processor() or platform.machine()
    information = Path("/proc/cpuinfo")
    extensions = ""
    if information.exists():
        lines = dict(
            (part.strip() for part in line.split(":", 1))
            for line in information.read_text().splitlines()
            if ":" in line
        )
        processor = lines.get("model name", processor)
        flags = lines.get("flags", "").split()
        for flag, name in (("avx2", ", AVX2"), ("avx512f", ", AVX-512")):
            extensions = name if flag in flags else extensions
    blas = next(pool for pool in threadpool_info() if pool["user_api"] == "blas")
    return (
        f"{processor}{extensions}, {os.cpu_count()} cores; {blas['internal_api']} "
        f"{blas['version']} for {blas.get('architecture', 'this processor')}; "
        f"Python {platform.python_version()}, NumPy {np.__version__}"
    )


@dataclass
class Clock:
    """Times functions, and looks now and then at what the machine can do at best."""

    repeats: int
    peak: float = 0.0  # GFLOP/s of dgemm

    def seconds(self, function: Callable[[], object], repeats: int | None = None) -> float:
        """Least processor time of several calls."""
        self._look_at_peak()
        return min(_processor_time(function) for _ in range(repeats or self.repeats))

    def _look_at_peak(self) -> None:
        size = 1000
        matrix = np.ones((size, size))
        product = np.empty_like(matrix)
        # two different matrices: the product of one with its own transpose is not dgemm
        other = matrix + 1.0
        seconds = min(_processor_time(lambda: np.matmul(matrix, other, product)) for _ in range(3))
        self.peak = max(self.peak, 2e-9 * size**3 / seconds)


def _processor_time(function: Callable[[], object]) -> float:
    start = time.process_time()
    function()
    return time.process_time() - start


# --- What is measured ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Row:
    """One measured stage; seconds are for the stage's whole work."""

    stage: str
    work: str
    neurons: int | None
    seconds: float
    textbook: float | None = None
    scipy: float | None = None
    neuron_steps: float | None = None
    operations: float | None = None

    def cells(self, peak: float) -> list[str]:
        """Cells of the table."""
        rate = None if self.operations is None else 1e-9 * self.operations / self.seconds
        return [
            self.stage,
            self.work,
            "" if self.neurons is None else str(self.neurons),
            f"{self.seconds:.3g}",
            "" if self.neuron_steps is None else f"{1e9 * self.seconds / self.neuron_steps:.2f}",
            "" if rate is None else f"{rate:.1f}",
            "" if rate is None else f"{100 * rate / peak:.0f} %",
            "" if self.textbook is None else f"{self.textbook / self.seconds:.3g}",
            "" if self.scipy is None else f"{self.scipy / self.seconds:.2g}",
        ]


HEAD = [
    "stage",
    "work",
    "neurons",
    "seconds",
    "ns per neuron-step",
    "GFLOP/s",
    "of dgemm",
    "textbook x",
    "numpy/scipy x",
]


# What is done by ReservoirPy, too: forecasts, and steps of each.
RESERVOIRPY_FORECASTS, RESERVOIRPY_STEPS = 200, 100
RESERVOIRPY_HEAD = [
    "neurons",
    "training on the ten series [s]",
    "ReservoirPy x",
    f"{RESERVOIRPY_FORECASTS} forecasts of {RESERVOIRPY_STEPS} steps [s]",
    "ReservoirPy x",
]


@dataclass(frozen=True)
class CountingForecaster(NetworkForecaster):
    """A network that counts the steps of all its trajectories."""

    counts: list[int] = field(default_factory=list)

    @property
    def steps(self) -> int:
        """Counted so far."""
        return sum(self.counts)

    def start(self, washout: np.ndarray) -> np.ndarray:
        """Count, and go on."""
        self.counts.append(washout.shape[0] * washout.shape[2])
        return super().start(washout)

    def advance(self, memory: np.ndarray, steps: int) -> tuple[np.ndarray, np.ndarray]:
        """Count, and go on."""
        self.counts.append(steps * memory.shape[-1])
        return super().advance(memory, steps)


class Data:
    """A small ensemble of the campaign's first case, and its settings in steps."""

    def __init__(self, campaign: Campaign, series: int) -> None:
        self.config = campaign.config.dump()
        self.case = campaign.cases[CASE].dump()
        self.network = campaign.sections(CASE)["esn"]
        self.system = make_system(self.case["system"], self.case["parameters"])
        self.lyapunov_time = campaign.cases[CASE].steps_per_lyapunov_time
        self.states = np.concatenate([kept.states for kept in self.ensemble(series)])
        self.truth = self.system.observable(np.moveaxis(self.states, -1, 0))
        training = self.states[: self.case["training"]["series"]]
        scales = component_scales(training)
        self.observed = add_observation_noise(
            self.states, 0, self.case["training"]["noise"], scales, 1, "benchmark"
        )
        self.training = TrainingSeries(self.observed[: len(training)], scales.range)
        recycle = self.case["recycle_validation"]
        self.plan = ValidationPlan(
            washout=self.steps(self.config["washout_lt"]),
            interval=self.steps(self.config["search"]["interval_lt"]),
            series=recycle["series"],
            intervals=recycle["intervals_per_series"],
        )

    def steps(self, duration_lt: float) -> int:
        """Lyapunov times in steps."""
        return durations.steps(duration_lt, self.lyapunov_time)

    def ensemble(self, series: int, system: DynamicalSystem | None = None) -> Iterator:
        """Integrate an ensemble, of the case's system unless another one is given."""
        setting = self.case["ensemble"]
        return generate_ensemble(
            system or self.system,
            initial_states(
                np.array(setting["initial_state"], dtype=float),
                setting["perturbed_component"] - 1,
                setting["perturbation"],
                series,
                np.random.default_rng(1),
            ),
            time_step=setting["time_step"],
            sampling_stride=setting["sampling_stride"],
            transient_steps=round(setting["transient"] / setting["time_step"]),
            kept_steps=round(setting["duration"] / setting["time_step"]),
            laminarisation_threshold=self.case["laminarisation_threshold"],
        )

    @property
    def test(self) -> slice:
        """Series that are not trained on."""
        return slice(self.training.series, None)


# --- The stages ----------------------------------------------------------------------------------


class Stages:
    """All stages of one reservoir size."""

    def __init__(self, data: Data, neurons: int, clock: Clock, *, quick: bool) -> None:
        self._data, self._neurons, self._clock, self._quick = data, neurons, clock, quick
        network = data.network
        reservoir = make_reservoir(
            neurons,
            data.system.dimension,
            network["connectivity"],
            network["input_bias"],
            np.random.default_rng(neurons),
        )
        self._compiled = Dynamics(reservoir, SPECTRAL_RADIUS, INPUT_SCALING, "compiled")
        self._scipy = replace(self._compiled, backend="scipy")
        self._textbook = textbook.TextbookNetwork(self._compiled)
        # per neuron and step: products with the matrix, the input, the hyperbolic tangent
        self._open_operations = 2 * reservoir.recurrent.nnz / neurons + 2 + TANH_OPERATIONS
        self._closed_operations = self._open_operations + 2 * data.system.dimension
        self._batch = 64
        observed = data.training.observed / data.training.input_range
        self._inputs = np.ascontiguousarray(observed[:, :-1].transpose(1, 2, 0))
        self._collected = collect(self._compiled, data.training, washout=data.plan.washout)
        self._readout = solve_ridge(self._collected.moments, TIKHONOV)

    def rows(self) -> list[Row]:
        """Measure everything."""
        return [
            self._closed_loop(),
            self._of_loop(
                "closed loop alone", "1e4 steps", 1e4, self._rates_of(self._closed_states[:, :1])
            ),
            self._open_loop(),
            self._gram(),
            self._ridge(),
            self._trial(),
            self._forecasts(),
            self._horizon(),
            self._long_term(),
        ]

    @cached_property
    def _closed_states(self) -> np.ndarray:
        states = self._compiled.open_loop(self._inputs[:100])
        return np.tile(states, (1, self._batch))[:, : self._batch]

    @cached_property
    def _closed_rates(self) -> dict[str, float]:
        """Seconds per step of one trajectory of a batch: compiled, scipy, textbook."""
        return self._rates_of(self._closed_states)

    def _rates_of(self, states: np.ndarray) -> dict[str, float]:
        arguments = self._readout.weights, self._data.training.input_range
        steps = 20 if self._quick else 100
        rates = {
            name: self._clock.seconds(
                lambda dynamics=dynamics: dynamics.closed_loop(*arguments, states, steps)
            )
            / (steps * states.shape[1])
            for name, dynamics in (("compiled", self._compiled), ("scipy", self._scipy))
        }
        state = states[:, 0]
        rates["textbook"] = (
            self._clock.seconds(lambda: self._textbook.closed_loop(*arguments, state, steps))
            / steps
        )
        return rates

    @cached_property
    def _open_rates(self) -> dict[str, float]:
        """Seconds per step of one of ten trajectories: compiled, scipy, textbook."""
        inputs = self._inputs[: 100 if self._quick else 400]
        steps, _, batch = inputs.shape
        rates = {
            name: self._clock.seconds(lambda dynamics=dynamics: dynamics.open_loop(inputs))
            / (steps * batch)
            for name, dynamics in (("compiled", self._compiled), ("scipy", self._scipy))
        }
        zero = np.zeros(self._neurons)
        rates["textbook"] = (
            self._clock.seconds(lambda: self._textbook.open_loop(inputs[:100, :, 0], zero)) / 100
        )
        return rates

    def _row(self, stage: str, work: str, seconds: float, **more: float | None) -> Row:
        return Row(stage, work, self._neurons, seconds, **more)

    def _of_loop(self, stage: str, work: str, steps: float, rates: dict[str, float]) -> Row:
        operations = self._closed_operations
        if rates is self._open_rates:
            operations = self._open_operations
        return self._row(
            stage,
            work,
            steps * rates["compiled"],
            textbook=steps * rates["textbook"],
            scipy=steps * rates["scipy"],
            neuron_steps=steps * self._neurons,
            operations=steps * self._neurons * operations,
        )

    def _closed_loop(self) -> Row:
        return self._of_loop("closed loop", "1e5 trajectory-steps", 1e5, self._closed_rates)

    def _open_loop(self) -> Row:
        steps = self._inputs.shape[0] * self._inputs.shape[2]
        return self._of_loop("open loop", "the ten training series", steps, self._open_rates)

    @cached_property
    def _gram_seconds(self) -> tuple[float, float]:
        """Our and the textbook's time for the moments of all training rows."""
        panel = next(self._compiled.state_panels(self._inputs[200:])).columns
        targets = self._data.training.observed[:, 201 : 201 + panel.shape[1] // 10]
        targets = targets.transpose(2, 1, 0).reshape(targets.shape[2], -1)
        panels = 2 if self._quick else 4
        accumulator = MomentsAccumulator(self._neurons, len(targets))
        accumulator.add(panel, targets)  # the first call touches fresh memory

        def accumulate() -> None:
            for _ in range(panels):
                accumulator.add(panel, targets)

        share = self._rows / (panels * panel.shape[1])
        states, wanted = np.tile(panel, panels), np.tile(targets, panels)
        return (
            share * self._clock.seconds(accumulate),
            share * self._clock.seconds(lambda: textbook.products(states, wanted)),
        )

    @property
    def _rows(self) -> int:
        return self._collected.moments.count

    def _gram(self) -> Row:
        seconds, plain = self._gram_seconds
        return self._row(
            "Gram matrix",
            f"{self._rows} rows",
            seconds,
            textbook=plain,
            # of a symmetric product, half
            operations=float(self._rows) * self._neurons * (self._neurons + 1),
        )

    @cached_property
    def _ridge_seconds(self) -> tuple[float, float]:
        moments = self._collected.moments
        gram = np.tril(moments.gram) + np.tril(moments.gram, -1).T
        return (
            self._clock.seconds(lambda: solve_ridge(moments, TIKHONOV)),
            self._clock.seconds(lambda: textbook.ridge(gram, moments.cross, TIKHONOV)),
        )

    def _ridge(self) -> Row:
        seconds, plain = self._ridge_seconds
        return self._row(
            "ridge regression",
            "one beta",
            seconds,
            textbook=plain,
            operations=self._neurons**3 / 3,
        )

    def _trial(self) -> Row:
        data, betas = self._data, self._data.config["search"]["tikhonov"]

        def trial(dynamics: Dynamics) -> None:
            validate(dynamics, data.training, data.system.observable, data.plan, betas, STRATEGIES)

        intervals = data.training.series + data.plan.series * data.plan.intervals
        closed = len(betas) * intervals * data.plan.interval
        opened = self._inputs.shape[0] * self._inputs.shape[2]
        plain = (
            # each strategy by itself: nothing is shared
            len(STRATEGIES) * (opened * self._open_rates["textbook"] + self._gram_seconds[1])
            + closed * self._closed_rates["textbook"]
            + len(STRATEGIES) * len(betas) * self._ridge_seconds[1]
        )
        return self._row(
            "hyperparameter trial",
            f"SSV and RV, {len(betas)} betas",
            self._clock.seconds(lambda: trial(self._compiled), 2),
            textbook=plain,
            scipy=self._clock.seconds(lambda: trial(self._scipy), 1),
        )

    def _forecaster(self) -> CountingForecaster:
        network = EchoStateNetwork(self._compiled, self._readout, self._data.training.input_range)
        options = self._data.network
        seed = ReservoirSeed(0, self._neurons, 0, options["connectivity"], options["input_bias"])
        return CountingForecaster(
            network=network, seed=seed, divergence_bound=options["divergence_bound"]
        )

    def _of_forecaster(
        self, stage: str, work: str, run: Callable[[Forecaster], object], factor: float
    ) -> Row:
        counter = self._forecaster()
        run(counter)
        steps = factor * counter.steps
        return self._row(
            stage,
            work,
            factor * self._clock.seconds(lambda: run(self._forecaster()), 2),
            textbook=steps * self._closed_rates["textbook"],
            scipy=steps * self._closed_rates["scipy"],
            neuron_steps=steps * self._neurons,
            operations=steps * self._neurons * self._closed_operations,
        )

    def _forecasts(self) -> Row:
        data, setting = self._data, self._data.config["classification"]
        resolution = setting["resolution_lt"]
        reach = setting["longest_prediction_time_lt"] + setting["window_lt"]
        boundaries = window_boundaries(
            resolution, round(reach / resolution) - 1, data.lyapunov_time
        )
        series = 1 if self._quick else 4
        observed = data.observed[data.test][:series]
        points = starting_points(
            series,
            observed.shape[1],
            data.steps(setting["start_spacing_lt"]),
            data.plan.washout,
            data.steps(reach),
        )
        washouts = segments(observed, points, data.plan.washout - 1, 0)
        whole = data.case["test_series"]
        return self._of_forecaster(
            "forecasts",
            f"{whole} series, {whole * len(points) // series} starts",
            lambda forecaster: window_forecasts(
                forecaster, data.system.observable, washouts, boundaries
            ),
            whole / series,
        )

    def _horizon(self) -> Row:
        data, setting = self._data, self._data.config["horizon"]
        threshold = data.case["event_threshold"]
        search = HorizonSearch(
            longest_lead_time_lt=setting["longest_lead_time_lt"],
            lead_time_step_lt=setting["lead_time_step_lt"],
            largest_error=setting["tolerance"] * (threshold - data.truth.mean()),
            washout=data.plan.washout,
            steps_per_lyapunov_time=data.lyapunov_time,
        )
        truth = data.truth[data.test]
        events = horizon_events(
            crossing_points(truth, threshold),
            0,
            search.steps_before_event,
            16 if self._quick else 128,
        )
        observed = segments(data.observed[data.test], events, search.steps_before_event, 0)
        true = segments(truth, events, search.steps_before_event, 0)
        return self._of_forecaster(
            "prediction horizon",
            f"{setting['events']} events",
            lambda forecaster: prediction_horizons(
                forecaster, data.system.observable, observed, true, search
            ),
            setting["events"] / len(events),
        )

    def _long_term(self) -> Row:
        data, setting = self._data, self._data.config["statistics"]
        points = long_term_starting_points(
            data.training.series,
            data.training.length,
            data.steps(setting["start_spacing_lt"]),
            data.plan.washout,
            64,
        )
        washouts = segments(data.training.observed, points, data.plan.washout - 1, 0)
        density = data.case["density"]
        run = LongTermSettings(
            steps=100 if self._quick else 300,
            edges=np.linspace(*density["range"], density["bins"] + 1),
            laminarisation_threshold=None,
            fixed_point=None,
        )
        interval = data.case["ensemble"]["time_step"] * data.case["ensemble"]["sampling_stride"]
        steps = (setting["duration"] or data.case["ensemble"]["duration"]) / interval
        return self._of_forecaster(
            "long-term statistics",
            f"{setting['starting_points']} runs of {steps:.0f} steps",
            lambda forecaster: run_long_term(forecaster, data.system.observable, washouts, run),
            setting["starting_points"] / len(points) * steps / run.steps,
        )

    def beside_reservoirpy(self) -> list[str]:
        """Cells of one row: training and forecasts, and how many times longer ReservoirPy takes."""
        training, washout = self._data.training, self._data.plan.washout
        network = ReservoirpyNetwork(self._compiled)
        states = np.tile(self._closed_states, (1, 4))[:, :RESERVOIRPY_FORECASTS]

        def ours(steps: int = RESERVOIRPY_STEPS) -> np.ndarray:
            return self._compiled.closed_loop(
                self._readout.weights, training.input_range, states, steps
            )[0]

        def theirs(steps: int = RESERVOIRPY_STEPS) -> np.ndarray:
            return network.closed_loop(training.input_range, states, steps)

        trained = (
            self._clock.seconds(
                lambda: train(self._compiled, training, washout=washout, tikhonov=TIKHONOV)
            ),
            self._clock.seconds(lambda: network.train(training, washout, TIKHONOV), 2),
        )
        # the same work gives the same forecasts, as long as chaos has not magnified rounding
        np.testing.assert_allclose(theirs(5), ours(5), rtol=0, atol=1e-4)
        forecast = self._clock.seconds(ours), self._clock.seconds(theirs, 2)
        cells = [str(self._neurons)]
        for mine, other in (trained, forecast):
            cells += [f"{mine:.3g}", f"{other / mine:.3g}"]
        return cells


class ByNumpy(DynamicalSystem):
    """A system that takes numbers only, so that numpy has to integrate it."""

    def __init__(self, system: DynamicalSystem) -> None:
        self._system = system
        self.dimension = system.dimension

    def right_hand_side(self, state: np.ndarray) -> np.ndarray:
        """Those of the system."""
        return self._system.right_hand_side(np.asarray(state, dtype=np.float64))

    def jacobian(self, state: np.ndarray) -> np.ndarray:
        """Those of the system."""
        return self._system.jacobian(np.asarray(state, dtype=np.float64))

    def observable(self, state: np.ndarray) -> np.ndarray:
        """That of the system."""
        return self._system.observable(state)


def integration(data: Data, clock: Clock) -> list[Row]:
    """The ensemble of the case and its Lyapunov exponents."""
    setting = data.case["ensemble"]
    steps = (setting["duration"] + setting["transient"]) / setting["time_step"]
    systems = {"compiled": data.system, "numpy": ByNumpy(data.system)}
    measured, whole = SERIES_PER_BATCH, steps * setting["series"]
    per_step = {
        name: clock.seconds(lambda system=system: list(data.ensemble(measured, system)))
        / (measured * steps)
        for name, system in systems.items()
    }
    plain = clock.seconds(
        lambda: textbook.integrate(
            data.system.right_hand_side, data.states[0, 0], setting["time_step"], 200
        )
    )
    ensemble = Row(
        "integration",
        f"{setting['series']} series of {steps:.0f} steps",
        None,
        per_step["compiled"] * whole,
        textbook=plain / 200 * whole,
        scipy=per_step["numpy"] * whole,
    )
    lyapunov = data.case["lyapunov"]
    time_step = setting["time_step"]
    interval = round(lyapunov["orthonormalisation_interval"] / time_step)
    start = np.ascontiguousarray(np.resize(data.states[:, 0], (lyapunov["series"], 9)).T)

    def exponents(system: DynamicalSystem) -> None:
        lyapunov_spectrum(system, start, time_step, 2 * interval, interval)
        perturbation_growth(
            system, start, time_step, 2 * interval, 1e-8, 1e-2, np.random.default_rng(1)
        )

    exponents(data.system)  # compiles
    per_tangent_step = {
        name: clock.seconds(lambda system=system: exponents(system))
        / (2 * interval * lyapunov["series"])
        for name, system in systems.items()
    }
    whole = setting["duration"] / time_step * lyapunov["series"]
    tangents = Row(
        "Lyapunov exponents",
        f"{lyapunov['series']} series, by QR and by growth",
        None,
        per_tangent_step["compiled"] * whole,
        scipy=per_tangent_step["numpy"] * whole,
    )
    return [ensemble, tangents]


# --- Starts --------------------------------------------------------------------------------------

A_JOB = """
from pathlib import Path
from snakemake import script
from burstcast.base.discovery import imported_file
from burstcast_workflow.tracking.environment import environment
imported_file(Path("workflow/scripts/evaluation/forecast.py")), environment()
"""
STARTED = {
    "Python": "pass",
    "Snakemake's part of a job": "from snakemake import script",
    "a job from the cache, without its files": A_JOB,
    "`EventForecaster`": "from burstcast import EventForecaster; EventForecaster",
    "networks": "from burstcast.networks.training import train; import scipy.linalg, scipy.sparse",
    "scikit-optimize": "import skopt",
}
"""What is started, as a program."""


def starts(repeats: int) -> list[list[str]]:
    """Seconds of the processor of what is started often, and of plans of the paper's campaign."""
    seconds = {
        name: min(_seconds_of_a_start(program) for _ in range(repeats))
        for name, program in STARTED.items()
    }
    planned = plan([], {"results": "results/planning"})
    seconds[f"the plan of config.yaml, {planned.jobs} jobs, first"] = planned.first
    seconds["again"] = planned.again
    return [[name, f"{value:.2f}"] for name, value in seconds.items()]


def _seconds_of_a_start(program: str) -> float:
    process = subprocess.Popen([sys.executable, "-c", program], cwd=ROOT)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"a start fails: {program}")
    return usage.ru_utime + usage.ru_stime


# --- The report ----------------------------------------------------------------------------------


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """Lines of a markdown table."""
    return ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] * len(head), *rows)]


def write(section: str, lines: list[str]) -> None:
    """Put lines between the marks of a section of the document."""
    begin, end = f"<!-- {section}: begin -->", f"<!-- {section}: end -->"
    before, rest = DOCUMENT.read_text(encoding="utf-8").split(begin)
    _, after = rest.split(end)
    text = "\n".join([before + begin, *lines, end + after])
    DOCUMENT.write_text(text, encoding="utf-8")


def main() -> None:
    """Measure, print, and write where asked to."""
    parser = argparse.ArgumentParser(description="What each stage costs on this machine.")
    parser.add_argument("--sizes", type=int, nargs="+", default=[500, 1000, 2000, 3000])
    parser.add_argument("--quick", action="store_true", help="one size, little of everything")
    parser.add_argument("--write", action="store_true", help="write benchmarks/measured.md")
    options = parser.parse_args()
    sizes = [1000] if options.quick else options.sizes
    pin_to_one_core()
    clock = Clock(repeats=2 if options.quick else 5)
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    campaign = Campaign(load(config))
    data = Data(campaign, series=24 if options.quick else 80)
    rows, beside = [], []
    for neurons in sizes:
        stages = Stages(data, neurons, clock, quick=options.quick)
        rows += stages.rows()
        beside.append(stages.beside_reservoirpy())
        print(f"{neurons} neurons measured", flush=True)
    integrations = integration(data, clock)
    measured = [
        f"{machine()}. One thread;",
        f"dgemm reaches {clock.peak:.1f} GFLOP/s.",
        "",
        *table(HEAD, [row.cells(clock.peak) for row in (*integrations, *rows)]),
        "",
        "Starts, seconds of the processor:",
        "",
        *table(["start", "seconds"], starts(clock.repeats)),
        "",
        f"Beside ReservoirPy {version('reservoirpy')}, with the same sparse matrix, one thread:",
        "",
        *table(RESERVOIRPY_HEAD, beside),
    ]
    print("\n".join(["", *measured]))
    if options.write:
        write("measured", measured)


if __name__ == "__main__":
    main()

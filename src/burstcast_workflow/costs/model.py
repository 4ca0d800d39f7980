"""What a job takes: memory and time by the class of its work, from the sizes of its case.

A rule states the class (`CLASSES`). The prediction is for a first run: a scheduler is asked for
more, and for twice as much at each retry. What jobs of an earlier campaign took corrects the time
(`CostModel.earlier`).
"""

import csv
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from burstcast import durations
from burstcast.forecasters._names import parsed
from burstcast.forecasters.registry import kind_class
from burstcast.probability.precursor import TREES
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast_workflow.campaign.campaign import WHOSE, Campaign, name_of
from burstcast_workflow.config.case import Simulated

SECONDS_PER = {"neuron step": 2.2e-9, "product": 2.1e-11}
"""Seconds on one core of a step of a neuron, with its connections, and of one multiplication and
addition in a product of matrices. Only these and the times of start-up depend on the machine."""

SAFETY = 2.0
"""By how much a job asks for more time and memory than predicted."""

SNAKEMAKE_MIB = 350
"""Of a job on a cluster, beside its script: Snakemake, twice, and what starts it."""

RULE_COSTS = "rule_costs.csv"
"""Table of what the jobs of each rule took, beside Snakemake's records."""

# Seconds before a script computes, and MiB that it holds then: Python with NumPy and NetCDF; with
# SciPy and the compiled backend; with scikit-learn or scikit-optimize; pandas; Matplotlib.
_PLAIN, _COMPILED, _SEARCHING = (0.7, 100), (0.9, 170), (2.3, 270)
_TABLES, _DRAWING = (1.0, 130), (2.7, 300)
_MIB_PER_NUMBER = 8 / 2**20
# In steps of a neuron: a Runge-Kutta step of the equations, and of a component of a field; a number
# that is read or written; a fit of the search's Gaussian process.
_EQUATIONS, _COMPONENT, _NUMBER, _SURROGATE = 13, 100, 5, 1e8
_LYAPUNOV_TIME = 60  # in steps, where a job computes it


@dataclass(frozen=True)
class Cost:
    """Prediction for one job: seconds on one core, MiB of its script."""

    seconds: float
    memory_mib: float
    least_mib: float = 0.0  #: a bound: the Gram matrix of the network that the job trains

    def mib_for(self, attempt: int) -> int:
        """Memory to ask for: with a margin and room for Snakemake, doubled at each retry."""
        return math.ceil(SAFETY * self.memory_mib + SNAKEMAKE_MIB) << (attempt - 1)

    def minutes_for(self, attempt: int) -> int:
        """Time to ask for: with a margin, doubled at each retry."""
        return math.ceil(SAFETY * self.seconds / 60 + 0.5) << (attempt - 1)


class _Job:
    """Sizes of a job, and its work: start-up, neuron steps, products, numbers held at a time."""

    def __init__(self, campaign: Campaign, wildcards: Mapping[str, str]) -> None:
        self.start, self.steps, self.products, self.held = _PLAIN, 0.0, 0.0, 0.0
        self.campaign, self.config, self.wildcards = campaign, campaign.config, wildcards
        self.name = name_of(wildcards)
        # what is taken of all cases is judged by one of them
        place = wildcards.get("case") or campaign.example.case
        self.case = campaign.cases[place]
        self.dimension, of_source = self.case.space.dimension, self.case.source.space
        self.stride = self.case.ensemble.sampling_stride
        self.equations = _EQUATIONS * self.stride
        # a field integrates itself
        if isinstance(of_source, DynamicalSystem) and has_own(of_source, "flow_map"):
            self.equations = _COMPONENT * of_source.dimension * self.stride
        self.training = self.case.training.series
        self.series, self.samples = self._ensemble()
        self.states = self.series * self.samples
        left = max(0, self.series - self.training)
        self.tests = min(self.case.test_series or left, left)
        options = campaign.options(self.name.kind, place, self.name.label)
        self.neurons, self.members = self.name.neurons or 0, options.get("members", 1)
        # states once more for each factor of the parameters that the kind knows
        factors, degree = len(options.get("parameters", [])), options.get("parameter_degree", 1)
        self.features = self.neurons * math.comb(factors + degree, degree)
        learns = self.name.asks_forecasters and kind_class(self.name.kind).learns_parameters
        sources = len(campaign.sources(place)) if learns else 1
        self.washout = self.lt(self.config.washout_lt)
        self.rows = sources * self.training * max(0, self.samples - self.washout)

    def _ensemble(self) -> tuple[int, int]:
        """Series of the case's ensemble, and samples of each."""
        whole, data = self.case.source, self.case.data
        if isinstance(whole, Simulated):
            interval = self.case.ensemble.sampling_interval
            return whole.ensemble.series, int(whole.ensemble.duration / interval)
        # before the files are read, only their sizes are known
        files = map(Path, data.paths if data else [])
        held = sum(path.stat().st_size for path in files if path.exists())
        series = self.training + (self.case.test_series or self.training)
        return series, int(held / 8 / self.dimension / series)

    def lt(self, duration_lt: float) -> int:
        """Steps of a forecast in a duration."""
        steps = self.case.steps_per_lyapunov_time or _LYAPUNOV_TIME
        return durations.steps(duration_lt, steps)

    @cached_property
    def reach(self) -> int:
        """Steps from a starting point to the end of the last window."""
        return self.lt(self.config.classification.reach_lt)

    def starts(self, spacing_lt: float, reach: int = 0) -> int:
        """Starting points in a series."""
        return max(0, self.samples - self.washout - reach) // max(1, self.lt(spacing_lt))

    def takes(self, start: tuple[float, int], steps: float = 0, held: float = 0) -> None:
        """Add work: it starts the largest of its libraries, and holds all numbers together."""
        self.start = max(self.start, start)
        self.steps, self.held = self.steps + steps, self.held + held

    def data(self, copies: int, integrations: float = 0) -> None:
        """Copies of the ensemble, which is integrated so many times."""
        numbers = copies * self.states * self.dimension
        integrated = integrations * self.states * self.equations
        self.takes(_PLAIN, _NUMBER * numbers + integrated, numbers)

    def loops(self, count: float, steps: float) -> None:
        """Trajectories of the forecaster: a thousand together, of an ensemble's members at once."""
        solves = self.name.asks_forecasters and kind_class(self.name.kind).needs_equations
        each = self.neurons or (self.equations if solves else _EQUATIONS * self.stride)
        outputs = 4 * min(steps, 500) + 8 * self.members * (self.members > 1)
        start = _COMPILED if self.neurons or self.members > 1 else _PLAIN
        held = min(count, 1000) * (2 * self.neurons + outputs * self.dimension)
        self.takes(start, count * steps * each, held)

    def trained(self, points: float = 1, solves: float = 1) -> None:
        """The moments of the training series, and regressions, for each of several points."""
        self.takes(_PLAIN, _NUMBER * self.rows * self.dimension, 3 * self.rows * self.dimension)
        if self.neurons:
            held = 4 * self.features**2 + 2000 * self.features  # its copies, panels of states
            self.takes(_COMPILED, points * self.rows * self.neurons, held)
            solved = solves * self.features**3 / 3
            self.products += points * (self.rows * self.features**2 + solved)


# -- classes of work -------------------------------------------------------------------------------


def _search(job: _Job, points: int) -> None:
    """Points of a search: moments, and forecasts of validation intervals for each penalty."""
    said, recycled = job.config.search, job.case.recycle_validation
    interval, betas = job.lt(said.interval_lt), len(said.tikhonov)
    strategies = job.wildcards.get("strategies", str(job.name.validation)).split("+")
    # other strategies than these validate about as often as Recycle Validation
    often = recycled.series * (recycled.intervals_per_series or job.starts(said.interval_lt))
    intervals = sum(job.training if one == "SSV" else often for one in strategies)
    job.trained(points, betas * len(strategies))
    job.takes(_COMPILED, points * betas * intervals * interval * job.neurons)


def _bayesian_search(job: _Job) -> None:
    _search(job, job.config.search.bayesian_points)
    job.takes(_SEARCHING, _SURROGATE * job.config.search.bayesian_points)


def _forecasts(job: _Job, series: int, spacing_lt: float) -> None:
    """Forecasts from the starting points of series; of members of an ensemble, too."""
    forecasts = 1 + job.members * (job.members > 1)
    steps = job.members * job.washout + forecasts * job.reach
    job.loops(series * job.starts(spacing_lt, job.reach), steps)


def _leave_one_out(job: _Job) -> None:
    """Forecasts of the calibration set, by forecasters trained without each of its series."""
    said = job.config.probability
    _forecasts(job, said.calibration_series or job.training, said.start_spacing_lt)
    if not said.calibration_series:
        job.trained(solves=job.training)
        job.takes(_PLAIN, held=job.training * job.features**2)  # the moments of each series


def _classifiers(job: _Job) -> None:
    """Classifiers of each window, trained on all points, and on all folds but one."""
    said = job.config.forecasters
    points = job.training * job.starts(said.classifiers.start_spacing_lt, job.reach)
    fits = len(job.config.classification.prediction_times_lt) * (1 + said.classifiers.folds)
    size = said.esn_direct.neurons if job.name.kind == "esn_direct" else TREES
    job.takes(
        _SEARCHING,
        3 * fits * points * job.washout * size,
        points * (job.washout * job.dimension + 3 * size),
    )
    job.products += 10 * fits * points * size**2  # steps of Newton's method


def _horizons(job: _Job) -> None:
    """A fourth of the steps of all starts: most forecasts are given up on the way."""
    said = job.config.horizon
    starts = said.longest_lead_time_lt / said.lead_time_step_lt
    steps = job.members * job.washout + job.lt(said.longest_lead_time_lt)
    job.loops(said.events, starts * steps / 4)


def _long_runs(job: _Job, runs: int, times: int = 1) -> None:
    """Long runs, each as long as so many."""
    said, interval = job.config.statistics, job.case.ensemble.sampling_interval
    steps = int(said.duration / interval) if said.duration else job.samples
    starts = job.training * job.starts(said.start_spacing_lt)
    job.loops(min(runs, starts), times * (steps + job.members * job.washout))


def _control(job: _Job) -> None:
    """Flows with control, without, and with counterfactuals; forecasts that raise alarms."""
    plan = job.campaign.plan(job.wildcards["strategy"])
    values = dict(plan.settings)
    count = max(0, min(job.config.control.flows, job.series - job.training))
    far = values.get("prediction_time_lt", 0.0) + values.get("window_lt", 0.0)
    reach = job.lt(values.get("horizon_lt", far))
    span = job.lt((plan.span_lt or job.config.control.span_lt) + plan.quiet_lt)
    steps = 3 * count * (reach + span)
    job.takes(_PLAIN, steps * job.equations, 2 * steps * job.dimension)
    if job.name.asks_forecasters:
        interval_lt = values.get("decision_interval_lt", values.get("window_lt", 1.0))
        asked = job.campaign.controlling(job.wildcards["case"], job.name.identifier)
        members = job.members if job.name.role == "committee" else 1
        alarms = len(asked) * span / max(1, job.lt(interval_lt))
        job.loops(count, alarms * (job.members * job.washout + members * reach))


CLASSES: Mapping[str, Callable[[_Job], None]] = {
    "integration": lambda job: job.data(2, 1),
    "tangent": lambda job: job.data(1, 3),  # of few series, with all their perturbations
    "data": lambda job: job.data(1),  # it is read, and at most as much is held
    "search_grid": lambda job: _search(
        job, job.config.search.grid**2 * len(job.config.forecasters.esn.leak_rate)
    ),
    "search_points": _bayesian_search,
    "training": lambda job: job.trained(),
    # a few forecasts, as for a figure
    "examples": lambda job: job.loops(64, job.lt(job.config.horizon.longest_lead_time_lt)),
    "forecast": lambda job: _forecasts(job, job.tests, job.config.classification.start_spacing_lt),
    "leave_one_out": _leave_one_out,
    "classifiers": _classifiers,
    "horizon": _horizons,
    "long_term": lambda job: _long_runs(job, job.config.statistics.starting_points),
    # with perturbations, which no compiled code takes along
    "spectrum": lambda job: _long_runs(
        job,
        job.config.statistics.lyapunov_runs,
        1 + 4 * job.config.statistics.lyapunov_exponents,
    ),
    "control": _control,
    "gather": lambda job: job.takes(_TABLES),
    # the largest figure holds the observable of the whole ensemble, and what it draws of it
    "figure": lambda job: job.takes(_DRAWING, held=2 * job.states),
}
"""Classes of work by the names that rules use."""

_TRAINING = ("search_grid", "search_points", "training")


class CostModel:
    """Predicts what the jobs of a campaign take: estimates, not bounds.

    ``classes``: Class of work of each stage, as the rules state it. ``records``: Directory of
    Snakemake's records of what jobs took. ``earlier``: How many times the predicted time the jobs
    of a stage took in an earlier campaign, from ``table``, the newest `RULE_COSTS` beside the
    results (None without any).
    """

    def __init__(self, campaign: Campaign, seconds_per: Mapping[str, float] | None = None) -> None:
        self.campaign, self._seconds_per = campaign, seconds_per or SECONDS_PER
        self._known: dict[tuple[str, ...], Cost] = {}
        self.classes: dict[str, str] = {}
        results = Path(campaign.config.results)
        self.records = results / "benchmarks"
        tables = results.parent.glob(f"*/benchmarks/{RULE_COSTS}")
        self.table = max(tables, key=lambda path: path.stat().st_mtime, default=None)
        self.earlier = ratios(self.table) if self.table and not seconds_per else {}

    def predicted(self, cost_class: str, wildcards: Mapping[str, str], stage: str = "") -> Cost:
        """Predict what a job of a class of work takes, corrected by earlier jobs of its stage."""
        # asked for every job of a large campaign, several times: networks differ only by their seed
        names = {**wildcards}
        for who in {*WHOSE} & names.keys():
            names[who] = replace(parsed(names[who]), seed=None).identifier
        key = (cost_class, stage, *names.values())
        if key not in self._known:
            job = _Job(self.campaign, names)
            CLASSES[cost_class](job)
            seconds, mib = job.start
            seconds += self._seconds_per["neuron step"] * job.steps
            seconds += self._seconds_per["product"] * job.products
            self._known[key] = Cost(
                seconds * self.earlier.get(stage, 1.0),
                mib + job.held * _MIB_PER_NUMBER,
                job.features**2 * _MIB_PER_NUMBER * (cost_class in _TRAINING),
            )
        return self._known[key]


def ratios(table: Path) -> dict[str, float]:
    """How many times the predicted time the jobs of each rule took, from a `RULE_COSTS`.

    It is one half at least: results that came from a cache were there at once.
    """
    with table.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if int(row["records"])]
    return {
        row["rule"]: max(0.5, float(row["median_seconds"]) / float(row["predicted_median_seconds"]))
        for row in rows
    }

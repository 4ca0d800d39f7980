"""Cost of a job: memory and time from the campaign's settings, for schedulers and predictions.

A rule states the class of its work (`CLASSES`: a forecast, training, ...). The class says how much
work a job is, in units, and `SECONDS_PER` how many seconds a unit takes. Only that table and the
times of start-up depend on the machine. `burstcast_workflow.costs.records` sets predictions beside
what jobs took.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from burstcast import durations
from burstcast.forecasters._names import ForecasterName
from burstcast.forecasters.registry import kind_class, learns_parameters
from burstcast.probability.precursor import TREES
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast_workflow.campaign.campaign import WHOSE, Campaign, name_of
from burstcast_workflow.config.measured_cases import data_files, space_of
from burstcast_workflow.config.model import Simulated

SECONDS_PER = {
    # one Runge-Kutta step of one trajectory; the same with nine perturbations and two neighbours
    "integration step": 2.9e-8,
    "tangent step": 5.0e-7,
    # one step of a network in one trajectory: per neuron, and per connection of a neuron
    "neuron step": 1.3e-9,
    "connection step": 4.9e-11,
    # a Gram matrix: per row and squared neuron, and per row and neuron, whose state is centred and
    # multiplied with the targets; a ridge regression: per cubed neuron
    "gram product": 1.8e-11,
    "centred state": 3.5e-9,
    "solve product": 1.0e-11,
    # a regression without one more term: per cubed term
    "removed term": 4.5e-10,
    # one fit of the Gaussian process, with the proposal of the next point
    "surrogate fit": 0.2,
    # of boosted trees: per tree, and feature of a point
    "tree feature": 6e-9,
    # a number of the ensemble read and reduced, a bootstrap sample of one series, a small file read
    "number": 1.2e-8,
    "resampled series": 1.0e-7,
    "file": 0.005,
}
"""Seconds that a unit of work takes on one core."""

# Seconds before a script computes, and MiB that it holds then: Python with NumPy and NetCDF; with
# SciPy and the compiled backend; with scikit-optimize, too; with pandas; with Matplotlib.
_PLAIN, _COMPILED, _SEARCHING = (0.5, 90), (0.75, 160), (2.1, 260)
_TABLES, _DRAWING = (0.75, 90), (2.5, 210)
_MIB_PER_NUMBER = 8 / 2**20
_CANDIDATES = 5.0  # points of a search that its objective cannot tell from the best
_SCIPY_SLOWER = 4.0  # a network's step with the backend that is not compiled
_FIELD_STEP = 8.0  # of a component of a field, in steps of nine compiled equations
_FIELD_PERTURBATIONS = 7.0  # of a field, in perturbations of nine equations
_TYPICAL_LYAPUNOV_TIME = 60  # in steps, where it is not known before it is computed

_SEARCHED = ("spectral_radius", "input_scaling", "leak_rate", "penalty")
_NEWTON_STEPS = 10.0  # of a logistic regression

SAFETY = 2.0
"""By how much a job asks for more time and memory than predicted."""

SNAKEMAKE_MIB = 350
"""Of a job on a cluster, beside its script: Snakemake, twice, and what starts it."""


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
    """A job, and counts of its case that its work is made of."""

    def __init__(self, campaign: Campaign, wildcards: Mapping[str, str], name: ForecasterName):
        self.campaign, self.wildcards, self.name = campaign, wildcards, name
        # what is taken of all cases is judged by one of them
        self.case = wildcards.get("case") or campaign.example.case
        case = campaign.cases[self.case]
        self.lyapunov_time = case.steps_per_lyapunov_time or _TYPICAL_LYAPUNOV_TIME
        self.interval = case.ensemble.sampling_interval
        self.neurons = float(name.neurons or 0)
        self.dimension = campaign.space(self.case).dimension
        self.series, self.samples = _size(campaign, self.case)
        self.training_series = self("case.training.series")
        left = max(0, self.series - self.training_series)
        self.test_series = min(self("case.test_series") or left, left)
        self.numbers = self.series * self.samples * self.dimension
        self.transient = self("case.ensemble").get("transient", 0) / self.interval
        learns = name.asks_forecasters and learns_parameters(name.kind)
        sources = len(campaign.sources(self.case)) if learns else 1
        # of a network's readout: the states once more for each factor of the parameters
        options = campaign.options(name.kind, self.case, name.label)
        names, degree = options.get("parameters", []), options.get("parameter_degree", 1)
        factors = math.comb(len(names) + degree, degree)
        self.features = self.neurons * factors
        # of each learnt equation, before terms that are not significant are removed one by one
        highest = options.get("degree", 0)
        self.terms = factors * math.comb(int(self.dimension) + highest, highest)
        self.rows = (
            sources * self.training_series * max(0.0, self.samples - self.steps("washout_lt"))
        )
        self.stride = self("case.ensemble.sampling_stride")
        # an ensemble takes in the washout before a forecast
        self.members = options.get("members", 1)
        self.start_up = self.members * self.steps("washout_lt")
        self.forecasters = len(campaign.select(case=self.case))

    @property
    def integration_work(self) -> float:
        """Integration steps that one of the flow's equations counts as: many for a field."""
        source = self.campaign.cases[self.campaign.source_case(self.case)]
        system = space_of(source)
        solves = not self.name.asks_forecasters or kind_class(self.name.kind).needs_equations
        if not (solves and isinstance(system, DynamicalSystem) and has_own(system, "flow_map")):
            return 1.0
        return _FIELD_STEP * system.dimension

    def __call__(self, path: str) -> Any:
        """A setting by its path in the config."""
        return self.campaign.settings([path], {**self.wildcards, "case": self.case}, {})[path]

    def steps(self, *durations_lt: str | float) -> int:
        """Steps of a forecast in the sum of durations: Lyapunov times, or paths of settings."""
        total = sum(self(one) if isinstance(one, str) else one for one in durations_lt)
        return durations.steps(total, self.lyapunov_time)

    def starts(self, spacing: str, reach: float = 0.0) -> float:
        """Starting points in a series that leave room for the washout and a forecast."""
        room: float = self.samples - self.steps("washout_lt") - reach
        return max(0.0, room // max(1, self.steps(spacing)))

    @property
    def long_runs(self) -> tuple[float, float]:
        """Runs for long-term statistics, and the steps of each."""
        starts = self.training_series * self.starts("statistics.start_spacing_lt")
        duration = self("statistics.duration")
        steps = (duration / self.interval if duration else self.samples) + self.start_up
        return min(self("statistics.starting_points"), starts), steps


def _size(campaign: Campaign, case: str) -> tuple[float, float]:
    """Series, and samples in each series, of a case's ensemble."""
    one = campaign.cases[campaign.source_case(case)]
    if isinstance(one, Simulated):
        interval = campaign.cases[case].ensemble.sampling_interval
        return one.ensemble.series, one.ensemble.duration / interval
    # before the files are read, only their sizes are known
    files = map(Path, data_files(campaign.data(case)))
    held = sum(path.stat().st_size for path in files if path.exists())
    series = one.training.series + (one.test_series or one.training.series)
    return series, held / 8 / campaign.space(case).dimension / series


@dataclass(frozen=True)
class _Work:
    """Work of a job: seconds and MiB of its start-up, units of work, numbers in memory."""

    start_up: tuple[float, int]
    units: Mapping[str, float]
    held: float = 0.0

    def __add__(self, other: "_Work") -> "_Work":
        """Both in one job."""
        start_up = max(self.start_up, other.start_up)
        return _Work(start_up, Counter(self.units) + Counter(other.units), self.held + other.held)


# -- blocks of work --------------------------------------------------------------------------------


def _integration(job: _Job, count: float, steps: float, unit: str = "integration step") -> _Work:
    numbers = count * steps / job.stride * job.dimension
    # states are held as made and as written
    work = job.integration_work
    if unit == "tangent step" and work > 1.0:  # of more perturbations than nine
        work *= _FIELD_PERTURBATIONS
    return _Work(_PLAIN, {unit: work * steps * count, "number": numbers}, 2 * numbers)


def _network(job: _Job, steps: float, held: float) -> _Work:
    options = job("forecasters.esn")
    steps *= job.neurons * (_SCIPY_SLOWER if options["backend"] == "scipy" else 1.0)
    units = {"neuron step": steps, "connection step": steps * options["connectivity"]}
    return _Work(_COMPILED, units, held)


def _closed_loops(job: _Job, count: float, steps: float) -> _Work:
    # batches of a thousand, and their outputs of some hundred steps before they are reduced
    held = min(count, 1000) * (2 * job.neurons + 4 * min(steps, 500) * job.dimension)
    if job.neurons:
        return _network(job, count * steps, held)
    # other kinds of forecasters take what the equations take; an ensemble is held several times
    held += (job.members > 1) * min(count, 1000) * 8 * job.members * job.dimension
    start_up = _COMPILED if job.members > 1 else _PLAIN
    units = {"integration step": job.integration_work * count * steps * job.stride}
    return _Work(start_up, units, held)


def _training(job: _Job, points: float = 1, loops: float = 0, solves: float = 1) -> _Work:
    """Open loop, moments, and per point of a search steps of closed loops and regressions."""
    series = 3 * job.rows * job.dimension
    if not job.neurons:
        removals = job.dimension * job.terms**4 / 4
        units = {"number": job.rows * job.dimension, "removed term": removals}
        return _Work(_PLAIN, units, series)
    units = {
        "gram product": points * job.rows * job.features**2,
        "centred state": points * job.rows * job.neurons,
        "solve product": points * solves * job.features**3,
    }
    # training series, the Gram matrix with its copies, panels of a thousand states
    held = series + 4 * job.features**2 + 2000 * job.features
    return _network(job, points * (job.rows + loops), held) + _Work(_COMPILED, units)


def _forecasts(job: _Job, series: float, spacing: str) -> _Work:
    """Single forecasts, and forecasts of all members of an ensemble behind a filter."""
    reach = job.steps("classification.longest_prediction_time_lt", "classification.window_lt")
    forecasts = 1 + job.members if job.members > 1 else 1
    return _closed_loops(job, series * job.starts(spacing, reach), job.start_up + forecasts * reach)


def _gathering(job: _Job) -> _Work:
    """Small files of all forecasters into a table."""
    return _Work(_TABLES, {"file": job.forecasters}, 20 / _MIB_PER_NUMBER)


# -- classes of work -------------------------------------------------------------------------------


def _horizons(job: _Job) -> _Work:
    # three fifths of the starts are tried, and a forecast that fails is given up on the way
    tried = 0.6 * job("horizon.longest_lead_time_lt") / job("horizon.lead_time_step_lt")
    steps = job.start_up + 0.4 * job.steps("horizon.longest_lead_time_lt")
    return _closed_loops(job, job("horizon.events"), tried * steps)


def _search(job: _Job, points: float) -> _Work:
    strategies = job.wildcards.get("strategies", str(job.name.validation)).split("+")
    recycle, betas = job("case.recycle_validation"), len(job("search.tikhonov"))
    # other strategies than these validate about as often as Recycle Validation
    fitting = max(1.0, job.samples - job.steps("washout_lt")) / job.steps("search.interval_lt")
    recycled = recycle["series"] * (recycle["intervals_per_series"] or fitting)
    intervals = sum(job.training_series if one == "SSV" else recycled for one in strategies)
    loops = betas * intervals * job.steps("search.interval_lt")
    return _training(job, points, loops, betas * len(strategies))


def _bayesian_search(job: _Job) -> _Work:
    points = job("search.bayesian_points")
    return _search(job, points) + _Work(_SEARCHING, {"surrogate fit": points})


def _choice(job: _Job) -> _Work:
    """Long runs of some points of a search that are as good as the best."""
    count, steps = job.long_runs
    runs = _network(job, _CANDIDATES * count * steps, 2 * count * job.neurons)
    return _training(job, points=_CANDIDATES, solves=_CANDIDATES) + runs


def _leave_one_out(job: _Job) -> _Work:
    """Forecasts of the calibration set, by forecasters trained without each of its series."""
    series, own = job.training_series, job("probability.calibration_series")
    forecasts = _forecasts(job, own or series, "probability.start_spacing_lt")
    if own:
        return forecasts
    # the moments of each series, and of all but one
    merged = {"number": series * (series - 2) * job.neurons**2}
    moments = _Work(_PLAIN, merged, (series + 1) * job.neurons**2)
    return forecasts + _training(job, solves=series) + moments


def _classifiers(job: _Job) -> _Work:
    """Classifiers of each window, trained on all points, and on all folds but one."""
    reach = job.steps("classification.longest_prediction_time_lt", "classification.window_lt")
    options = {**job("forecasters.precursor"), **job.campaign.options(job.name.kind)}
    spacing = "forecasters.classifiers.start_spacing_lt"
    points = job.training_series * job.starts(spacing, reach)
    washout = job.steps("washout_lt")
    times = len(job("classification.prediction_times_lt"))
    own = job("probability.calibration_series")
    fits = times * (1 if own else 1 + job("forecasters.classifiers.folds"))
    held = points * washout * job.dimension
    if "neurons" not in options:
        features = job.dimension * (1 + len(options["lags_lt"]))
        units = {"tree feature": fits * TREES * points * features}
        return _Work(_SEARCHING, units, held + points * features)
    # a reservoir: its states after the washouts, and steps of Newton's method
    neurons = options["neurons"]
    fits += times * math.prod(len(options[name]) for name in _SEARCHED)
    units = {
        "neuron step": fits * points * washout * neurons,
        "gram product": fits * _NEWTON_STEPS * points * neurons**2,
    }
    return _Work(_COMPILED, units, held + 3 * points * neurons)


def _spectrum(job: _Job) -> _Work:
    """Long runs with their perturbations, which no compiled code takes along."""
    steps = job("statistics.lyapunov_runs") * job.long_runs[1]
    if not job.neurons:
        return _Work(_PLAIN, {"tangent step": job.stride * steps})
    perturbations = job("statistics.lyapunov_exponents")
    steps *= 1 + _SCIPY_SLOWER * perturbations
    return _network(job, steps, 8 * 6 * perturbations * job.neurons)


def _control(job: _Job) -> _Work:
    """Flows with control, without, and with counterfactuals; forecasts that raise alarms."""
    count = max(0, min(job("control.flows"), job.series - job.training_series))
    run = job("control.run")
    values = run["settings"]
    far = values.get("prediction_time_lt", 0.0) + values.get("window_lt", 0.0)
    reach = job.steps(values.get("horizon_lt", far))
    span = job.steps(run["span_lt"], run["quiet_lt"])
    flows = _integration(job, count, 3 * job.stride * (reach + span))
    if not job.name.asks_forecasters:
        return flows
    spacing = values.get("decision_interval_lt", values.get("window_lt", 1.0))
    alarms = span / max(1, job.steps(spacing))
    voters = len(job.campaign.controlling(job.case, job.name.identifier))
    members = job.members if job.name.role == "committee" else 1
    steps = voters * alarms * (job.start_up + members * reach)
    return flows + _closed_loops(job, count, steps)


def _bootstrap(job: _Job) -> _Work:
    """Intervals of scores of all forecasters."""
    scores = job("bootstrap.resamples") * len(job("classification.prediction_times_lt"))
    series = job.test_series * job.forecasters
    return _gathering(job) + _Work(_TABLES, {"resampled series": scores * series})


def _bootstrap_runs(job: _Job) -> _Work:
    """Statistics of resampled long runs: their histograms are summed anew each time."""
    numbers = job("case.density.bins") * job("statistics.starting_points")
    ours = sum(one.case == job.case for one in job.campaign.long_term_forecasters)
    units = {"number": 0.3 * job("bootstrap.resamples") * ours * numbers}
    return _gathering(job) + _Work(_TABLES, units, numbers)


def _exponents(job: _Job) -> _Work:
    count = min(job("case.lyapunov.series"), job.series)
    return _integration(job, count, job.stride * job.samples, "tangent step")


CLASSES: Mapping[str, Callable[[_Job], _Work]] = {
    "integration": lambda job: _integration(
        job, job.series, job.stride * (job.samples + job.transient)
    ),
    "tangent": _exponents,
    # the ensemble is read, and at most as much is held
    "data": lambda job: _Work(_PLAIN, {"number": job.numbers}, job.numbers),
    "search_grid": lambda job: _search(
        job, job("search.grid") ** 2 * len(job("forecasters.esn.leak_rate"))
    ),
    "search_points": _bayesian_search,
    "choice": _choice,
    "training": _training,
    # a few forecasts, as for a figure
    "examples": lambda job: _closed_loops(
        job, 64, job.start_up + job.steps("horizon.longest_lead_time_lt")
    ),
    "forecast": lambda job: _forecasts(job, job.test_series, "classification.start_spacing_lt"),
    "leave_one_out": _leave_one_out,
    "classifiers": _classifiers,
    "horizon": _horizons,
    "long_term": lambda job: _closed_loops(job, *job.long_runs),
    "spectrum": _spectrum,
    "control": _control,
    "gather": _gathering,
    "bootstrap": _bootstrap,
    "bootstrap_runs": _bootstrap_runs,
    # the largest figure holds the observable of the whole ensemble, and what it draws of it
    "figure": lambda job: _Work(_DRAWING, {}, 2 * job.series * job.samples),
}
"""Classes of work by the names that rules use."""

_TRAINING = ("search_grid", "search_points", "choice", "training")


class CostModel:
    """Predicts what the jobs of a campaign take: estimates, not bounds.

    ``classes``: Class of work of each stage, as the rules state it. ``records``: Directory of
    Snakemake's records of what jobs took.
    """

    def __init__(self, campaign: Campaign, seconds_per: Mapping[str, float] = SECONDS_PER) -> None:
        self._campaign, self._seconds_per = campaign, seconds_per
        self._known: dict[tuple[str, ...], Cost] = {}
        self.classes: dict[str, str] = {}
        self.records = Path(campaign.config.results) / "benchmarks"

    def at(self, seconds_per: Mapping[str, float]) -> "CostModel":
        """Cost of a job with other rates."""
        model = CostModel(self._campaign, seconds_per)
        model.classes = self.classes
        return model

    def predicted(self, cost_class: str, wildcards: Mapping[str, str]) -> Cost:
        """Predict what a job of a class of work takes."""
        name = name_of(wildcards)
        names = {key: value for key, value in wildcards.items() if key not in WHOSE}
        # asked for every job of a large campaign, several times: networks differ only by their seed
        forecaster = replace(name, seed=None).identifier
        key = (cost_class, forecaster, *names.values())
        if key not in self._known:
            job = _Job(self._campaign, names, name)
            work = CLASSES[cost_class](job)
            seconds, held = work.start_up
            seconds += sum(self._seconds_per[unit] * count for unit, count in work.units.items())
            least = job.features**2 * _MIB_PER_NUMBER * (cost_class in _TRAINING)
            self._known[key] = Cost(seconds, held + work.held * _MIB_PER_NUMBER, least)
        return self._known[key]

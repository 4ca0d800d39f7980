"""What a job costs: memory and time from the campaign's settings, for schedulers and predictions.

A rule states the class of its stage (closed loop, training, ...). The class says how much work a
job is, in units, and a table how many seconds a unit takes. Only that table and the start-up times
depend on the machine. `burstcast_workflow.cost_report` compares predictions with what jobs took.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from burstcast import durations
from burstcast.forecaster_options import options_of_kind
from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.measured_cases import data_files
from burstcast_workflow.identifiers import ForecasterName, parsed

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
    # one fit of the Gaussian process, with the proposal of the next point
    "surrogate fit": 0.2,
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
_TYPICAL_LYAPUNOV_TIME = 60  # in steps, where it is not known before it is computed

SAFETY = 2.0
"""By how much a job asks for more time and memory than predicted."""

SNAKEMAKE_MIB = 350
"""Of a job on a cluster, beside its script: Snakemake, twice, and what starts it."""


@dataclass(frozen=True)
class Cost:
    """Prediction for one job: seconds on one core, MiB of its script."""

    seconds: float
    memory_mib: float

    def mib_for(self, attempt: int) -> int:
        """Memory to ask for: with a margin and room for Snakemake, doubled at each retry."""
        return math.ceil(SAFETY * self.memory_mib + SNAKEMAKE_MIB) << (attempt - 1)

    def minutes_for(self, attempt: int) -> int:
        """Time to ask for: with a margin, doubled at each retry."""
        return math.ceil(SAFETY * self.seconds / 60 + 0.5) << (attempt - 1)


class _Job:
    """A job, and counts of its case that its work is made of."""

    def __init__(
        self, campaign: Campaign, stage: str, wildcards: Mapping[str, str], name: ForecasterName
    ) -> None:
        self.campaign, self.stage, self.wildcards, self.name = campaign, stage, wildcards, name
        # what is taken of all cases is judged by one of them
        self.case = wildcards.get("case") or campaign.example.case
        self.lyapunov_time = campaign.steps_per_lyapunov_time(self.case) or _TYPICAL_LYAPUNOV_TIME
        self.interval = campaign.sampling_interval(self.case)
        self.neurons = float(name.neurons or 0)
        self.forecasters = len(campaign.select(case=self.case))
        self.dimension = campaign.dimension(self.case)
        self.series, self.samples = _size(campaign, self.case)
        self.training_series = self("case.training.series")
        self.stride = self("case.ensemble.sampling_stride")
        transient = campaign.cases[self.case]["ensemble"].get("transient", 0)
        self.transient = transient / self.interval
        self.numbers = self.series * self.samples * self.dimension
        self.washout = self.steps("washout_lt")
        # what takes in the washout before a forecast: an ensemble, where it is filtered
        options = options_of_kind(name.kind, campaign.config["forecasters"])
        self.members = options.get("members", 1)
        self.start_up = self.members * self.washout
        # of control: how far forecasts reach, how long flows go on, how often they are forecast
        self.flows = max(0, min(self("control.flows"), self.series - self.training_series))
        run = self._plan_of_control(wildcards)
        values = run["settings"]
        spacing = values.get("decision_interval_lt", values.get("window_lt", 1.0))
        reach = values.get("prediction_time_lt", 0.0) + values.get("window_lt", 0.0)
        self.reach = self.steps(more=values.get("horizon_lt", reach))
        self.span = self.steps(more=run["span_lt"] + run["quiet_lt"])
        self.alarms = self.span / max(1, self.steps(more=spacing))

    def _plan_of_control(self, wildcards: Mapping[str, str]) -> Any:
        if "strategy" not in wildcards:
            return {"settings": {}, "span_lt": 0.0, "quiet_lt": 0.0}
        names = {"case": self.case, "strategy": wildcards["strategy"]}
        return self.campaign.settings(["control.run"], names, {})["control.run"]

    def __call__(self, path: str) -> Any:
        """A setting by its path in the config."""
        return self.campaign.settings([path], {"case": self.case}, {})[path]

    def steps(self, *paths: str, more: float = 0.0) -> int:
        """Steps of the network in the sum of some settings, in Lyapunov times."""
        return durations.steps(sum(map(self, paths), more), self.lyapunov_time)

    def starts(self, spacing: str, reach: float = 0.0) -> float:
        """Starting points in a series that leave room for the washout and a forecast."""
        room: float = self.samples - self.washout - reach
        return max(0.0, room // max(1, self.steps(spacing)))


def _forecasts(job: _Job, series: float, spacing: str) -> tuple[float, float]:
    """Single forecasts, and those of all members of an ensemble behind a filter."""
    reach = job.steps("classification.longest_prediction_time_lt", "classification.window_lt")
    forecasts = 1 + job.members if job.members > 1 else 1
    return series * job.starts(spacing, reach), job.start_up + forecasts * reach


def _size(campaign: Campaign, case: str) -> tuple[float, float]:
    """Series, and samples in each series, of a case's ensemble."""
    record = campaign.cases[campaign.source_case(case)]
    data, ensemble = record.get("data"), record["ensemble"]
    if data is None:
        return ensemble["series"], ensemble["duration"] / campaign.sampling_interval(case)
    # before the files are read, only their sizes are known
    held = sum(Path(path).stat().st_size for path in data_files(data) if Path(path).exists())
    series = record["training"]["series"] + record["test_series"]
    return series, held / 8 / campaign.dimension(case) / series


def _test_series(campaign: Campaign, case: str) -> float:
    record = campaign.cases[case]
    left = _size(campaign, case)[0] - record["training"]["series"]
    return float(max(0, min(record["test_series"], left)))


def _forecasts_of_control(job: _Job) -> tuple[float, float]:
    """Forecasts that raise alarms: of one forecaster, several networks, or a filter's members."""
    voters = job.campaign.controlling(job.case, job.name.identifier)
    members = job.members if job.name.role == "committee" else 1
    return job.flows, len(voters) * job.alarms * (job.start_up + members * job.reach)


def _horizon(job: _Job) -> tuple[float, float]:
    # three fifths of the starts are tried, and a forecast that fails is given up on the way
    tried = 0.6 * job("horizon.longest_lead_time_lt") / job("horizon.lead_time_step_lt")
    steps = job.start_up + 0.4 * job.steps("horizon.longest_lead_time_lt")
    return job("horizon.events"), tried * steps


def _long_term(job: _Job) -> tuple[float, float]:
    starts = job.training_series * job.starts("statistics.start_spacing_lt")
    steps = job("statistics.duration") / job.interval + job.start_up
    return min(job("statistics.starting_points"), starts), steps


# Trajectories and their steps: of a class, and of stages that differ from others of their class.
_TRAJECTORIES: dict[str, Callable[[_Job], tuple[float, float]]] = {
    # steps of the equations: the ensemble with its transient, flows with control and without
    "integration": lambda job: (job.series, job.stride * (job.samples + job.transient)),
    "tangent": lambda job: (min(job("case.lyapunov.series"), job.series), job.stride * job.samples),
    # with their counterfactuals
    "controlled flows": lambda job: (job.flows, 3 * job.stride * (job.reach + job.span)),
    # steps of a forecaster: a few forecasts, as for a figure, where it is not known better
    "closed_loop": lambda job: (64, job.start_up + job.steps("horizon.longest_lead_time_lt")),
    "forecast": lambda job: _forecasts(
        job, _test_series(job.campaign, job.case), "classification.start_spacing_lt"
    ),
    "calibration_forecast": lambda job: _forecasts(
        job,
        job("probability.calibration_series") or job.training_series,
        "probability.start_spacing_lt",
    ),
    "horizon": _horizon,
    "long_term": _long_term,
    "control": _forecasts_of_control,
}

# What a class takes: start-up, work, numbers held.
_Account = tuple[tuple[float, int], dict[str, float], float]


def _together(work: dict[str, float], more: dict[str, float]) -> dict[str, float]:
    return {unit: work.get(unit, 0) + more.get(unit, 0) for unit in {**work, **more}}


def _integration(job: _Job, unit: str = "integration", stage: str = "") -> _Account:
    count, steps = _TRAJECTORIES.get(stage or job.stage, _TRAJECTORIES[unit])(job)
    numbers = count * steps / job.stride * job.dimension
    # states are held as made and as written
    return _PLAIN, {f"{unit} step": steps * count, "number": numbers}, 2 * numbers


def _network_steps(job: _Job, steps: float) -> dict[str, float]:
    options = job("forecasters.esn")
    steps *= job.neurons * (_SCIPY_SLOWER if options["backend"] == "scipy" else 1.0)
    return {"neuron step": steps, "connection step": steps * options["connectivity"]}


def _closed_loop(job: _Job, kind: str = "closed_loop") -> _Account:
    count, steps = _TRAJECTORIES.get(job.stage, _TRAJECTORIES[kind])(job)
    # batches of a thousand, and their outputs of some hundred steps before they are reduced
    held = min(count, 1000) * (2 * job.neurons + 4 * min(steps, 500) * job.dimension)
    if job.name.kind == "esn":
        return _COMPILED, _network_steps(job, count * steps), held
    # other kinds of forecasters take what the equations take; an ensemble is held several times
    held += (job.members > 1) * min(count, 1000) * 8 * job.members * job.dimension
    start_up = _COMPILED if job.members > 1 else _PLAIN
    return start_up, {"integration step": count * steps * job.stride}, held


def _leave_one_out(job: _Job) -> _Account:
    """Forecasts of the calibration set, by forecasters trained without each of its series."""
    start_up, work, held = _closed_loop(job, "calibration_forecast")
    if job("probability.calibration_series"):
        return start_up, work, held
    _, training, moments = _training(job, solves=job.training_series)
    merged = job.training_series * (job.training_series - 2) * job.neurons**2
    work = _together(_together(work, training), {"number": merged})
    # the moments of each series, and those of all but one
    return start_up, work, held + moments + (job.training_series + 1) * job.neurons**2


def _spectrum(job: _Job) -> _Account:
    """Long runs with their perturbations, which no compiled code takes along."""
    count, steps = job("statistics.lyapunov_runs"), _long_term(job)[1]
    perturbations = job("statistics.lyapunov_exponents")
    if job.name.kind != "esn":
        steps *= count * job.stride
        return _PLAIN, {"tangent step": steps}, 0
    work = _network_steps(job, (1 + _SCIPY_SLOWER * perturbations) * count * steps)
    return _COMPILED, work, 8 * 6 * perturbations * job.neurons


def _control(job: _Job) -> _Account:
    """Flows with and without control, and the forecasts that raise alarms."""
    plain, of_flows, held_by_flows = _integration(job, stage="controlled flows")
    if not job.name.asks_forecasters:
        return plain, of_flows, held_by_flows
    start_up, work, held = _closed_loop(job, "control")
    return start_up, _together(work, of_flows), held + held_by_flows


def _training(job: _Job, points: float = 1, loops: float = 0, solves: float = 1) -> _Account:
    """Open loop, moments, and per point of a search steps of closed loops and regressions."""
    rows = job.training_series * max(0.0, job.samples - job.washout)
    if job.name.kind != "esn":
        return _PLAIN, {"number": rows * job.dimension}, 3 * rows * job.dimension
    work = {
        **_network_steps(job, points * (rows + loops)),
        "gram product": points * rows * job.neurons**2,
        "centred state": points * rows * job.neurons,
        "solve product": points * solves * job.neurons**3,
    }
    # training series, the Gram matrix with its copies, panels of a thousand states
    held = 3 * rows * job.dimension + 4 * job.neurons**2 + 2000 * job.neurons
    return _COMPILED, work, held


def _choice(job: _Job) -> _Account:
    """Long runs of some points of a search that are as good as the best."""
    start_up, training, held = _training(job, points=_CANDIDATES, solves=_CANDIDATES)
    count, steps = _long_term(job)
    runs = _network_steps(job, _CANDIDATES * count * steps)
    return start_up, _together(training, runs), held + 2 * count * job.neurons


def _search(job: _Job, points: float, bayesian: bool = False) -> _Account:
    strategies = job.wildcards.get("strategies", str(job.name.validation)).split("+")
    recycle, betas = job("case.recycle_validation"), len(job("search.tikhonov"))
    # other strategies than these validate about as often as Recycle Validation
    recycled = recycle["series"] * recycle["intervals_per_series"]
    intervals = sum(job.training_series if one == "SSV" else recycled for one in strategies)
    loops = betas * intervals * job.steps("search.interval_lt")
    start_up, work, held = _training(job, points, loops, betas * len(strategies))
    if bayesian:
        return _SEARCHING, {**work, "surrogate fit": points}, held
    return start_up, work, held


def _bootstrap(job: _Job) -> _Account:
    scores = job("bootstrap.resamples") * len(job("classification.prediction_times_lt"))
    series = _test_series(job.campaign, job.case) * job.forecasters
    start_up, work, held = _CLASSES["gather"](job)
    return start_up, {**work, "resampled series": scores * series}, held


def _bootstrap_runs(job: _Job) -> _Account:
    """Statistics of resampled long runs: their histograms are summed anew each time."""
    bins, runs = job("case.density.bins"), job("statistics.starting_points")
    ours = [one for one in job.campaign.long_term_forecasters if one.case == job.case]
    resamples = job("bootstrap.resamples") * len(ours)
    start_up, work, held = _CLASSES["gather"](job)
    return start_up, {**work, "number": 0.3 * resamples * runs * bins}, held + runs * bins


_CLASSES: dict[str, Callable[[_Job], _Account]] = {
    "integration": _integration,
    "tangent": lambda job: _integration(job, unit="tangent"),
    # the ensemble is read, and at most as much is held
    "data": lambda job: (_PLAIN, {"number": job.numbers}, job.numbers),
    "search_grid": lambda job: _search(job, job("search.grid") ** 2),
    "search_points": lambda job: _search(job, job("search.bayesian_points"), bayesian=True),
    "choice": _choice,
    "training": _training,
    "closed_loop": _closed_loop,
    "leave_one_out": _leave_one_out,
    "spectrum": _spectrum,
    "control": _control,
    # small files of all forecasters into a table; the same with intervals of scores
    "gather": lambda job: (_TABLES, {"file": job.forecasters}, 20 / _MIB_PER_NUMBER),
    "bootstrap": _bootstrap,
    "bootstrap_runs": _bootstrap_runs,
    # the largest figure holds the observable of the whole ensemble, and what it draws of it
    "figure": lambda job: (_DRAWING, {}, 2 * job.series * job.samples),
}


class CostModel:
    """Predicts what the jobs of a campaign take: estimates, not bounds."""

    def __init__(self, campaign: Campaign, seconds_per: Mapping[str, float] = SECONDS_PER) -> None:
        self._campaign, self._seconds_per = campaign, seconds_per
        self._known: dict[tuple[str, ...], Cost] = {}

    def predicted(self, cost_class: str, stage: str, wildcards: Mapping[str, str]) -> Cost:
        """Predict what a job takes; a stage that is not known here is like others of its class."""
        names = dict(wildcards.items())
        whose = [names.pop(key, "") for key in ("forecaster", "controller", "reservoir")]
        name = parsed(next(filter(None, whose), "none"))
        # asked for every job of a large campaign, several times: networks differ only by their seed
        forecaster = replace(name, seed=None).identifier
        key = (cost_class, stage, forecaster, *names.values())
        if key not in self._known:
            job = _Job(self._campaign, stage, names, name)
            (seconds, held), work, numbers = _CLASSES[cost_class](job)
            seconds += sum(self._seconds_per[unit] * count for unit, count in work.items())
            self._known[key] = Cost(seconds, held + numbers * _MIB_PER_NUMBER)
        return self._known[key]

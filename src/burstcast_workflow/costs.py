"""What a job costs: memory and time from the campaign's settings, for schedulers and predictions.

The work of each rule is counted in units (steps of the integration, of neurons, products of Gram
matrices, ...); a table says how many seconds a unit takes. Only that table and the start-up times
depend on the machine. `burstcast_workflow.cost_report` compares predictions with the records of
what jobs took.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from burstcast import durations
from burstcast_workflow.campaign import Campaign
from burstcast_workflow.identifiers import ForecasterName, parsed

Wildcards = Mapping[str, str]

SECONDS_PER = {
    # one Runge-Kutta step: of a whole batch (what Python takes), and of one trajectory in it
    "integration call": 1.7e-4,
    "integration step": 2.5e-7,
    # the same with nine perturbations and their Jacobians
    "tangent call": 4.0e-4,
    "tangent step": 1.3e-6,
    # one step of a network in one trajectory: per neuron, and per connection of a neuron
    "neuron step": 1.6e-9,
    "connection step": 1.0e-10,
    # a Gram matrix: per row and squared neuron; a ridge regression: per cubed neuron
    "gram product": 2.9e-11,
    "solve product": 2.0e-11,
    # one fit of the Gaussian process, with the proposal of the next point
    "surrogate fit": 0.2,
    # a number read or written, one with noise, one that goes into histograms and moments
    "number": 4.0e-9,
    "noisy number": 3.0e-8,
    "reduced number": 2.0e-8,
    # a bootstrap sample of one series; a file of a network read, a row of a table
    "resampled series": 1.0e-7,
    "file": 0.005,
}
"""Seconds that a unit of work takes on one core."""

# What a script takes before it computes, in seconds, and what it holds then, in MiB: Python with
# NumPy and NetCDF; with the numba backend; with scikit-optimize, too; with Matplotlib; with
# Matplotlib that draws flow fields.
_PLAIN = (0.6, 90)
_COMPILED = (1.2, 190)
_SEARCH = (2.5, 290)
_DRAWING = (2.0, 150)
_DRAWING_FIELDS = (4.0, 210)
_FIGURES_OF_FIELDS = ("midplane_planes", "suppressed_event", "vorticity_isosurfaces")

# What the backend that is not compiled spares at the start, and how much longer its steps take.
_SCIPY_BACKEND = (0.4, 75)
_SCIPY_SLOWER = 4.0

SAFETY = 2.0
"""By how much a job asks for more time and memory than predicted."""

SNAKEMAKE_MIB = 350
"""Of a job on a cluster, beside its script: Snakemake, twice, and what starts it."""

_TYPICAL_LYAPUNOV_TIME = 60  # in steps, where it is not known before it is computed
_PANEL_COLUMNS = 1000
_FORECASTS_PER_BATCH = 1024
_ARRAYS_PER_SERIES = 2.5  # copies of states that are held at a time: true, observed, transposed
_MIB_PER_NUMBER = 8 / 2**20


@dataclass(frozen=True)
class Cost:
    """Prediction for one job: seconds on one core, MiB of its script."""

    seconds: float
    memory_mib: float


@dataclass(frozen=True)
class _Sizes:
    """Counts that the work of a case is made of."""

    campaign: Campaign
    case: str
    name: ForecasterName

    @property
    def neurons(self) -> int:
        return self.name.neurons or 0

    @property
    def record(self) -> Mapping[str, object]:
        return self.campaign.cases[self.case]

    def setting(self, *names: str) -> float:
        value: object = self.record
        for name in names:
            assert isinstance(value, Mapping)
            value = value[name]
        assert isinstance(value, int | float)
        return value

    @property
    def dimension(self) -> int:
        initial = self.campaign.cases[self.case]["ensemble"]["initial_state"]
        return len(initial)

    @property
    def lyapunov_time(self) -> int:
        return self.campaign.steps_per_lyapunov_time(self.case) or _TYPICAL_LYAPUNOV_TIME

    def steps(self, duration_lt: float) -> int:
        return durations.steps(duration_lt, self.lyapunov_time)

    @property
    def washout(self) -> int:
        return self.steps(self.campaign.config["washout_lt"])

    @property
    def samples(self) -> float:
        return self.setting("ensemble", "duration") / self.campaign.sampling_interval(self.case)

    @property
    def series(self) -> float:
        """Series of the ensemble, as if none laminarised."""
        return self.setting("ensemble", "series")

    @property
    def integration_steps(self) -> float:
        """Runge-Kutta steps of a kept series."""
        return self.setting("ensemble", "duration") / self.setting("ensemble", "time_step")

    @property
    def stride(self) -> float:
        return self.setting("ensemble", "sampling_stride")

    @property
    def training_series(self) -> float:
        return self.setting("training", "series")

    @property
    def training_rows(self) -> float:
        return self.training_series * max(0.0, self.samples - self.washout)

    @property
    def forecast_reach(self) -> int:
        classification = self.campaign.config["classification"]
        return self.steps(
            classification["longest_prediction_time_lt"] + classification["window_lt"]
        )

    @property
    def test_series(self) -> float:
        return min(self.setting("test_series"), max(0.0, self.series - self.training_series))

    @property
    def test_points(self) -> float:
        spacing = self.steps(self.campaign.config["classification"]["start_spacing_lt"])
        room = self.samples - self.washout - self.forecast_reach
        return self.test_series * max(0.0, room // max(1, spacing))

    @property
    def events(self) -> float:
        return float(self.campaign.config["horizon"]["events"])

    @property
    def event_steps(self) -> int:
        return self.steps(self.campaign.config["horizon"]["longest_start_lt"]) + self.washout

    @property
    def long_term_points(self) -> float:
        statistics = self.campaign.config["statistics"]
        spacing = max(1, self.steps(statistics["start_spacing_lt"]))
        room = self.training_series * max(0.0, (self.samples - self.washout) // spacing)
        return min(float(statistics["starting_points"]), room)

    @property
    def flows(self) -> float:
        flows = float(self.campaign.config["control"]["flows"])
        return min(flows, max(0.0, self.series - self.training_series))


_Work = dict[str, float]


def _forecast_steps(sizes: _Sizes, trajectory_steps: float) -> _Work:
    """Steps of a network, or of the equations: what other kinds take is like the latter."""
    if sizes.name.kind != "esn":
        integration = trajectory_steps * sizes.stride
        return {"integration call": integration / 1000, "integration step": integration}
    options = sizes.campaign.config["forecasters"]["esn"]
    slower = _SCIPY_SLOWER if options["backend"] == "scipy" else 1.0
    neuron_steps = trajectory_steps * sizes.neurons * slower
    connections = neuron_steps * options["connectivity"]
    return {"neuron step": neuron_steps, "connection step": connections}


def _start_up(sizes: _Sizes, search: bool = False) -> tuple[float, int]:
    seconds, mib = _SEARCH if search else _COMPILED
    if sizes.name.kind != "esn":
        return _PLAIN
    if sizes.campaign.config["forecasters"]["esn"]["backend"] == "scipy":
        return seconds - _SCIPY_BACKEND[0], mib - _SCIPY_BACKEND[1]
    return seconds, mib


def _total(*works: _Work) -> _Work:
    total: _Work = {}
    for work in works:
        for unit, count in work.items():
            total[unit] = total.get(unit, 0.0) + count
    return total


def _times(work: _Work, factor: float) -> _Work:
    return {unit: count * factor for unit, count in work.items()}


def _series_mib(sizes: _Sizes, series: float, steps: float | None = None) -> float:
    """Memory of the states of some series."""
    return series * (steps or sizes.samples) * sizes.dimension * _MIB_PER_NUMBER


# -- one function per rule: start-up, work, MiB beyond the start-up

_Account = tuple[tuple[float, int], _Work, float]


def _simulate(sizes: _Sizes, _: Wildcards) -> _Account:
    steps = sizes.integration_steps + sizes.setting("ensemble", "transient") / sizes.setting(
        "ensemble", "time_step"
    )
    numbers = sizes.series * sizes.samples * sizes.dimension
    work = {
        "integration call": steps * math.ceil(sizes.series / 1000),
        "integration step": steps * sizes.series,
        "number": numbers,
    }
    return _PLAIN, work, 2 * _series_mib(sizes, sizes.series)


def _lyapunov(sizes: _Sizes, _: Wildcards) -> _Account:
    series = min(sizes.setting("lyapunov", "series"), sizes.series)
    steps = sizes.integration_steps
    work = {
        "tangent call": steps,
        "tangent step": steps * series,
        "integration call": steps,
        "integration step": 2 * steps * series,
    }
    return _PLAIN, work, 2 * _series_mib(sizes, series)


def _evaluation_set(sizes: _Sizes, _: Wildcards) -> _Account:
    numbers = sizes.test_series * sizes.samples * sizes.dimension
    stretch = sizes.test_points * (sizes.forecast_reach + sizes.washout)
    work = {"noisy number": numbers, "number": numbers + stretch * sizes.dimension}
    memory = 2 * _series_mib(sizes, sizes.test_series)
    return _PLAIN, work, memory + stretch * sizes.dimension * _MIB_PER_NUMBER


def _events(sizes: _Sizes, _: Wildcards) -> _Account:
    numbers = sizes.series * sizes.samples
    stretch = sizes.events * sizes.event_steps
    # the series that hold the events: several in each
    series = min(sizes.series, sizes.events / 3)
    work = {"number": 2 * numbers, "noisy number": series * sizes.samples * sizes.dimension}
    memory = 2 * numbers * _MIB_PER_NUMBER + 3 * _series_mib(sizes, series)
    return _PLAIN, work, memory + stretch * sizes.dimension * _MIB_PER_NUMBER


def _reference_statistics(sizes: _Sizes, _: Wildcards) -> _Account:
    numbers = sizes.series * sizes.samples * sizes.dimension
    return (
        _PLAIN,
        {"number": numbers, "reduced number": numbers},
        5 * _series_mib(sizes, min(sizes.series, 100)),
    )


def _validation(sizes: _Sizes, neurons: int, strategies: list[str]) -> _Work:
    """One point of the search: open loop, moments, and every strategy with every beta."""
    campaign = sizes.campaign
    search, recycle = (
        campaign.config["search"],
        sizes.campaign.cases[sizes.case]["recycle_validation"],
    )
    betas = len(search["tikhonov"])
    intervals = {
        "SSV": sizes.training_series,
        "RV": recycle["series"] * recycle["intervals_per_series"],
    }
    # other strategies than these validate about as often as Recycle Validation
    closed = sum(intervals.get(strategy, intervals["RV"]) for strategy in strategies) * sizes.steps(
        search["interval_lt"]
    )
    return _total(
        _forecast_steps(sizes, sizes.training_rows + betas * closed),
        {
            "gram product": sizes.training_rows * float(neurons) ** 2,
            "solve product": len(strategies) * betas * float(neurons) ** 3,
        },
    )


def _training_mib(sizes: _Sizes, neurons: int) -> float:
    """Training series, Gram matrix with its copies, panels of states."""
    panels = 2 * neurons * max(_PANEL_COLUMNS, sizes.training_series)
    return (
        _ARRAYS_PER_SERIES * _series_mib(sizes, sizes.training_series)
        + (4 * neurons**2 + panels) * _MIB_PER_NUMBER
    )


def _validated_states_mib(sizes: _Sizes, neurons: int) -> float:
    recycle = sizes.campaign.cases[sizes.case]["recycle_validation"]
    starts = recycle["intervals_per_series"] * (sizes.training_series + recycle["series"])
    return float(neurons * starts * _MIB_PER_NUMBER)


def _scan(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    neurons = sizes.neurons
    points = sizes.campaign.config["search"]["grid"] ** 2
    work = _times(_validation(sizes, neurons, wildcards["strategies"].split("+")), points)
    memory = _training_mib(sizes, neurons) + _validated_states_mib(sizes, neurons)
    return _start_up(sizes), work, memory


def _search(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    neurons = sizes.neurons
    point = _total(
        _validation(sizes, neurons, [str(sizes.name.validation)]), {"surrogate fit": 1.0}
    )
    work = _times(point, sizes.campaign.config["search"]["bayesian_points"])
    memory = _training_mib(sizes, neurons) + _validated_states_mib(sizes, neurons)
    return _start_up(sizes, search=True), work, memory


def _train(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    neurons = sizes.neurons
    work = _total(
        _forecast_steps(sizes, sizes.training_rows),
        {
            "gram product": sizes.training_rows * float(neurons) ** 2,
            "solve product": float(neurons) ** 3,
        },
    )
    return _start_up(sizes), work, _training_mib(sizes, neurons)


def _running_mib(sizes: _Sizes, neurons: int, trajectories: float, steps: float) -> float:
    """Reservoir states of a batch, twice, and the outputs of some steps."""
    batch = min(trajectories, _FORECASTS_PER_BATCH)
    return (2 * neurons * batch + 3 * batch * steps * sizes.dimension) * _MIB_PER_NUMBER


def _forecast(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    neurons = sizes.neurons
    steps = sizes.washout + sizes.forecast_reach
    work = _forecast_steps(sizes, sizes.test_points * steps)
    washouts = 2 * sizes.test_points * sizes.washout * sizes.dimension * _MIB_PER_NUMBER
    running = _running_mib(sizes, neurons, sizes.test_points, sizes.forecast_reach)
    return _start_up(sizes), work, washouts + running


def _horizon(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    neurons = sizes.neurons
    horizon = sizes.campaign.config["horizon"]
    # three fifths of the starts are tried, and a forecast that fails is given up on the way
    starts = 0.6 * horizon["longest_start_lt"] / horizon["start_step_lt"]
    steps = starts * (sizes.washout + 0.4 * sizes.steps(horizon["longest_start_lt"]))
    work = _forecast_steps(sizes, sizes.events * steps)
    segments = 2 * sizes.events * sizes.event_steps * sizes.dimension * _MIB_PER_NUMBER
    return _start_up(sizes), work, segments + _running_mib(sizes, neurons, sizes.events, 16)


def _long_term(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    neurons = sizes.neurons
    duration = sizes.campaign.config["statistics"]["duration"]
    steps = duration / sizes.campaign.sampling_interval(sizes.case)
    points = sizes.long_term_points
    work = _total(
        _forecast_steps(sizes, points * (steps + sizes.washout)),
        {"reduced number": points * steps * sizes.dimension},
    )
    training = _ARRAYS_PER_SERIES * _series_mib(sizes, sizes.training_series)
    return _start_up(sizes), work, training + _running_mib(sizes, neurons, points, 100)


def _flows(sizes: _Sizes, wildcards: Wildcards) -> tuple[_Work, float, float]:
    """Integration of controlled flows, their memory, and forecasts per flow."""
    control = sizes.campaign.config["control"]
    prediction_time = float(wildcards.get("prediction_time_lt", control["prediction_times_lt"][0]))
    steps = sizes.steps(prediction_time + control["window_lt"] + control["span_lt"])
    calls = steps * sizes.stride
    # with control, without, and what alarms would have led to
    work = {
        "integration call": 3 * calls,
        "integration step": 3 * calls * sizes.flows,
        "noisy number": steps * sizes.flows * sizes.dimension,
    }
    # the series that they start from are read whole, and dropped
    reading = _series_mib(sizes, sizes.flows)
    running = 3 * _series_mib(sizes, sizes.flows, steps + sizes.washout)
    return work, max(reading, running), control["span_lt"] / control["window_lt"]


def _control(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    neurons = sizes.neurons
    control = sizes.campaign.config["control"]
    prediction_time = float(wildcards.get("prediction_time_lt", control["prediction_times_lt"][0]))
    flows, memory, forecasts = _flows(sizes, wildcards)
    steps = sizes.washout + sizes.steps(prediction_time + control["window_lt"])
    work = _total(flows, _forecast_steps(sizes, sizes.flows * forecasts * steps))
    return _start_up(sizes), work, memory + _running_mib(sizes, neurons, sizes.flows, steps)


def _suppressed_event(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    """Run the control again, and then one of its flows by itself."""
    start_up, work, memory = _control(sizes, wildcards)
    alone = {"integration call": work["integration call"]}
    return start_up, _total(work, alone), memory


def _control_random(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    flows, memory, _ = _flows(sizes, wildcards)
    return _PLAIN, flows, memory


def _single_forecasts(sizes: _Sizes, wildcards: Wildcards) -> _Account:
    """A few forecasts of one network, for figures."""
    neurons = sizes.neurons
    trajectories = 64.0
    work = _forecast_steps(sizes, trajectories * sizes.event_steps)
    segments = sizes.events * sizes.event_steps * sizes.dimension * _MIB_PER_NUMBER
    return _start_up(sizes), work, 2 * segments + _running_mib(sizes, neurons, trajectories, 100)


_OF_A_CASE: dict[str, Callable[[_Sizes, Wildcards], _Account]] = {
    "simulate": _simulate,
    "lyapunov": _lyapunov,
    "evaluation_set": _evaluation_set,
    "events": _events,
    "reference_statistics": _reference_statistics,
    "scan": _scan,
    "search": _search,
    "train": _train,
    "forecast": _forecast,
    "horizon": _horizon,
    "long_term": _long_term,
    "control": _control,
    "control_random": _control_random,
    "suppressed_event": _suppressed_event,
}


def _classification_table(campaign: Campaign) -> _Account:
    sizes = [_Sizes(campaign, one.case, one.name) for one in campaign.forecasters]
    times = len(campaign.config["classification"]["prediction_times_lt"])
    resamples = campaign.config["bootstrap"]["resamples"]
    series = sum(of_forecaster.test_series for of_forecaster in sizes)
    work = {"resampled series": times * resamples * series, "file": float(len(sizes))}
    return _PLAIN, work, 20.0


def _of_all(stage: str, campaign: Campaign, wildcards: Wildcards) -> _Account:
    """Tables and figures: starting up is most of what they do."""
    if stage == "classification_table":
        return _classification_table(campaign)
    if stage == "figure":
        example = campaign.example
        sizes = _Sizes(campaign, example.case, example.name)
        observable = sizes.series * sizes.samples * _MIB_PER_NUMBER
        name = wildcards.get("figure", "")  # a record of what a figure took does not say it
        whole = 2 * observable if name == "observable_and_density" else 20.0
        return _DRAWING_FIELDS if name in _FIGURES_OF_FIELDS else _DRAWING, {}, whole
    return _PLAIN, {"file": float(len(campaign.forecasters))}, 10.0


class CostModel:
    """Predicts what the jobs of a campaign take: estimates, not bounds.

    For a rule that this module does not know, the guess is a few forecasts where it belongs to a
    network, the flows of control where it belongs to a case, or else little more than its start.

    Parameters
    ----------
    campaign
        The campaign that the jobs belong to.
    seconds_per
        Seconds that a unit of work takes.
    """

    def __init__(self, campaign: Campaign, seconds_per: Mapping[str, float] = SECONDS_PER) -> None:
        self._campaign = campaign
        self._seconds_per = seconds_per
        self._known: dict[tuple[str, ...], Cost] = {}

    def predicted(self, rule: str, wildcards: Wildcards) -> Cost:
        """Predict seconds on one core and memory of the script.

        Parameters
        ----------
        rule
            Name of the rule.
        wildcards
            Of the job.
        """
        names = dict(wildcards.items())
        name = parsed(names.get("forecaster") or names.get("reservoir") or "none")
        # asked for every job of a large campaign, several times: networks differ only by their seed
        others = [f"{key}={names[key]}" for key in names if key not in ("forecaster", "reservoir")]
        key = (rule, name.kind, str(name.neurons), str(name.validation), *others)
        cost = self._known.get(key)
        if cost is None:
            cost = self._known[key] = self._predict(rule, names, name)
        return cost

    def _predict(self, rule: str, wildcards: Wildcards, name: ForecasterName) -> Cost:
        case = wildcards.get("case")
        if case is None:
            (start_up, held), work, memory = _of_all(rule, self._campaign, wildcards)
        else:
            guess = _control_random if name.kind == "none" else _single_forecasts
            account = _OF_A_CASE.get(rule, guess)
            (start_up, held), work, memory = account(_Sizes(self._campaign, case, name), wildcards)
        seconds = start_up + sum(self._seconds_per[unit] * count for unit, count in work.items())
        return Cost(seconds, held + memory)

    def memory_mib(self, rule: str, wildcards: Wildcards, attempt: int) -> int:
        """Memory that a job asks for, in MiB: predicted with a margin, doubled at each retry.

        It holds Snakemake, too, which runs beside the script on a cluster.
        """
        needed = SAFETY * self.predicted(rule, wildcards).memory_mib + SNAKEMAKE_MIB
        return math.ceil(needed) << (attempt - 1)

    def runtime_minutes(self, rule: str, wildcards: Wildcards, attempt: int) -> int:
        """Time that a job asks for, in minutes: predicted with a margin, doubled at each retry."""
        minutes = SAFETY * self.predicted(rule, wildcards).seconds / 60
        return math.ceil(minutes + 0.5) << (attempt - 1)

"""Networks from a job's settings: reservoir, training series, the search for hyperparameters."""

from collections.abc import Sequence
from typing import Any

from burstcast import durations
from burstcast.data.dataset import network_input_range
from burstcast.data.parameter_factors import ParameterFactors
from burstcast.esn.reservoir import ReservoirSeed
from burstcast.esn.training import TrainingSeries
from burstcast.forecasters._names import parsed
from burstcast.systems.parameters import Parameters
from burstcast.tuning.hyperparameters import SearchSpace, SurrogateSettings
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.validation import PointValidator
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.data import observed_rows, training_states
from burstcast_workflow.jobs.scheduled import read_scheduled
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


def knowledge(settings: Settings, scheduled: Sequence[str]) -> dict[str, Any]:
    """Parameter inputs of a network that knows the parameters; empty for others."""
    if not scheduled:
        return {}
    options = settings["forecasters.aware"]
    parameters = Parameters(tuple(options["parameters"]), tuple(options["own"]))
    schedules = read_scheduled(scheduled, settings["case"]).schedules
    factors = ParameterFactors.of(
        parameters.names, schedules, options["transform"], options["parameter_degree"]
    )
    return {"factors": factors, "parameters": parameters}


def training_series(
    settings: Settings, ensemble: str, scheduled: Sequence[str] = ()
) -> TrainingSeries:
    """Training series of a case as forecasters see them: scheduled ones, if there are any."""
    whose = settings["forecasters.esn.input_range"]
    if scheduled:
        learnt = read_scheduled(scheduled, settings["case"])
        factors = knowledge(settings, scheduled)["factors"](learnt.schedules)
        scale = network_input_range(learnt.true.states, whose)
        return TrainingSeries(learnt.observed.states, scale, factors)
    states = training_states(settings, ensemble)
    observed = observed_rows(settings, ensemble, 0, states)
    return TrainingSeries(observed, network_input_range(states, whose))


def reservoir_seed(settings: Settings, identifier: str) -> ReservoirSeed:
    """Settings that the reservoir of a network, or of its scan, is made from."""
    name = parsed(identifier)
    assert name.neurons is not None
    assert name.seed is not None
    return ReservoirSeed(
        settings["random_seed"],
        name.neurons,
        name.seed,
        settings["forecasters.esn.connectivity"],
        settings["forecasters.esn.input_bias"],
    )


# -- search ----------------------------------------------------------------------------------------


def search_space(settings: Settings) -> SearchSpace:
    """Ranges of the hyperparameters."""
    return SearchSpace(
        tuple(settings["search.spectral_radius"]),
        tuple(settings["search.input_scaling"]),
        tuple(settings["forecasters.esn.leak_rate"]),
    )


def surrogate_settings(settings: Settings) -> SurrogateSettings:
    """Settings of the Gaussian process."""
    said = settings["search.surrogate"]
    bounds = {name: tuple(said[name]) for name in ("variance", "length_scale")}
    return SurrogateSettings(**{**said, **bounds})


def point_validator(
    settings: Settings, identifier: str, ensemble: str, scheduled: Sequence[str]
) -> PointValidator:
    """Validation of the search points of one reservoir, its own or a network's."""
    system = system_of(settings)
    return PointValidator(
        reservoir=reservoir_seed(settings, identifier).reservoir(system.dimension),
        training=training_series(settings, ensemble, scheduled),
        observable=system.observable,
        plan=_validation_plan(settings),
        tikhonov=settings["search.tikhonov"],
        backend=settings["forecasters.esn.backend"],
        readout=settings["forecasters.esn.readout"],
    )


def _validation_plan(settings: Settings) -> ValidationPlan:
    """Parameters of the validation strategies, in steps."""
    recycle = settings["case.recycle_validation"]
    washout_lt, interval_lt = settings["washout_lt"], settings["search.interval_lt"]
    steps = lyapunov_time(settings)
    return ValidationPlan(
        washout=durations.positive_steps(washout_lt, steps, "washout_lt"),
        interval=durations.positive_steps(interval_lt, steps, "search.interval_lt"),
        series=recycle["series"],
        intervals=recycle["intervals_per_series"],
        single_shot_lead=settings["search.single_shot_lead_steps"],
    )

"""A committee of networks: for each of them a search for its hyperparameters, then its training.

Loaded when networks are made: other kinds of forecasters need not wait for it.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.exogenous import of_series
from burstcast.base.series_lengths import series_lengths
from burstcast.forecasters._parameter_factors import factored_training
from burstcast.forecasters._reservoirs import normalised_series
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasters.esn_aware import AwareNetworkForecaster
from burstcast.networks.hyperparameters import SearchSpace
from burstcast.networks.negligible_ridge import negligible_ridge
from burstcast.networks.network_search import best, optimiser_seed, search
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.scan import Evaluation, scan
from burstcast.networks.training import TrainingSeries
from burstcast.networks.validation import PointValidator
from burstcast.networks.validation_strategies.base import ValidationPlan
from burstcast.networks.validation_strategies.registry import make_strategy, scanned_with
from burstcast.statistics.warning_signs import optimum_on_edge

# Reported results of the search for each network.
_REPORTED = ("spectral_radius", "input_scaling", "leak_rate", "tikhonov", "objective")
# Validation intervals in more series take longer, and the paper has no more.
_MOST_VALIDATION_SERIES = 4


def trained_committee(
    network: NetworkForecaster,
    training: TrainingSeries,
    case: ForecastingCase,
    settings: Mapping[str, Any],
    washout: int,
    interval: int,
    stage: Callable[[str], None] = lambda _: None,
) -> tuple[list[Forecaster], list[dict[str, Any]]]:
    """Networks of a committee, and the hyperparameters that the searches chose for each of them.

    The first ``searches`` networks have a search of their own; the others take the hyperparameters
    of these in turn.

    ``network``: The unfitted network. ``training``: Of `training_of`. ``settings``:
    Parameters of an `EventForecaster`. ``stage``: Called with a text at each network.
    """
    if settings["members"] < 1:
        raise ValueError(f"members must be 1 at least, not {settings['members']}")
    strategy = make_strategy(settings["validation"])
    alongside = [make_strategy(name) for name in scanned_with(strategy.name)]
    alongside = [other for other in alongside if other.name != strategy.name]
    dimension = training.dimension
    plan = _plan(training, settings, washout, interval)
    ranges = settings["spectral_radius"], settings["input_scaling"], network.leak_rate
    bounds: Any = [tuple(map(float, bound)) for bound in ranges]
    space = SearchSpace(*bounds)
    drawn = network.connectivity, network.input_bias
    members: list[Forecaster] = []
    optima: list[Evaluation] = []
    for number in range(settings["members"]):
        seed = ReservoirSeed(settings["random_seed"], settings["neurons"], number, *drawn)
        reservoir, tikhonov = seed.reservoir(dimension), list(settings["tikhonov"])
        validator = PointValidator(
            reservoir,
            training,
            case.system.observable,
            plan,
            tikhonov,
            backend=network.backend,
            readout=network.readout,
        )
        stage(f"network {number + 1} of {settings['members']}")
        if number < settings["searches"]:
            scanning = replace(validator, alongside=alongside)
            scanned = scan(scanning, space, [strategy], settings["grid"])
            optimiser = optimiser_seed(seed, settings["case"], strategy.name)
            points = search(
                validator, space, strategy, scanned, settings["bayesian_points"], optimiser
            )
            optima.append(best(points))
        chosen = optima[number % len(optima)]
        trained = network.trained(
            validator.dynamics(chosen.point),
            seed,
            training,
            washout=washout,
            tikhonov=chosen.validation.tikhonov,
            steps_per_lyapunov_time=case.steps_per_lyapunov_time,
        )
        members.append(trained)
    records = [optima[number % len(optima)].record() for number in range(len(members))]
    return members, [
        {name: record[name] for name in _REPORTED if name in record} for record in records
    ]


def _plan(
    training: TrainingSeries, settings: Mapping[str, Any], washout: int, interval: int
) -> ValidationPlan:
    """Validation intervals: of series of unequal lengths, the first are the longest."""
    lengths = series_lengths(training.observed)
    intervals, most = settings["intervals_per_series"], training.series
    if lengths is not None:
        fitting = np.maximum(0, (lengths - washout) // interval)
        most = max(1, int(np.count_nonzero(fitting >= (intervals or 1))))
        if (settings["validation_series"] or 1) > most:
            raise ValueError(
                f"validation_series is {settings['validation_series']}, but only {most} series "
                f"have a washout of {washout} samples and validation intervals of {interval}"
            )
    validated = settings["validation_series"] or min(_MOST_VALIDATION_SERIES, most)
    if lengths is not None and intervals is None:
        intervals = max(1, int(fitting[:validated].min()))
    return ValidationPlan(washout, interval, validated, intervals)


def training_of(
    states: FloatArray, observed: FloatArray, case: ForecastingCase, network: NetworkForecaster
) -> TrainingSeries:
    """Training series of a network.

    ``observed``: Series with their inputs, for networks that know the parameters.
    """
    training = normalised_series(observed, states, network.input_range, network.input_offset)
    if not isinstance(network, AwareNetworkForecaster):
        return training
    _, inputs = of_series(training.observed, states.shape[2])
    return factored_training(training.part(in_turns(inputs)), case.required_parameters, network)


def in_turns(schedules: FloatArray) -> IntArray:
    """Order of series in which those under different parameters take turns.

    Validation intervals lie in the first series, which are then of all parameters.

    Examples
    --------
    >>> in_turns(np.repeat([[[4.0, 6.0]], [[4.0, 6.0]], [[6.0, 4.0]]], 5, axis=1))
    array([0, 2, 1])
    """
    _, group = np.unique(schedules.mean(axis=1), axis=0, return_inverse=True)
    turn = [
        int((group[:number] == parameters).sum()) for number, parameters in enumerate(group.ravel())
    ]
    return np.argsort(turn, kind="stable")


def search_edges(
    hyperparameters: Sequence[Mapping[str, Any]], settings: Mapping[str, Any], samples: int
) -> Iterator[str]:
    """Sentences about hyperparameters that most networks have on the edge of their search."""
    least = negligible_ridge(settings["neurons"], samples)
    of_searches = hyperparameters[: settings["searches"]]
    for name in ("spectral_radius", "input_scaling", "tikhonov"):
        values, searched = [chosen[name] for chosen in of_searches], settings[name]
        lost = least if name == "tikhonov" else 0.0
        for finding in optimum_on_edge(name, values, min(searched), max(searched), lost):
            yield f"the search ended on its edge, {finding}: search beyond it ({name})"

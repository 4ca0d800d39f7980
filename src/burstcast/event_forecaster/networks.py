"""A committee of networks: for each of them a search for its hyperparameters, then its training.

Loaded when networks are made: other kinds of forecasters need not wait for it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from burstcast.arrays import FloatArray, IntArray
from burstcast.data.dataset import network_input_range
from burstcast.esn.reservoir import ReservoirSeed
from burstcast.esn.training import TrainingSeries
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasters.esn_aware import factored_training
from burstcast.tuning.hyperparameters import SearchSpace
from burstcast.tuning.network_search import best, optimiser_seed, search
from burstcast.tuning.scan import scan
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.strategies.registry import make_strategy, scanned_with
from burstcast.tuning.validation import PointValidator

# Reported results of the search for each network.
_FOUND = ("spectral_radius", "input_scaling", "leak_rate", "tikhonov", "objective")
# Validation intervals in more series take longer, and the paper has no more.
_MOST_VALIDATION_SERIES = 4


def networks(
    kind: type[Forecaster],
    states: FloatArray,
    observed: FloatArray,
    schedules: FloatArray | None,
    case: ForecastingCase,
    parameters: Mapping[str, Any],
    washout: int,
    interval: int,
) -> tuple[list[Forecaster], list[dict[str, Any]]]:
    """Search and train all networks of a committee.

    ``states``, ``observed``: Training series, and what is observed of them, ``(series, time,
    component)``. ``schedules``: Parameters in force in the training series, ``(series, time - 1,
    parameters)``; None for networks that do not know them. ``parameters``: Parameters of
    `burstcast.EventForecaster`, by name. ``washout``, ``interval``: Steps of the washout, and of a
    validation interval. Returns the networks, and the outcome of the search for each network.
    """
    members, neurons, root = (parameters[key] for key in ("members", "neurons", "random_seed"))
    if members < 1:
        raise ValueError(f"members must be 1 at least, not {members}")
    strategy = make_strategy(parameters["validation"])
    together = [make_strategy(name) for name in scanned_with(strategy.name)]
    training, knowledge = _training(states, observed, schedules, case)
    assert issubclass(kind, NetworkForecaster)
    series, _, dimension = training.observed.shape
    plan = ValidationPlan(
        washout=washout,
        interval=interval,
        series=parameters["validation_series"] or min(_MOST_VALIDATION_SERIES, series),
        intervals=parameters["intervals_per_series"],
    )
    options = case.options
    space = SearchSpace(
        _bounds(parameters["spectral_radius"]),
        _bounds(parameters["input_scaling"]),
        tuple(float(rate) for rate in options["leak_rate"]),
    )
    made: list[Forecaster] = []
    found = []
    for number in range(members):
        seed = ReservoirSeed(
            root, neurons, number, float(options["connectivity"]), float(options["input_bias"])
        )
        validator = PointValidator(
            seed.reservoir(dimension),
            training,
            case.system.observable,
            plan,
            list(parameters["tikhonov"]),
            options["backend"],
            options["readout"],
        )
        scanned = scan(validator, space, together, parameters["grid"])
        optimiser = optimiser_seed(seed, parameters["case"], strategy.name)
        points = parameters["bayesian_points"]
        chosen = best(search(validator, space, strategy, scanned, points, optimiser))
        made.append(
            kind.trained(
                validator.dynamics(chosen.point),
                seed,
                training,
                washout=washout,
                tikhonov=chosen.validation.tikhonov,
                divergence_bound=options["divergence_bound"],
                **knowledge,
            )
        )
        record = chosen.record()
        found.append({name: record[name] for name in _FOUND if name in record})
    return made, found


def _training(
    states: FloatArray,
    observed: FloatArray,
    schedules: FloatArray | None,
    case: ForecastingCase,
) -> tuple[TrainingSeries, dict[str, Any]]:
    """Training series, and what networks that know the parameters are given beside them."""
    scale = network_input_range(states, case.options["input_range"])
    if schedules is None:
        return TrainingSeries(observed, scale), {}
    turns = in_turns(schedules)
    training, factors = factored_training(observed[turns], scale, schedules[turns], case)
    return training, {"factors": factors, "parameters": case.parameters}


def in_turns(schedules: FloatArray) -> IntArray:
    """Order of series in which those under different parameters take turns.

    Validation intervals lie in the first series, which are then of all parameters.

    Examples
    --------
    >>> in_turns(np.repeat([400.0, 400.0, 600.0], 5).reshape(3, 5, 1))
    array([0, 2, 1])
    """
    _, group = np.unique(schedules.mean(axis=1), axis=0, return_inverse=True)
    turn = [int((group[:number] == one).sum()) for number, one in enumerate(group.ravel())]
    return np.argsort(turn, kind="stable")


def _bounds(given: Sequence[float]) -> tuple[float, float]:
    low, high = given
    return float(low), float(high)

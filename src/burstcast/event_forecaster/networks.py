"""A committee of networks: for each of them a search for its hyperparameters, then its training.

Loaded when networks are made: other kinds of forecasters need not wait for it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.esn.reservoir import ReservoirSeed
from burstcast.esn.training import TrainingSeries
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.tuning.hyperparameters import SearchSpace
from burstcast.tuning.network_search import NetworkSearch, optimiser_seed, trained
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.strategies.registry import make_strategy
from burstcast.tuning.validation import PointValidator

# What is validated on one open loop in the workflow, too: the sums then have the same bits.
_VALIDATED_TOGETHER = ("RV", "SSV")
# Validation intervals in more series take longer, and the paper has no more.
_MOST_VALIDATION_SERIES = 4


def networks(
    training: TrainingSeries,
    case: ForecastingCase,
    parameters: Mapping[str, Any],
    washout: int,
    interval: int,
) -> tuple[list[Forecaster], list[dict[str, float]]]:
    """Make all networks of a committee.

    Parameters
    ----------
    training
        The training series.
    case
        What is known beside them.
    parameters
        Of `burstcast.EventForecaster`, by name.
    washout, interval
        Steps of the washout, and of a validation interval.

    Returns
    -------
    The networks, and what the search has found for each of them.

    Raises
    ------
    ValueError
        If a parameter is out of bounds.
    """
    members, neurons, root = (parameters[key] for key in ("members", "neurons", "random_seed"))
    if members < 1:
        raise ValueError(f"members must be 1 at least, not {members}")
    strategy = make_strategy(parameters["validation"])
    shared = strategy.name in _VALIDATED_TOGETHER
    together = [make_strategy(name) for name in _VALIDATED_TOGETHER] if shared else [strategy]
    series, length, dimension = training.observed.shape
    plan = ValidationPlan(
        washout=washout,
        interval=interval,
        series=parameters["validation_series"] or min(_MOST_VALIDATION_SERIES, series),
        intervals=parameters["intervals_per_series"] or max(1, (length - washout) // interval),
    )
    space = SearchSpace(
        _bounds(parameters["spectral_radius"]), _bounds(parameters["input_scaling"])
    )
    search = NetworkSearch(space, parameters["grid"], parameters["bayesian_points"])
    options = case.options
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
        )
        optimiser = optimiser_seed(root, parameters["case"], neurons, strategy.name, number)
        chosen = search.best(validator, strategy, together, optimiser)
        network = trained(validator, chosen, washout)
        made.append(NetworkForecaster(network, seed, options["divergence_bound"]))
        found.append(vars(chosen))
    return made, found


def _bounds(given: Sequence[float]) -> tuple[float, float]:
    low, high = given
    return float(low), float(high)

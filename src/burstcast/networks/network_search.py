"""The search for a network's hyperparameters, from the scan of a grid on."""

from collections.abc import Sequence

from burstcast.base import random_streams
from burstcast.networks.hyperparameters import (
    DEFAULT_SURROGATE,
    HyperparameterPoint,
    SearchSpace,
    SurrogateSettings,
)
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.scan import Evaluation
from burstcast.networks.validation import PointValidator
from burstcast.networks.validation_strategies.base import ValidationStrategy


def search(
    validator: PointValidator,
    space: SearchSpace,
    strategy: ValidationStrategy,
    scanned: Sequence[Evaluation],
    points: int,
    seed: int,
    surrogate: SurrogateSettings = DEFAULT_SURROGATE,
) -> list[Evaluation]:
    """Evaluate more points, where a Gaussian process expects the largest improvement.

    They have the leak rate of the best point of the grid. ``scanned``: Evaluations of the grid
    (`burstcast.networks.scan`); those by other strategies are left out.
    """
    trace = [
        evaluation for evaluation in scanned if evaluation.validation.strategy == strategy.name
    ]
    leak_rate = best(trace).point.leak_rate
    on_grid: dict[HyperparameterPoint, float] = {}
    for evaluation in trace:
        point = evaluation.point
        if point.leak_rate == leak_rate:
            on_grid[point] = min(evaluation.objective, on_grid.get(point, float("inf")))

    def objective(point: HyperparameterPoint) -> float:
        number = trace[-1].number + 1
        validations = validator(point, [strategy])
        evaluated = [Evaluation(number, "bayesian", point, result) for result in validations]
        trace.extend(evaluated)
        return best(evaluated).objective

    if points:
        # loaded here only: it takes longer than all the rest of the library
        from burstcast.networks.bayesian_search import bayesian_search

        bayesian_search(space, list(on_grid.items()), points, objective, seed, surrogate)
    return trace


def best(evaluations: Sequence[Evaluation]) -> Evaluation:
    """Evaluation with the smallest objective; the first of equals."""
    return min(evaluations, key=lambda evaluation: evaluation.objective)


def optimiser_seed(reservoir: ReservoirSeed, case: str, strategy: str) -> int:
    """Seed of the optimiser of one network: of its reservoir, case and validation strategy."""
    names = ("optimiser", case, reservoir.neurons, strategy, reservoir.seed)
    sequence = random_streams.seed_sequence(reservoir.random_seed, *names)
    return int(sequence.generate_state(1)[0] % 2**31)

"""A network from its training series: the search for its hyperparameters, then its training.

The workflow does the same in three jobs (scan, search, train), where networks share what they can.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from burstcast import random_streams
from burstcast.esn import training
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.tuning.hyperparameters import HyperparameterPoint, SearchSpace
from burstcast.tuning.strategies.base import ValidationStrategy
from burstcast.tuning.validation import PointValidator, Validation, best


@dataclass(frozen=True)
class Hyperparameters:
    """What a search has found.

    Attributes
    ----------
    spectral_radius, input_scaling, tikhonov
        The best ones.
    objective
        What the strategy makes of them: mean log10 of the mean square error of the observable.
    """

    spectral_radius: float
    input_scaling: float
    tikhonov: float
    objective: float


@dataclass(frozen=True)
class NetworkSearch:
    """A grid in the space of the hyperparameters, and points of Bayesian optimisation after it.

    Attributes
    ----------
    space
        Bounds.
    grid
        Points of the grid in each direction.
    bayesian_points
        Points after it.
    """

    space: SearchSpace
    grid: int
    bayesian_points: int

    def best(
        self,
        validator: PointValidator,
        strategy: ValidationStrategy,
        together: Sequence[ValidationStrategy],
        seed: int,
    ) -> Hyperparameters:
        """Search the hyperparameters of one network.

        Parameters
        ----------
        validator
            Of its reservoir.
        strategy
            Whose objective is minimised.
        together
            Strategies that are validated in one go on the grid, ``strategy`` among them. Others
            change where sums over the training series are cut, and with it their rounding only.
        seed
            Of the optimiser (`optimiser_seed`).
        """
        tried: list[tuple[HyperparameterPoint, Validation]] = []
        on_grid: list[tuple[HyperparameterPoint, float]] = []

        def objective(
            point: HyperparameterPoint, strategies: Sequence[ValidationStrategy]
        ) -> float:
            validations = validator(point, strategies)
            tried.extend((point, one) for one in validations if one.strategy == strategy.name)
            return best(validations, strategy.name).objective

        for point in self.space.grid(self.grid):
            on_grid.append((point, objective(point, together)))
        if self.bayesian_points:
            # loaded here only: it takes longer than all the rest of the library
            from burstcast.tuning.search import bayesian_search

            bayesian_search(
                self.space,
                on_grid,
                self.bayesian_points,
                lambda point: objective(point, [strategy]),
                seed,
            )
        point, chosen = min(tried, key=lambda one: one[1].objective)
        return Hyperparameters(
            point.spectral_radius, point.input_scaling, chosen.tikhonov, chosen.objective
        )


def optimiser_seed(random_seed: int, case: str, neurons: int, strategy: str, seed: int) -> int:
    """Seed of the optimiser of one network, as the workflow has it."""
    names = ("optimiser", case, neurons, strategy, seed)
    sequence = random_streams.seed_sequence(random_seed, *names)
    return int(sequence.generate_state(1)[0] % 2**31)


def trained(validator: PointValidator, found: Hyperparameters, washout: int) -> EchoStateNetwork:
    """Network trained on all of the training series with the hyperparameters that were found.

    Parameters
    ----------
    validator
        With reservoir, training series and backend.
    found
        The hyperparameters.
    washout
        Steps at the beginning of each series that training leaves out.
    """
    dynamics = Dynamics(
        validator.reservoir, found.spectral_radius, found.input_scaling, validator.backend
    )
    readout = training.train(dynamics, validator.training, washout=washout, tikhonov=found.tikhonov)
    return EchoStateNetwork(dynamics, readout, validator.training.input_range)

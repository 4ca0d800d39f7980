"""Search for the spectral radius and the input scaling: a grid, then Bayesian optimisation.

Source: section "Validation" of the paper: a 4 x 4 grid in logarithmic scale, then nine points
chosen by gp_hedge (Hoffman et al., 2011). The Tikhonov parameter is the best of its own grid at
each point.
"""

from collections.abc import Callable, Sequence

import numpy as np
from skopt import Optimizer
from skopt.learning import GaussianProcessRegressor
from skopt.learning.gaussian_process.kernels import ConstantKernel, Matern
from skopt.space import Real

from burstcast.networks.hyperparameters import (
    DEFAULT_SURROGATE,
    HyperparameterPoint,
    SearchSpace,
    SurrogateSettings,
)


def bayesian_search(
    space: SearchSpace,
    evaluated: Sequence[tuple[HyperparameterPoint, float]],
    points: int,
    evaluate: Callable[[HyperparameterPoint], float],
    seed: int,
    surrogate: SurrogateSettings = DEFAULT_SURROGATE,
) -> None:
    """Evaluate ``points`` more hyperparameters, chosen by a Gaussian process at one leak rate.

    The process has a constant times an anisotropic Matern 5/2 kernel and normalised targets;
    gp_hedge chooses among expected improvement, lower confidence bound and probability of
    improvement. ``evaluated``: Points of the grid with their objectives. ``evaluate``: Objective at
    a point; it also records the evaluation. ``seed``: Of the optimiser, unless the surrogate has
    one.
    """
    seed = seed if surrogate.random_state is None else surrogate.random_state
    kernel = ConstantKernel(float(np.clip(1.0, *surrogate.variance)), surrogate.variance) * Matern(
        length_scale=[surrogate.first_length_scale] * 2,
        length_scale_bounds=[surrogate.length_scale] * 2,
        nu=2.5,
    )
    process = GaussianProcessRegressor(
        kernel=kernel, normalize_y=True, n_restarts_optimizer=3, noise=1e-10, random_state=seed
    )
    optimizer = Optimizer(
        [Real(*np.log10(space.spectral_radius)), Real(*np.log10(space.input_scaling))],
        base_estimator=process,
        n_initial_points=0,
        acq_func="gp_hedge",
        random_state=seed,
    )
    optimizer.tell(
        [space.logarithm(point) for point, _ in evaluated],
        [objective for _, objective in evaluated],
        fit=points > 0,
    )
    for remaining in reversed(range(points)):
        logarithm = optimizer.ask()
        objective = evaluate(space.point(logarithm, evaluated[0][0].leak_rate))
        # the last fit would propose a point that is not evaluated
        optimizer.tell(logarithm, objective, fit=remaining > 0)

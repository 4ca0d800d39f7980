"""A gated recurrent network that is trained through its own forecasts, as a forecaster.

Sources: Cho et al., EMNLP 2014 (the unit, GRU); Vlachas et al., Neural Networks 126 (2020) 191, for
recurrent networks of chaotic flows that are trained by backpropagation through time. JAX
differentiates and trains; forecasts need NumPy alone. Training is by stages: first one step ahead
along observations, then in closed loop over more and more steps. Of all weights that training goes
through, those are kept with the best closed loops of some training series that are held out.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base import random_streams
from burstcast.forecasters.base import Forecaster, fitted

WEIGHTS = ("input_weights", "recurrent", "biases", "output", "output_bias")
"""Fitted arrays that training changes."""
_SKIPPED = 10
"""First outputs along observations, which do not count in the loss: the units wake up."""


@dataclass(frozen=True)
class GatedNetwork(Forecaster):
    """Next sample = last sample + output weights . state of a gated recurrent unit."""

    neurons: int = 100
    updates: tuple[float, ...] = (600, 400, 1500, 1200)  #: of each stage
    closed: tuple[float, ...] = (0, 10, 30, 60)  #: steps in closed loop by stage; 0: one step ahead
    rates: tuple[float, ...] = (3e-3, 2e-3, 1e-3, 1e-3)  #: learning rates, which fall to a tenth
    #: square error, in variances, above which its logarithm is the loss, so that forecasts that
    #: are lost do not dominate; 0: the loss is the square error
    robust: float = 1e-3
    batch: int = 64
    washout: int = 30  #: samples that precede a closed loop
    held_out: int = 2  #: training series that choose the weights
    reach_lt: float = 2.0  #: length of the closed loops that choose, in Lyapunov times
    looks: int = 100  #: updates from one look at the series held out to the next
    bound: float = 6.0  #: of forecasts, in standard deviations
    seed: int = 0

    mean: np.ndarray = fitted()
    scale: np.ndarray = fitted()
    input_weights: np.ndarray = fitted()  #: ``(dimension, 3 neurons)``: keep, reset, new
    recurrent: np.ndarray = fitted()  #: ``(neurons, 3 neurons)``
    biases: np.ndarray = fitted()  #: ``(3 neurons,)``
    output: np.ndarray = fitted()  #: ``(neurons, dimension)``
    output_bias: np.ndarray = fitted()  #: ``(dimension,)``
    #: mean log10 square error, in variances, of the closed loops that chose the weights
    held_out_error: float = fitted()

    def __post_init__(self):
        if not len(self.updates) == len(self.closed) == len(self.rates):
            raise ValueError(
                "updates, closed and rates have an entry for each stage: their lengths are "
                f"{len(self.updates)}, {len(self.closed)} and {len(self.rates)}"
            )

    def fit(self, training, case):
        """Train stage by stage."""
        mean, scale = training.mean(axis=(0, 1)), training.std(axis=(0, 1))
        series = ((training - mean) / scale).astype(np.float32)
        reach = int(self.reach_lt * case.steps_per_lyapunov_time)
        weights, error = trained(self, series, reach)
        arrays = {name: np.asarray(weights[name], dtype=np.float64) for name in WEIGHTS}
        return self.with_fitted(mean=mean, scale=scale, held_out_error=error, **arrays)

    def start(self, washout):
        """Units after all samples but the last, and the last sample, ``(neurons + dim, batch)``."""
        samples = (washout - self.mean[:, np.newaxis]) / self.scale[:, np.newaxis]
        units = np.zeros((self.neurons, washout.shape[2]))
        for sample in samples[:-1]:
            units = self._gated(units, sample)
        return np.concatenate([units, samples[-1]])

    def advance(self, memory, steps):
        """Closed loop."""
        units, sample = memory[: self.neurons], memory[self.neurons :]
        outputs = np.empty((steps, *sample.shape))
        for step in range(steps):
            units = self._gated(units, sample)
            sample = sample + self.output.T @ units + self.output_bias[:, np.newaxis]
            sample = np.clip(sample, -self.bound, self.bound)
            outputs[step] = sample * self.scale[:, np.newaxis] + self.mean[:, np.newaxis]
        return outputs, np.concatenate([units, sample])

    def _gated(self, units, sample):
        """Units ``(neurons, batch)`` after one more sample."""
        driven = self.input_weights.T @ sample + self.biases[:, np.newaxis]
        keep, reset, new = np.split(driven, 3)
        from_keep, from_reset, from_new = np.split(self.recurrent.T @ units, 3)
        keep = 1 / (1 + np.exp(-keep - from_keep))
        reset = 1 / (1 + np.exp(-reset - from_reset))
        return (1 - keep) * np.tanh(new + reset * from_new) + keep * units


def first_weights(neurons, dimension, generator):
    """Weights before training, in single precision."""

    def normal(scale, *shape):
        return (scale * generator.standard_normal(shape)).astype(np.float32)

    return {
        "input_weights": normal(dimension**-0.5, dimension, 3 * neurons),
        "recurrent": normal(neurons**-0.5, neurons, 3 * neurons),
        "biases": np.zeros(3 * neurons, np.float32),
        "output": normal(0.01 * neurons**-0.5, neurons, dimension),
        "output_bias": np.zeros(dimension, np.float32),
    }


def trained(options, series, reach):
    """Train on series ``(series, time, dimension)``: the weights kept, and their held-out error.

    ``reach``: Steps of the closed loops of the series held out.
    """
    try:
        import jax
        import jax.numpy as jnp
    except ImportError as error:
        raise ImportError(
            "training a gated network takes JAX: pip install -r examples/neural/requirements.lock"
        ) from error

    held = min(options.held_out, len(series) - 1)
    if held < 1:
        raise ValueError("a gated network takes two training series at least: one is held out")
    learnt, left = series[:-held], series[-held:]
    washout, bound = options.washout, options.bound
    span = washout + max(reach, *map(int, options.closed))
    if series.shape[1] <= span:
        raise ValueError(f"closed loops take series of more than {span} samples")

    def gated(weights, units, sample):
        driven = sample @ weights["input_weights"] + weights["biases"]
        keep, reset, new = jnp.split(driven, 3, -1)
        from_keep, from_reset, from_new = jnp.split(units @ weights["recurrent"], 3, -1)
        keep, reset = jax.nn.sigmoid(keep + from_keep), jax.nn.sigmoid(reset + from_reset)
        units = (1 - keep) * jnp.tanh(new + reset * from_new) + keep * units
        return units, sample + units @ weights["output"] + weights["output_bias"]

    def follow(weights, samples):
        """Units after samples ``(time, batch, dimension)``, and the output after each."""
        units = jnp.zeros((samples.shape[1], weights["recurrent"].shape[0]))
        return jax.lax.scan(lambda units, sample: gated(weights, units, sample), units, samples)

    def closed_loop(weights, samples, steps):
        """Forecast ``(steps, batch, dimension)`` after a washout."""
        units, _ = follow(weights, samples[: washout - 1])

        def step(carry, _):
            units, sample = gated(weights, *carry)
            sample = jnp.clip(sample, -bound, bound)
            return (units, sample), sample

        return jax.lax.scan(step, (units, samples[washout - 1]), None, length=steps)[1]

    def loss(weights, samples, steps):
        if steps == 0:
            outputs = follow(weights, samples)[1]
            return jnp.mean((outputs[_SKIPPED:-1] - samples[_SKIPPED + 1 :]) ** 2)
        ahead = closed_loop(weights, samples, steps)
        error = jnp.mean((ahead - samples[washout : washout + steps]) ** 2, axis=2)
        if not options.robust:
            return jnp.mean(error)
        return jnp.mean(jnp.log1p(error / options.robust))

    @jax.jit
    def held_out_error(weights, samples):
        ahead = closed_loop(weights, samples, reach)
        error = jnp.mean((ahead - samples[washout:]) ** 2, axis=(0, 2))
        return jnp.mean(jnp.log10(error))

    def update(weights, first, second, count, rate, samples, steps):
        """Adam's step (Kingma & Ba 2015), of a gradient whose norm is 1 at most."""
        gradient = jax.grad(loss)(weights, samples, steps)
        norm = jnp.sqrt(sum(jnp.sum(part**2) for part in jax.tree.leaves(gradient)))
        gradient = jax.tree.map(lambda part: part / jnp.maximum(norm, 1.0), gradient)
        first = jax.tree.map(lambda old, new: 0.9 * old + 0.1 * new, first, gradient)
        second = jax.tree.map(lambda old, new: 0.999 * old + 0.001 * new**2, second, gradient)
        mean, variance = 1 - 0.9**count, 1 - 0.999**count
        weights = jax.tree.map(
            lambda old, m, v: old - rate * (m / mean) / (jnp.sqrt(v / variance) + 1e-8),
            weights,
            first,
            second,
        )
        return weights, first, second

    update = jax.jit(update, static_argnums=6)
    generator = random_streams.stream(options.seed, "gated network", options.neurons)
    starts = np.arange(0, left.shape[1] - washout - reach, washout)
    checked = np.concatenate([left[:, at : at + washout + reach] for at in starts])
    checked = np.ascontiguousarray(checked.transpose(1, 0, 2))
    weights = first_weights(options.neurons, series.shape[2], generator)
    first = second = {name: np.zeros_like(array) for name, array in weights.items()}
    best, lowest, count = weights, np.inf, 0
    for steps, updates, rate in zip(options.closed, options.updates, options.rates, strict=True):
        length = washout + (int(steps) or washout)
        for done in range(int(updates)):
            rows = generator.integers(0, len(learnt), options.batch)
            at = generator.integers(0, series.shape[1] - length, options.batch)
            samples = learnt[rows, at + np.arange(length)[:, np.newaxis]]
            count += 1
            falling = rate * 0.1 ** (done / updates)
            weights, first, second = update(
                weights, first, second, float(count), falling, samples, int(steps)
            )
            if (done + 1) % options.looks == 0 or done + 1 == int(updates):
                error = float(held_out_error(weights, checked))
                if error < lowest:
                    best, lowest = weights, error
    return best, lowest

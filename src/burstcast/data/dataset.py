"""Ensembles of time series: generation, observation noise and normalisation.

Source: section "Generation of the dataset" of the paper.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.series_lengths import samples_of, series_lengths
from burstcast.data.laminarisation import first_laminar_step, is_laminar
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate_observed

SERIES_PER_BATCH = 1000
"""Series integrated at a time: bounds the memory, changes no result."""


@dataclass(frozen=True)
class KeptSeries:
    """Series of one batch that did not laminarise."""

    index: IntArray  #: number of each kept series among all that were generated, ``(kept,)``
    states: FloatArray  #: sampled states, ``(kept, time, component)``
    #: sampling steps until each series of the batch, discarded series included, has laminarised;
    #: all steps of a kept one. ``(batch,)``.
    lifetimes: IntArray


def initial_states(
    initial_state: FloatArray,
    perturbed_component: int,
    perturbation: float,
    series: int,
    generator: np.random.Generator,
) -> FloatArray:
    """Initial conditions of an ensemble: one component is raised by a random amount.

    ``initial_state``: State that all series share, ``(dimension,)``. ``perturbation``: Largest
    perturbation; each series draws its own uniformly from [0, perturbation]. ``generator``: Source
    of the random numbers; series i takes the i-th number, so that a longer ensemble begins with the
    shorter one. Returns initial states, ``(dimension, series)``.
    """
    states = np.repeat(np.asarray(initial_state, dtype=np.float64)[:, np.newaxis], series, axis=1)
    states[perturbed_component] += perturbation * generator.random(series)
    return states


def generate_ensemble(
    system: DynamicalSystem,
    states: FloatArray,
    *,
    time_step: float,
    sampling_stride: int,
    transient_steps: int,
    kept_steps: int,
    laminarisation_threshold: float | None,
) -> Iterator[KeptSeries]:
    """Integrate an ensemble and yield the series that do not laminarise, batch by batch.

    ``states``: Initial states, ``(dimension, series)``. ``time_step``: Time step of the Runge-Kutta
    scheme, in time units. ``transient_steps``, ``kept_steps``: Integration steps that are dropped,
    and kept after them. ``laminarisation_threshold``: A series whose observable exceeds it at any
    kept integration step is discarded; None keeps every series.
    """
    for start in range(0, states.shape[1], SERIES_PER_BATCH):
        batch = states[:, start : start + SERIES_PER_BATCH]
        trajectories = integrate_observed(
            system,
            batch,
            time_step,
            kept_steps,
            stride=sampling_stride,
            transient_steps=transient_steps,
        )
        if undefined := int(np.isnan(trajectories.largest_observable).sum()):
            raise FloatingPointError(f"the observable of {undefined} series is not a number")
        kept = ~is_laminar(trajectories.largest_observable, laminarisation_threshold)
        observable = system.observable(trajectories.states.transpose(1, 0, 2))
        first = first_laminar_step(observable, laminarisation_threshold, axis=0)
        # a series that exceeds the threshold between two samples only is given all steps, too
        lifetimes = np.where(first >= 0, first, len(trajectories.states) - 1)
        yield KeptSeries(
            index=start + np.flatnonzero(kept),
            states=np.ascontiguousarray(trajectories.states[:, :, kept].transpose(2, 0, 1)),
            lifetimes=lifetimes,
        )


@dataclass(frozen=True)
class Scales:
    """Size of each component over the training series."""

    standard_deviation: FloatArray  #: sigma_u, ``(dimension,)``: the unit of the observation noise
    #: largest minus smallest value, ``(dimension,)``: what the inputs of a network are divided by
    range: FloatArray


def component_scales(training_states: FloatArray) -> Scales:
    """Scales of the training series ``(series, time, component)``.

    A constant component, by whose range inputs cannot be divided, is a ValueError.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.data.dataset import component_scales
    >>> component_scales(np.array([[[0.0, 1.0], [2.0, 5.0]]])).range.tolist()
    [2.0, 4.0]
    """
    flat = samples_of(training_states)
    component_range = flat.max(axis=0) - flat.min(axis=0)
    if not (component_range > 0).all():
        constant = int(np.argmin(component_range > 0))
        raise ValueError(f"component {constant} is constant over the training series")
    return Scales(standard_deviation=flat.std(axis=0), range=component_range)


def network_input_range(
    training_states: FloatArray, series: Literal["all", "first"] = "all"
) -> FloatArray:
    """Range by which the inputs of a network are divided, ``(dimension,)``.

    ``training_states``: True states of the training series, ``(series, time, dimension)``.
    ``series``: Series that the range is taken over: all training series, or the first one alone, as
    in the programs of the paper's authors. The bias of the inputs is equal for both, so that it is
    smaller beside the inputs where their range is smaller.
    """
    return component_scales(training_states[:1] if series == "first" else training_states).range


def network_input_offset(
    training_states: FloatArray, offset: Literal["mean", "none"]
) -> FloatArray | None:
    """What is subtracted from the inputs and the targets of a network, ``(dimension,)``, or None.

    ``training_states``: As of `network_input_range`. ``offset``: "mean", so that forecasts do not
    depend on the zero of a unit, or "none", as in the paper.
    """
    if offset == "none":
        return None
    unequal = series_lengths(training_states) is not None
    mean: FloatArray = (
        samples_of(training_states).mean(axis=0) if unequal else training_states.mean(axis=(0, 1))
    )
    return mean


def add_observation_noise(
    states: FloatArray,
    first_series: int,
    noise: float,
    scales: Scales,
    root_seed: int,
    *stream_names: str | int,
) -> FloatArray:
    """Series ``(series, time, component)`` with Gaussian noise, as an observer sees them.

    ``noise``: Standard deviation, in standard deviations of each component (``scales``). The noise
    of a series depends on its number alone, which counts from ``first_series`` and is appended to
    the name of the random stream.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.data.dataset import component_scales, add_observation_noise
    >>> states = np.random.default_rng(0).normal(size=(4, 500, 3))
    >>> observed = add_observation_noise(states, 0, 0.1, component_scales(states), 0, "noise")
    >>> round(float((observed - states).std()), 2)
    0.1
    """
    observed = np.empty_like(states)
    for row, series in enumerate(states):
        generator = random_streams.stream(root_seed, *stream_names, first_series + row)
        deviation = generator.standard_normal(series.shape)
        observed[row] = series + noise * scales.standard_deviation * deviation
    return observed


def observed_series(
    states: FloatArray, first_series: int, noise: float, scales: Scales, root_seed: int, case: str
) -> FloatArray:
    """Series of a case as all forecasters see them (see `add_observation_noise`).

    ``case``: Name of the case; the random stream is called after it.
    """
    return add_observation_noise(states, first_series, noise, scales, root_seed, "noise", case)

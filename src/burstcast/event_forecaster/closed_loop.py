"""Control of a system by an event forecaster: the closed loop of campaigns, for a user's system."""

import contextlib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.base.threads import single_threaded
from burstcast.control.actuation import ActuationValues, actuated_system, reversed_actuation
from burstcast.control.controllers import controlling_policy, votes
from burstcast.control.experiment import ControlExperiment, noise_of_flows
from burstcast.control.loop import ControlledFlows, simulate
from burstcast.control.policy import at_random
from burstcast.control.records import (
    COSTS,
    FlowSample,
    Interval,
    Span,
    flow_intervals,
    record_flows,
    score_flows,
)
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.timing import Schedule
from burstcast.data.dataset import component_scales
from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasters.registry import class_of
from burstcast.systems.base import DynamicalSystem

SCORES = (
    "exceedance_uncontrolled",
    "exceedance_controlled",
    "relative_exceedance",
    "events_per_lyapunov_time_uncontrolled",
    "events_per_lyapunov_time_controlled",
    "control_fraction",
    "switchings_per_lyapunov_time",
    "fallback_fraction",
    "escaped_fraction",
    *COSTS,
)
"""Scores of `ControlledSystem`: those of `burstcast.control.records` that every system has."""

_RESAMPLES, _CONFIDENCE = 1000, 0.95
_FALLBACKS = 0.01
"""Share of decisions without a valid forecast above which a run warns."""

ALWAYS, RANDOM = "always", "random"
"""References of a run: the actuation always on, and at random with the same duty cycle."""


@dataclass(frozen=True, repr=False)
class ControlledSystem:
    """Trajectories of a system with and without control, from the same states.

    Sample 0 is the last observation before control; all samples after the settling time of the
    strategy count in the scores.
    """

    time: FloatArray  #: time of each sample in the unit of the sampling interval, ``(samples,)``
    #: free_states, states: without and with control, ``(flow, time, component)``
    free_states: FloatArray
    states: FloatArray
    #: free_observable, observable: without and with control, ``(flow, time)``
    free_observable: FloatArray
    observable: FloatArray
    actuated: BoolArray  #: whether the flow came to each sample under actuation, ``(flow, time)``
    #: by name, with 95 % intervals over flows (`SCORES`): shares of the time at or above the event
    #: threshold without and with control, and their quotient; events per unit of durations; share
    #: of the time under actuation; how often it is switched on per unit of durations; share of the
    #: decisions without a valid forecast; share of the flows that leave the range of floating-point
    #: numbers under control, which the other scores leave out; mean length of the force that acts
    #: as the actuation (effort), and its mean power
    scores: Mapping[str, Interval]
    #: scores of the same flows with the actuation always on ("always"), and at random with the same
    #: share of the decisions ("random"); a reference under which all flows are lost is missing
    references: Mapping[str, Mapping[str, Interval]]

    def __repr__(self) -> str:
        flows, samples = self.actuated.shape
        lines = [f"ControlledSystem: {flows} flows of {samples} samples, 95 % intervals"]
        lines += [
            f"  {name:38s}{score.value:10.4g}  ({score.low:.4g} to {score.high:.4g})"
            for name, score in self.scores.items()
        ]
        for name, scores in self.references.items():
            left, time = scores["relative_exceedance"].value, scores["control_fraction"].value
            lines.append(
                f"  actuation {name}: relative exceedance {left:.4g} at {time:.4g} of time"
            )
        return "\n".join(lines)


def control_system(
    system: DynamicalSystem,
    forecaster: EventForecaster,
    strategy: ControlStrategy,
    series: Any,
    *,
    duration: float,
    actuation: Mapping[str, float] | None = None,
    force: Sequence[float] | None = None,
    strength: float = 1.0,
    delay: float = 0.0,
    pulse: tuple[float, float] = (-1.0, 1.5),
    noise: float = 0.0,
    sampling_stride: int | None = None,
    references: bool = True,
) -> ControlledSystem:
    """Control a system by the forecasts of a fitted event forecaster.

    Warns before the run if the forecaster has no skill in its own calibration, and after it if more
    than a hundredth of the decisions have no valid forecast (the strategy's ``fallback`` makes
    them), or if actuation at random, as often, leaves as little of the exceedance.

    Durations are those of the forecaster: in Lyapunov times, or in samples where it has no Lyapunov
    time; so are the settings of strategies whose names end in ``_lt``.

    Parameters
    ----------
    system
        The equations. Their states are the components of the forecaster's series, and their
        observable is the forecaster's.
    forecaster
        A fitted forecaster: it forecasts for the strategy, and it sets the event threshold, the
        washout and the unit of durations. Members of a committee or an ensemble vote.
    strategy
        A strategy of `burstcast.control.strategies`, such as ``RecedingHorizon(0.1, 1.0)``. One
        that gives forecasters the actuation needs a kind that learns parameters, and the actuation
        must change the parameters that it has learnt.
    series
        Observed states of the flows up to the present, ``(series, time, component)``. The last
        washout counts, and the last state is the one that control begins from.
    duration
        Length of the controlled and of the free trajectories.
    actuation
        Parameters of the equations under actuation, by name.
    force
        Constant force that is added under actuation, one number per component.
    strength
        Share of the change of the parameters, and of the force.
    delay
        Time from a decision to its effect.
    pulse
        Actuation that an alarm for a prediction window sets off (`PredictionTriggered`): its start,
        from the beginning of the window, and its length.
    noise
        Observation noise of the controlled flows, in standard deviations of each component.
    sampling_stride
        Integration steps of the system in a sample; None: the forecaster's.
    references
        Whether the flows are also run with the actuation always on and at random.

    Raises
    ------
    ValueError
        If the system, the strategy or the actuation does not fit the forecaster.
    FloatingPointError
        If all controlled flows leave the range of floating-point numbers, or a free one does.

    Examples
    --------
    >>> import numpy as np
    >>> import burstcast
    >>> from burstcast.control.strategies.receding_horizon import RecedingHorizon
    >>> from burstcast.systems.integration import integrate
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> start = np.array([[1.0], [1.0], [20.0]]) + np.random.default_rng(0).normal(size=(3, 20))
    >>> series = integrate(Lorenz63(), start, 0.01, 3000, stride=2)[500:].transpose(2, 0, 1)
    >>> forecaster = burstcast.EventForecaster(
    ...     Lorenz63(), 40.0, kind="nvar", lyapunov_time=1.1, sampling_interval=0.02,
    ...     sampling_stride=2, calibrate=False,
    ... )
    >>> forecaster = forecaster.fit(series[:10])
    >>> run = burstcast.control_system(
    ...     Lorenz63(), forecaster, RecedingHorizon(0.1, 0.7), series[10:, :100],
    ...     actuation={"rho": 24.0}, duration=10,
    ... )
    >>> run.states.shape, run.actuated.shape
    ((10, 551, 3), (10, 551))
    >>> bool(run.scores["relative_exceedance"].value < 0.5)
    True
    """
    states = forecaster._washouts(series)
    _check_fit(system, forecaster, strategy)
    if strategy.forecasts and forecaster.unskilled_times_:
        times = ", ".join(f"{time:g}" for time in forecaster.unskilled_times_)
        warnings.warn(
            f"{type(strategy).__name__} acts on a forecaster without skill in its own calibration "
            f"(prediction times {times}; warnings_ says why): low exceedance may be due to the "
            "actuation alone",
            stacklevel=2,
        )
    stride = forecaster.sampling_stride if sampling_stride is None else sampling_stride
    actuated = actuated_system(system, actuation or {}, force, strength)
    values = None
    if strategy.informed:
        names = forecaster._parameter_names
        values = ActuationValues.of(names, system, actuated, strength)
    reverses = bool(getattr(strategy, "push", "") or getattr(strategy, "reversible", False))
    schedule = Schedule(
        washout=states.shape[1],
        quiet_lt=0.0,
        span_lt=duration,
        delay_lt=delay,
        actuation_start_lt=pulse[0],
        actuation_duration_lt=pulse[1],
        steps_per_lyapunov_time=forecaster._timing.unit,
        sampling_stride=stride,
        time_step=forecaster._timing.sampling_interval / stride,
    )
    strategy.check(schedule)
    experiment = ControlExperiment(
        system=system,
        actuated_system=actuated,
        reversed_system=(
            reversed_actuation(system, force, strength) if reverses and force is not None else None
        ),
        threshold=forecaster.event_threshold_,
        series=range(len(states)),
        washouts=states,
        quiet_starts=False,
        schedule=schedule,
        root_seed=forecaster.random_seed,
        case=forecaster.case,
        values=values,
    )
    members = forecaster.members_ if strategy.forecasts else []
    alone = len(members) < 2 and (strategy.by_probability or not votes(type(strategy)))
    policy = controlling_policy(
        "forecaster" if alone else "committee", strategy, experiment, members
    )
    observed_noise = None
    if noise:
        length = strategy.timing(schedule).length
        scales = component_scales(forecaster._like_training(series))
        observed_noise = noise_of_flows(
            experiment.series, length, noise, scales, forecaster.random_seed, forecaster.case
        )
    with single_threaded():
        flows = strategy.simulate(
            experiment, policy, noise=observed_noise, keep_states=True, costs=True
        )
        scores, others = _scores(flows, forecaster), {}
        if references:
            others = _references(strategy, experiment, flows, forecaster)
    result = _result(flows, forecaster, scores, others)
    for text in _findings(result):
        warnings.warn(text, stacklevel=2)
    return result


def _references(
    strategy: ControlStrategy,
    experiment: ControlExperiment,
    flows: ControlledFlows,
    forecaster: EventForecaster,
) -> dict[str, dict[str, Interval]]:
    """Scores of the same flows under actuation that knows nothing, by name."""
    looks = strategy.timing(experiment.schedule).most_looks
    rate = float(flows.looks.alarm.mean()) if len(flows.looks.alarm) else 0.0
    draws = experiment.draws("random alarms", looks)
    policies = {ALWAYS: at_random(1.0, draws), RANDOM: at_random(rate, draws)}
    scores = {}
    for name, policy in policies.items():
        # judging alarms takes another integration, which is not read here
        with contextlib.suppress(FloatingPointError):
            run = simulate(experiment, strategy.timing(experiment.schedule), policy)
            scores[name] = _scores(run, forecaster)
    return scores


def _findings(result: ControlledSystem) -> Iterator[str]:
    """Sentences about a run whose scores are less than they seem."""
    share = result.scores["fallback_fraction"].value
    if share > _FALLBACKS:
        yield (
            f"{share:.1%} of the decisions have no valid forecast (fallback_fraction): the "
            "strategy's fallback made them, not the forecaster"
        )
    escaped = result.scores["escaped_fraction"].value
    if escaped > 0:
        flows = len(result.actuated)
        yield (
            f"{round(escaped * flows)} of {flows} flows leave the range of floating-point numbers "
            "under actuation (states are NaN from there on); scores are of the others: take a "
            "weaker actuation, or more integration steps in a sample (sampling_stride)"
        )
    left, time = (result.scores[name].value for name in ("relative_exceedance", "control_fraction"))
    if time > 0 and RANDOM in result.references:
        by_chance = result.references[RANDOM]["relative_exceedance"].value
        if left >= by_chance:
            yield (
                f"{left:.3g} of the exceedance is left with the actuation on {time:.0%} of the "
                f"time; actuation at random, as often, leaves {by_chance:.3g}: the decisions are "
                "no better than chance"
            )


def _scores(flows: ControlledFlows, forecaster: EventForecaster) -> dict[str, Interval]:
    costs = {} if flows.cost is None else {name: getattr(flows.cost, name) for name in COSTS}
    sample = FlowSample(record_flows(flows, None), Span.of(flows.timing), costs)
    generator = random_streams.stream(forecaster.random_seed, "control", forecaster.case)
    scores = flow_intervals(score_flows(sample, _RESAMPLES, generator), sample, _CONFIDENCE)
    return {name: scores[name] for name in SCORES if name in scores}


def _result(
    flows: ControlledFlows,
    forecaster: EventForecaster,
    scores: dict[str, Interval],
    references: dict[str, dict[str, Interval]],
) -> ControlledSystem:
    from_now = slice(flows.timing.first_look, None)
    samples = flows.timing.length - flows.timing.first_look
    assert flows.uncontrolled_states is not None
    assert flows.controlled_states is not None
    return ControlledSystem(
        time=forecaster._timing.sampling_interval * np.arange(samples, dtype=np.float64),
        free_states=flows.uncontrolled_states[:, from_now],
        states=flows.controlled_states[:, from_now],
        free_observable=flows.uncontrolled[:, from_now],
        observable=flows.controlled[:, from_now],
        actuated=flows.actuated[:, from_now],
        scores=scores,
        references=references,
    )


def _check_fit(
    system: DynamicalSystem, forecaster: EventForecaster, strategy: ControlStrategy
) -> None:
    """Check that a forecaster is one of this system, and of a kind that the strategy asks."""
    name = type(strategy).__name__
    if system.dimension != forecaster.components_:
        raise ValueError(
            f"states of the system have {system.dimension} components, the series of the "
            f"forecaster had {forecaster.components_}"
        )
    observable = system.observable(forecaster.reference_states_.T)
    if not np.allclose(observable, forecaster.reference_observable_, rtol=1e-9, atol=0):
        raise ValueError(
            "the observable of the system differs from the forecaster's: fit the forecaster with "
            "observable=system"
        )
    if strategy.informed and not class_of(forecaster._model).learns_parameters:
        raise ValueError(
            f"{name} gives forecasters the actuation: take a kind that learns parameters, such as "
            "quadratic_aware"
        )
    if strategy.forecasts:
        classifies = isinstance(forecaster.members_[0], EventClassifier)
        if strategy.by_probability and not classifies:
            raise ValueError(
                f"{name} acts on the probabilities of a classifier: take the kind precursor or "
                "esn_direct"
            )
        if classifies and not strategy.by_probability:
            raise ValueError(
                f"{name} needs forecasts of trajectories, which classifiers do not have: take "
                "another kind, or ProbabilityTriggered"
            )

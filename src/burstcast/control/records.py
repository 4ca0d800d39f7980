"""Records of each controlled flow, and costs and gains over all flows with intervals.

Flows are independent of each other: intervals are percentile bootstraps over flows, and a flow with
control is resampled together with the same flow without it. Flows that laminarise, with or without
control, are left out of both samples of the observable (as in the paper); they count in the hazard
of laminarisation alone. Flows that leave the range of floating-point numbers under control are left
out, too, and counted as escaped.

Where no event was observed, a bootstrap gives no upper bound. The rate of events is then at most
-log(1 - c) / T with confidence c (3.0 / T at 0.95), T being the counted time of all flows. How long
an event would last is not known: exceedances of zero have no upper end.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import NUMBER, POWER
from burstcast.base.poisson import rate_bound
from burstcast.base.resampled_score import ResampledScore
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.control.loop import ControlledFlows
from burstcast.control.timing import Timing
from burstcast.data.events import upward_crossings
from burstcast.data.laminarisation import first_laminar_step


def _count(meaning: str) -> Described:
    return Described("flow", NUMBER, meaning)


def _mean(meaning: str) -> Described:
    return Described("flow", POWER, meaning)


@dataclass(frozen=True)
class FlowRecords:
    """Records of each flow, ``(flows,)``; only steps and integration steps that count."""

    row: Annotated[IntArray, _count("row")]  #: position among the given flows
    #: exceeding_uncontrolled, exceeding_controlled: steps at or above the event threshold
    exceeding_uncontrolled: Annotated[IntArray, _count("exceeding uncontrolled")]
    exceeding_controlled: Annotated[IntArray, _count("exceeding controlled")]
    #: events_uncontrolled, events_controlled: upward crossings that end in a step that counts
    events_uncontrolled: Annotated[IntArray, _count("events uncontrolled")]
    events_controlled: Annotated[IntArray, _count("events controlled")]
    actuated_integration_steps: Annotated[IntArray, _count("actuated integration steps")]
    switchings: Annotated[IntArray, _count("switchings")]  #: number of starts of the actuation
    #: laminar_step_uncontrolled, laminar_step_controlled: steps from the first look to the first
    #: step above the laminarisation threshold; -1: there is none up to the last step that counts
    laminar_step_uncontrolled: Annotated[IntArray, _count("laminar step uncontrolled")]
    laminar_step_controlled: Annotated[IntArray, _count("laminar step controlled")]
    #: mean energy input and dissipation; NaN for a system without an energy budget
    input_uncontrolled: Annotated[FloatArray, _mean("input uncontrolled")]
    input_controlled: Annotated[FloatArray, _mean("input controlled")]
    dissipation_uncontrolled: Annotated[FloatArray, _mean("dissipation uncontrolled")]
    dissipation_controlled: Annotated[FloatArray, _mean("dissipation controlled")]
    decisions: Annotated[IntArray, _count("decisions")]  #: looks at the controlled flow
    #: decisions without a valid forecast, which the strategy's fallback made
    fallbacks: Annotated[IntArray, _count("decisions without a valid forecast")]

    #: step from the first look at which the controlled flow is out of the range of floating-point
    #: numbers; -1: it stays finite
    escape_step: Annotated[IntArray, _count("escape step")]

    @property
    def laminarises(self) -> BoolArray:
        """Whether each flow laminarises, with control or without it, ``(flows,)``."""
        return (self.laminar_step_uncontrolled >= 0) | (self.laminar_step_controlled >= 0)

    @property
    def escapes(self) -> BoolArray:
        """Whether each flow leaves the range of floating-point numbers, ``(flows,)``."""
        return self.escape_step >= 0

    @property
    def kept(self) -> BoolArray:
        """Whether each flow neither laminarises nor escapes, ``(flows,)``."""
        return ~self.laminarises & ~self.escapes


def record_flows(flows: ControlledFlows, laminarisation_threshold: float | None) -> FlowRecords:
    """Reduce simulated flows to records."""
    timing, counted = flows.timing, flows.timing.counted
    counts: dict[str, Any] = {
        name: getattr(flows, name) for name in ("actuated_integration_steps", "switchings")
    }
    for run in ("uncontrolled", "controlled"):
        observable, energy = getattr(flows, run), getattr(flows, f"{run}_energy")
        crossings = upward_crossings(observable, flows.threshold)
        from_start = observable[:, timing.first_look : timing.counted_until + 1]
        for name in ("input", "dissipation"):
            unknown = np.full(len(flows), np.nan)
            counts[f"{name}_{run}"] = unknown if energy is None else getattr(energy, name)
        counts |= {
            f"exceeding_{run}": (observable[:, counted] >= flows.threshold).sum(axis=1),
            f"events_{run}": crossings[:, counted].sum(axis=1),
            f"laminar_step_{run}": first_laminar_step(from_start, laminarisation_threshold),
        }
    looks = flows.looks
    for name, looked in (
        ("decisions", looks.flow),
        ("fallbacks", looks.flow[looks.without_forecast]),
    ):
        counts[name] = np.bincount(looked, minlength=len(flows))
    escape = np.where(flows.escape_step < 0, -1, flows.escape_step - timing.first_look)
    return FlowRecords(row=flows.rows, escape_step=escape, **counts)


@dataclass(frozen=True)
class Span:
    """Times for which flows count and are at risk of laminarisation."""

    steps: int  #: counted steps of each flow
    integration_steps: int  #: counted integration steps of each flow
    steps_at_risk: int  #: from the first look to the last step that counts
    steps_per_lyapunov_time: int

    @classmethod
    def of(cls, timing: Timing) -> "Span":
        """Span that all flows of a simulation have."""
        return cls(
            steps=timing.span,
            integration_steps=timing.span * timing.schedule.sampling_stride,
            steps_at_risk=timing.counted_until - timing.first_look,
            steps_per_lyapunov_time=timing.schedule.steps_per_lyapunov_time,
        )


RECORDS = tuple(field.name for field in fields(FlowRecords))
"""Names of the fields of `FlowRecords`."""
COSTS = ("effort", "power")
"""Costs of the actuation (`burstcast.control.energy.ActuationCost`), where they are recorded."""


@dataclass(frozen=True)
class FlowSample:
    """Flows of one run of control, which all ran for the same time."""

    records: FlowRecords
    span: Span
    #: costs of the actuation in each flow, ``(flows,)``, by name; empty: they were not recorded
    costs: Mapping[str, FloatArray] = field(default_factory=dict)

    @classmethod
    def of(cls, content: Mapping[str, Any]) -> "FlowSample":
        """Flows of a run from the variables and attributes of its file."""
        return cls(
            FlowRecords(**{name: content[name] for name in RECORDS}),
            Span(**{entry.name: int(content[entry.name]) for entry in fields(Span)}),
            {name: content[name] for name in COSTS if name in content},
        )

    def __len__(self) -> int:
        return len(self.records.row)

    def part(self, chosen: BoolArray) -> "FlowSample":
        """Sample of the ``chosen`` flows, ``(flows,)``."""
        records = {name: getattr(self.records, name)[chosen] for name in RECORDS}
        costs = {name: values[chosen] for name, values in self.costs.items()}
        return replace(self, records=FlowRecords(**records), costs=costs)

    def halves(self) -> tuple["FlowSample", "FlowSample"]:
        """Flows of series with even numbers, and flows of series with odd numbers."""
        even = self.records.row % 2 == 0
        return self.part(even), self.part(~even)


@dataclass(frozen=True)
class Interval:
    """A score of all flows with the ends of its confidence interval; NaN where undefined."""

    value: float
    low: float
    high: float


FLOW_SCORES = (
    "exceedance_uncontrolled",
    "exceedance_controlled",
    "relative_exceedance",
    "control_fraction",
    "switchings_per_lyapunov_time",
    "events_per_lyapunov_time_uncontrolled",
    "events_per_lyapunov_time_controlled",
    "input_uncontrolled",
    "input_controlled",
    "relative_input",
    "dissipation_uncontrolled",
    "dissipation_controlled",
    "relative_dissipation",
    "laminarisation_hazard_uncontrolled",
    "laminarisation_hazard_controlled",
    "fallback_fraction",
    "escaped_fraction",
)
"""What control costs and gains, in the order of `score_flows`.

Exceedances are shares of the time; ``relative_exceedance`` is the share of the uncontrolled
exceedance that is left, 1 - reduction. ``control_fraction`` is the share of the time under
actuation. Hazards are laminarisations per Lyapunov time of the flows that are not laminar yet.
``fallback_fraction`` is the share of the decisions that no valid forecast stands behind,
``escaped_fraction`` the share of the flows that leave the range of floating-point numbers under
control.
"""


def score_flows(
    sample: FlowSample, resamples: int, generator: np.random.Generator
) -> dict[str, ResampledScore]:
    """Score flows: all of `FLOW_SCORES`, and the means of the costs that were recorded.

    ``generator``: Runs on the same flows are compared on the same resamples if their generators
    start in the same state.
    """
    weights = np.ones((resamples + 1, len(sample)))
    if len(sample):
        weights[1:] = bootstrap_weights(len(sample), resamples, generator)
    values = weighted_scores(sample, weights)
    return {
        name: ResampledScore(float(samples[0]), samples[1:]) for name, samples in values.items()
    }


def weighted_scores(sample: FlowSample, weights: FloatArray) -> dict[str, FloatArray]:
    """Scores of `score_flows` by name, ``(resamples,)`` each; NaN where a score is not defined.

    ``weights``: Weights of the flows in each resample, ``(resamples, flows)``.
    """
    records, span, kept = sample.records, sample.span, sample.records.kept
    weighted = weights * kept
    number = weighted.sum(axis=1)
    lyapunov_times = span.steps / span.steps_per_lyapunov_time

    def mean(values: npt.NDArray[np.generic]) -> FloatArray:
        # flows that do not count may have values that are not defined
        return _quotient((weighted * np.where(kept, values, 0.0)).sum(axis=1), number)

    scores = {name: mean(of_flows) for name, of_flows in sample.costs.items()}
    for run in ("uncontrolled", "controlled"):
        scores[f"exceedance_{run}"] = mean(getattr(records, f"exceeding_{run}")) / span.steps
        events = mean(getattr(records, f"events_{run}"))
        scores[f"events_per_lyapunov_time_{run}"] = events / lyapunov_times
        for name in ("input", "dissipation"):
            scores[f"{name}_{run}"] = mean(getattr(records, f"{name}_{run}"))
        step = getattr(records, f"laminar_step_{run}")
        at_risk = np.where(step < 0, span.steps_at_risk, step) / span.steps_per_lyapunov_time
        scores[f"laminarisation_hazard_{run}"] = _quotient(
            (weights * (step >= 0)).sum(axis=1), (weights * at_risk).sum(axis=1)
        )
    for name in ("exceedance", "input", "dissipation"):
        scores[f"relative_{name}"] = _quotient(
            scores[f"{name}_controlled"], scores[f"{name}_uncontrolled"]
        )
    scores["control_fraction"] = mean(records.actuated_integration_steps) / span.integration_steps
    scores["fallback_fraction"] = _quotient(
        (weighted * records.fallbacks).sum(axis=1), (weighted * records.decisions).sum(axis=1)
    )
    scores["escaped_fraction"] = _quotient(
        (weights * records.escapes).sum(axis=1), weights.sum(axis=1)
    )
    scores["switchings_per_lyapunov_time"] = mean(records.switchings) / lyapunov_times
    return {name: scores[name] for name in (*FLOW_SCORES, *sample.costs)}


def flow_intervals(
    scores: Mapping[str, ResampledScore], sample: FlowSample, confidence: float
) -> dict[str, Interval]:
    """Intervals over flows of the scores of `score_flows`, by their names."""
    intervals = {
        name: Interval(float(score.value), *percentile_interval(score.samples, confidence))
        for name, score in scores.items()
    }
    return {**intervals, **_bounds_of_nothing(sample, confidence, intervals)}


def _bounds_of_nothing(
    sample: FlowSample, confidence: float, intervals: Mapping[str, Interval]
) -> dict[str, Interval]:
    """Upper bounds for counts of zero in all flows (see the module)."""
    bounds = {}
    span, flows = sample.span, int(sample.records.kept.sum())
    at_risk = {"laminarisation_hazard": (len(sample), span.steps_at_risk)}
    at_risk["events_per_lyapunov_time"] = (flows, span.steps)
    for rate, (number, steps) in at_risk.items():
        for run in ("uncontrolled", "controlled"):
            if intervals[f"{rate}_{run}"].value == 0:
                time = number * steps / span.steps_per_lyapunov_time
                bounds[f"{rate}_{run}"] = Interval(0.0, 0.0, rate_bound(time, confidence))
    for name in ("exceedance_uncontrolled", "exceedance_controlled", "relative_exceedance"):
        if intervals[name].value == 0:
            bounds[name] = Interval(0.0, 0.0, math.nan)
    return bounds


def _quotient(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """Quotients; NaN where the denominator is zero."""
    result = np.full(np.broadcast(numerator, denominator).shape, np.nan)
    np.divide(numerator, denominator, out=result, where=denominator != 0)
    return result

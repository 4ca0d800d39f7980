"""What control costs and gains: records, scores, and what is chosen by them."""

from dataclasses import replace

import numpy as np
import pytest
from helpers_control import FLOW, simulation_of

from burstcast.base.names import ForecasterName
from burstcast.base.resampling import bootstrap_weights
from burstcast.control.actuation import actuated_system
from burstcast.control.choice import choose
from burstcast.control.energy import energy_means
from burstcast.control.loop import Looks
from burstcast.control.records import (
    COSTS,
    FLOW_SCORES,
    RECORDS,
    FlowRecords,
    FlowSample,
    Interval,
    Span,
    flow_intervals,
    record_flows,
    score_flows,
    weighted_scores,
)
from burstcast.control.strategies.reactive import Reactive
from burstcast.control.timing import Schedule
from burstcast.systems.base import EnergyBudget
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.tables.cells import medians_over_seeds

SPAN = Span(steps=6, integration_steps=12, steps_at_risk=8, steps_per_lyapunov_time=2)
WHO = ("uncontrolled", "controlled")


@pytest.mark.parametrize("laminar", [None, 1.0, 2.0])
def test_record_flows_counts_what_counts(laminar):
    """The first forecast at step 1, steps 4 to 9 count; two steps in a Lyapunov time."""
    timing = Reactive(0.5, 0.5).timing(Schedule(2, 1.0, 3.0, 0.0, 0.0, 1.0, 2, 2, 0.1))
    assert Span.of(timing) == SPAN
    generator = np.random.default_rng(1)
    heights = {run: generator.choice([0.0, 0.9, 1.0, 2.0, 3.0], (40, 10)) for run in WHO}
    names = ("actuated_integration_steps", "switchings")
    counts = {name: generator.integers(9, size=40) for name in names}
    rows = np.arange(5, 45)
    budget = EnergyBudget(*generator.normal(size=(2, 40)))
    flow, step = np.arange(80) % 40, np.arange(80)
    looks = Looks(flow, step, step < 0, (step >= 40) & (step < 50), {})
    flows = simulation_of(
        timing, **heights, **counts, rows=rows, controlled_energy=budget, looks=looks
    )
    recorded = record_flows(flows, laminar)
    assert recorded.decisions.tolist() == [2] * 40
    assert recorded.fallbacks.tolist() == [1] * 10 + [0] * 30
    for name, expected in {**counts, "row": rows}.items():
        assert getattr(recorded, name).tolist() == expected.tolist()
    for run, of_flows in heights.items():
        for flow, height in enumerate(of_flows):
            counted = range(4, 10)
            exceeding = sum(height[step] >= 1 for step in counted)
            events = sum(height[step - 1] < 1 <= height[step] for step in counted)
            above = [step for step in range(9) if laminar and height[1 + step] > laminar]
            assert getattr(recorded, f"exceeding_{run}")[flow] == exceeding
            assert getattr(recorded, f"events_{run}")[flow] == events
            assert getattr(recorded, f"laminar_step_{run}")[flow] == min(above, default=-1)
    np.testing.assert_array_equal(recorded.input_controlled, budget.input)
    np.testing.assert_array_equal(recorded.dissipation_controlled, budget.dissipation)
    assert np.isnan([recorded.input_uncontrolled, recorded.dissipation_uncontrolled]).all()


# -- scores ----------------------------------------------------------------------------------------


def random_records(flows, seed, controlled=0.2, laminar=0, escaped=0):
    """Flows of which the first ``laminar`` laminarise, alternately without and with control.

    The last ``escaped`` escape.

    Of flows that laminarise, control may leave an energy that is no number.
    """
    generator = np.random.default_rng(seed)
    values = {"row": np.arange(flows)}
    values["actuated_integration_steps"] = generator.binomial(12, 0.1, flows)
    values["switchings"] = generator.binomial(2, 0.1, flows)
    values["decisions"] = np.full(flows, 9) + np.arange(flows) % 2
    for parity, (run, share) in enumerate(zip(WHO, (0.3, controlled), strict=True)):
        values[f"exceeding_{run}"] = generator.binomial(6, share, flows)
        values[f"events_{run}"] = generator.binomial(2, share, flows)
        step = np.full(flows, -1)
        step[parity:laminar:2] = generator.integers(0, 9, len(step[parity:laminar:2]))
        values[f"laminar_step_{run}"] = step
        for name in ("input", "dissipation"):
            of_flows = generator.normal(2.0, 0.1, flows)
            of_flows[step >= 0] = np.nan
            values[f"{name}_{run}"] = of_flows
    values["escape_step"] = np.where(np.arange(flows) >= flows - escaped, 3, -1)
    values["fallbacks"] = generator.binomial(9, 0.3, flows)
    return FlowRecords(**values)


def plain_scores(records, span, drawn, costs):
    """Scores of flows that are drawn, some of them more than once, flow by flow."""
    kept = [
        flow
        for flow in drawn
        if max(records.laminar_step_uncontrolled[flow], records.laminar_step_controlled[flow]) < 0
        and records.escape_step[flow] < 0
    ]

    def quotient(numerator, denominator):
        return numerator / denominator if denominator else np.nan

    def mean(values):
        return quotient(sum(float(values[flow]) for flow in kept), len(kept))

    lyapunov_times = span.steps / span.steps_per_lyapunov_time
    scores = {name: mean(values) for name, values in costs.items()}
    scores["control_fraction"] = mean(records.actuated_integration_steps) / span.integration_steps
    scores["switchings_per_lyapunov_time"] = mean(records.switchings) / lyapunov_times
    for run in WHO:
        values = {name: getattr(records, f"{name}_{run}") for name in ("input", "dissipation")}
        scores |= {f"{name}_{run}": mean(values[name]) for name in values}
        scores[f"exceedance_{run}"] = mean(getattr(records, f"exceeding_{run}")) / span.steps
        events = mean(getattr(records, f"events_{run}"))
        scores[f"events_per_lyapunov_time_{run}"] = events / lyapunov_times
        steps = [int(getattr(records, f"laminar_step_{run}")[flow]) for flow in drawn]
        risk = sum(span.steps_at_risk if step < 0 else step for step in steps)
        hazard = quotient(sum(step >= 0 for step in steps), risk / span.steps_per_lyapunov_time)
        scores[f"laminarisation_hazard_{run}"] = hazard
    decisions = sum(int(records.decisions[flow]) for flow in kept)
    fallbacks = sum(int(records.fallbacks[flow]) for flow in kept)
    scores["fallback_fraction"] = quotient(fallbacks, decisions)
    escaped = sum(int(records.escape_step[flow] >= 0) for flow in drawn)
    scores["escaped_fraction"] = quotient(escaped, len(drawn))
    for name in ("exceedance", "input", "dissipation"):
        pair = scores[f"{name}_controlled"], scores[f"{name}_uncontrolled"]
        scores[f"relative_{name}"] = quotient(*pair)
    return scores


@pytest.mark.parametrize("flows", [0, 1, 6, 40])
def test_score_flows_is_a_plain_sum_over_the_flows_of_each_resample(flows):
    """Flows that laminarise count in hazards alone; their energies and costs are not defined."""
    records, generator = (
        random_records(flows, 1, laminar=3, escaped=flows // 20),
        np.random.default_rng(2),
    )
    laminar = np.maximum(records.laminar_step_uncontrolled, records.laminar_step_controlled) >= 0
    costs = {name: np.where(laminar, np.nan, generator.random(flows)) for name in COSTS}
    sample = FlowSample(records, SPAN, costs)
    scores = score_flows(sample, 30, np.random.default_rng(3))
    assert tuple(scores) == (*FLOW_SCORES, *COSTS)
    assert tuple(score_flows(FlowSample(records, SPAN), 3, generator)) == FLOW_SCORES
    weights = np.ones((31, flows), dtype=int)
    if flows:
        weights[1:] = bootstrap_weights(flows, 30, np.random.default_rng(3))
    expected = [
        plain_scores(records, SPAN, np.repeat(np.arange(flows), times), costs) for times in weights
    ]
    intervals = flow_intervals(scores, sample, 0.9)
    for name, score in scores.items():
        values = [resample[name] for resample in expected]
        np.testing.assert_allclose([score.value, *score.samples], values, rtol=1e-12, atol=1e-14)
        finite = [value for value in values[1:] if np.isfinite(value)]
        if score.value:  # of zero there are bounds
            ends = np.quantile(finite, [0.05, 0.95]) if finite else [np.nan, np.nan]
            np.testing.assert_allclose([intervals[name].low, intervals[name].high], ends)


def test_flow_intervals_bound_rates_of_what_was_not_observed():
    records = random_records(1000, 3, controlled=0.0)
    sample = FlowSample(replace(records, events_controlled=records.events_controlled * 0), SPAN)
    scores = flow_intervals(score_flows(sample, 400, np.random.default_rng(0)), sample, 0.95)
    bounds = {
        # three events in the counted time of all flows, three Lyapunov times each
        "events_per_lyapunov_time_controlled": 3 / (1000 * 3),
        # three laminarisations in the whole time at risk
        **{f"laminarisation_hazard_{run}": 3 / (1000 * 4) for run in WHO},
    }
    for name, bound in bounds.items():
        assert scores[name] == Interval(0, 0, pytest.approx(bound, rel=4e-3))
    # how long such an event would last is not known
    for name in ("exceedance_controlled", "relative_exceedance"):
        assert scores[name] == Interval(0, 0, pytest.approx(np.nan, nan_ok=True))
    assert scores["events_per_lyapunov_time_uncontrolled"].low > 0


# -- the energy budget -----------------------------------------------------------------------------


@pytest.mark.parametrize("reynolds", [400.0, 2000.0])
def test_energy_budget_at_the_laminar_state_is_one_of_viscosity(reynolds):
    """There k = 0.5, and input equals dissipation, beta^2 / Re."""
    laminar = replace(FLOW, reynolds=reynolds).energy_budget(np.eye(9)[:, :1])
    assert laminar.input == pytest.approx(np.pi**2 / 4 / reynolds)
    assert laminar.dissipation == laminar.input


def test_a_system_without_a_budget_has_no_energy_means():
    lorenz = Lorenz63()
    assert lorenz.energy_budget(np.ones((3, 2))) is None
    assert actuated_system(lorenz, {}, [1.0, 0, 0]).energy_budget(np.ones((3, 2))) is None
    assert energy_means((lorenz,), np.ones((2, 4, 3)), np.zeros((2, 4), np.uint8)) is None


# -- medians over networks -------------------------------------------------------------------------


def scored(records):
    return score_flows(FlowSample(records, SPAN), 200, np.random.default_rng(11))


def test_medians_over_seeds_are_those_of_networks_that_differ_by_their_seeds():
    members = [
        (ForecasterName("esn", 500, "RV", seed), scored(random_records(30, seed)))
        for seed in range(3)
    ]
    other = ForecasterName("equations"), scored(random_records(30, 9))
    medians = medians_over_seeds([members[0], other, *members[1:]])
    assert list(medians) == ["median of esn-N500-RV", "equations"]
    for name in ("relative_exceedance", "control_fraction"):
        np.testing.assert_array_equal(
            medians["median of esn-N500-RV"][name].samples,
            np.median([scores[name].samples for _, scores in members], axis=0),
        )
    (single,) = medians_over_seeds(members[:1])
    assert single == "esn-N500-RV-seed0"


# -- settings chosen on half of the flows ----------------------------------------------------------


def test_halves_are_flows_of_series_with_even_and_odd_numbers():
    """Each with the scores of its flows."""
    rows = np.array([7, 10, 12, 13, 14])
    records = replace(random_records(5, 1, laminar=1), row=rows)
    effort = np.arange(5.0)
    halves = FlowSample(records, SPAN, {"effort": effort}).halves()
    for half, flows in zip(halves, ([1, 2, 4], [0, 3]), strict=True):
        assert half.records.row.tolist() == rows[flows].tolist()
        expected = plain_scores(records, SPAN, flows, {"effort": effort})
        scores = weighted_scores(half, np.ones((1, len(half))))
        values = {name: float(value[0]) for name, value in scores.items()}
        assert values == pytest.approx(expected, nan_ok=True)


def flows_with(left, acting, effort=None):
    """Flows with 20 exceeding steps each without control; ``left`` steps and acting steps given."""
    nothing = np.zeros(len(left), dtype=np.int64)
    values = dict.fromkeys(RECORDS, nothing)
    values |= {
        name: nothing - 1 for name in RECORDS if name.endswith("_step") or "laminar_step" in name
    }
    values |= {"exceeding_uncontrolled": nothing + 20, "exceeding_controlled": np.array(left)}
    values["actuated_integration_steps"] = np.array(acting)
    costs = {} if effort is None else {"effort": np.array(effort)}
    return FlowSample(FlowRecords(**values), SPAN, costs)


SOME = [flows_with([8, 8], [1, 1]), flows_with([0, 0], [9, 9]), flows_with([2, 0], [5, 5])]
LONGER, HARDER = flows_with([0], [9], [0.1]), flows_with([0], [1], [0.2])


@pytest.mark.parametrize(
    ("candidates", "tolerance", "chosen"),
    [
        (SOME, 0.0, 1),  # the only one that leaves nothing, at any cost
        (SOME, 0.06, 2),  # leaves 5 %, and acts less
        (SOME, 0.05, 2),  # just as much as may be left
        (SOME, 0.5, 0),  # leaves 40 %, and acts least
        # the least exceedance, and then the costs, where none is within the tolerance
        ([SOME[0], flows_with([4, 4], [9, 9]), flows_with([4, 4], [5, 5])], 0.1, 2),
        # the effort, where it was recorded of all
        ([LONGER, HARDER], 0.01, 0),
        ([flows_with([0], [9]), HARDER], 0.01, 1),
        # those whose scores are not defined come last
        ([flows_with([], []), flows_with([20], [50])], 0.01, 1),
    ],
)
def test_choose_takes_the_cheapest_that_leaves_little(candidates, tolerance, chosen):
    assert choose(candidates, tolerance) == chosen


def test_choose_needs_candidates():
    with pytest.raises(ValueError, match="nothing to choose from"):
        choose([], 0.01)

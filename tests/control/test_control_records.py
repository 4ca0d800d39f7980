"""What control costs and gains, by hand: records, their differences, and what is chosen by them."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.integrate
from helpers_control import FLOW, RAISED, SCHEDULE, simulation_of, turbulent_washouts

from burstcast.arrays import FloatArray
from burstcast.control.actuation import actuated_system
from burstcast.control.choice import FlowSample, choose
from burstcast.control.differences import COMPARED, ComparedRun, paired_differences
from burstcast.control.energy import energy_means
from burstcast.control.loop import ControlledFlows
from burstcast.control.records import (
    FLOW_SCORES,
    RECORDS,
    FlowRecords,
    Interval,
    Span,
    flow_intervals,
    record_flows,
    score_flows,
)
from burstcast.control.strategies.random_decisions import RandomDecisions
from burstcast.control.timing import Schedule
from burstcast.forecasters._names import ForecasterName
from burstcast.statistics.resampling import bootstrap_weights
from burstcast.systems.base import EnergyBudget
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.tables.cells import medians_over_seeds, with_interval

# the first forecast at step 0, steps 3 to 8 count; two steps in a Lyapunov time
CLOCK = RandomDecisions(0.5, 0.5).timing(Schedule(1, 1.0, 3.0, 0.0, 0.0, 1.0, 2, 2, 0.1))
SPAN = Span(steps=6, integration_steps=12, steps_at_risk=8, steps_per_lyapunov_time=2)


def flows_of(uncontrolled: list[list[float]], controlled: list[list[float]]) -> ControlledFlows:
    flows = len(controlled)
    return simulation_of(
        CLOCK,
        controlled,
        uncontrolled=np.array(uncontrolled),
        rows=5 + np.arange(flows),
        actuated_integration_steps=3 + np.arange(flows),
        switchings=1 + np.arange(flows),
        uncontrolled_energy=EnergyBudget(np.full(flows, 2.0), np.full(flows, 4.0)),
        controlled_energy=EnergyBudget(1.0 + np.arange(flows), np.full(flows, 3.0)),
    )


def series(*above: int, level: float = 1.0) -> list[float]:
    return [level if step in above else 0.0 for step in range(9)]


def test_records_count_what_counts() -> None:
    assert (CLOCK.counted_from, CLOCK.counted_until) == (2, 8)
    flows = flows_of(
        [series(2, 3, 4, 8), series(0, 7, level=3.0)], [series(3, 8), series(5, level=3.0)]
    )
    records = record_flows(flows, 2.0)
    assert records.row.tolist() == [5, 6]
    # step 2 does not count, but the crossing at step 3 is none since it was above at step 2
    assert records.exceeding_uncontrolled.tolist() == [3, 1]
    assert records.events_uncontrolled.tolist() == [1, 1]
    assert records.exceeding_controlled.tolist() == [2, 1]
    assert records.events_controlled.tolist() == [2, 1]
    assert records.laminar_step_uncontrolled.tolist() == [-1, 0]
    assert records.laminar_step_controlled.tolist() == [-1, 5]
    nobody = record_flows(flows, None)
    assert nobody.laminar_step_uncontrolled.tolist() == [-1, -1]


def score(records: FlowRecords, seed: int = 0, resamples: int = 400) -> dict[str, Interval]:
    scores = score_flows(records, SPAN, resamples, np.random.default_rng(seed))
    return flow_intervals(scores, records, SPAN, 0.95)


def test_scores_of_two_flows_by_hand() -> None:
    flows = flows_of(
        [series(3, 4, 5), series(6), series(8, level=3.0)], [series(3), series(), series()]
    )
    scores = score(record_flows(flows, 2.0))
    assert tuple(scores) == FLOW_SCORES
    # the third flow laminarises without control: it counts in neither sample
    value = {name: interval.value for name, interval in scores.items()}
    assert value["exceedance_uncontrolled"] == pytest.approx(4 / 12)
    assert value["exceedance_controlled"] == pytest.approx(1 / 12)
    assert value["relative_exceedance"] == pytest.approx(1 / 4)
    assert value["control_fraction"] == pytest.approx((3 + 4) / 24)
    assert value["switchings_per_lyapunov_time"] == pytest.approx((1 + 2) / 6)
    assert value["events_per_lyapunov_time_uncontrolled"] == pytest.approx(2 / 6)
    assert value["events_per_lyapunov_time_controlled"] == pytest.approx(1 / 6)
    assert value["input_uncontrolled"] == 2
    assert value["input_controlled"] == pytest.approx(1.5)
    assert value["relative_input"] == pytest.approx(0.75)
    assert value["relative_dissipation"] == pytest.approx(0.75)
    # one laminarisation at step 8, the others at risk for 8 steps: 24 steps, 12 Lyapunov times
    assert value["laminarisation_hazard_uncontrolled"] == pytest.approx(1 / 12)
    assert value["laminarisation_hazard_controlled"] == 0
    for name, interval in scores.items():
        assert interval.low <= interval.value <= interval.high, name


def random_records(flows: int, seed: int, controlled: float) -> FlowRecords:
    generator = np.random.default_rng(seed)
    nothing = np.zeros(flows, dtype=np.int64)
    return FlowRecords(
        row=np.arange(flows),
        exceeding_uncontrolled=generator.binomial(6, 0.3, flows),
        exceeding_controlled=generator.binomial(6, controlled, flows),
        events_uncontrolled=generator.binomial(2, 0.3, flows),
        events_controlled=generator.binomial(2, controlled, flows),
        actuated_integration_steps=generator.binomial(12, 0.1, flows),
        switchings=generator.binomial(2, 0.1, flows),
        laminar_step_uncontrolled=nothing - 1,
        laminar_step_controlled=nothing - 1,
        input_uncontrolled=generator.normal(2.0, 0.1, flows),
        input_controlled=generator.normal(1.0, 0.1, flows),
        dissipation_uncontrolled=generator.normal(2.0, 0.1, flows),
        dissipation_controlled=generator.normal(1.0, 0.1, flows),
    )


def test_intervals_are_as_wide_as_the_standard_error_says() -> None:
    records = random_records(2000, 1, 0.05)
    scores = score(records, resamples=2000)
    error = records.exceeding_controlled.std(ddof=1) / 6 / np.sqrt(2000)
    interval = scores["exceedance_controlled"]
    assert interval.high - interval.low == pytest.approx(2 * 1.96 * error, rel=0.06)
    # paired: control that changes nothing leaves all of it, without any doubt
    same = replace(records, exceeding_controlled=records.exceeding_uncontrolled)
    assert score(same)["relative_exceedance"] == Interval(1, 1, 1)


def test_intervals_cover_as_often_as_they_say() -> None:
    covered = 0
    for seed in range(300):
        interval = score(random_records(60, seed, 0.1), seed, 200)["exceedance_controlled"]
        covered += interval.low <= 0.1 <= interval.high
    assert 0.89 < covered / 300 < 0.985


def test_where_nothing_is_left_the_rule_of_three_bounds_it() -> None:
    records = random_records(1000, 3, 0.0)
    scores = score(records)
    # three flows in a thousand, which exceed as long as those do that exceed without control
    exceeding = records.exceeding_uncontrolled
    typical = exceeding[exceeding > 0].mean() / 6
    left = scores["exceedance_controlled"]
    assert (left.value, left.low) == (0, 0)
    assert left.high == pytest.approx(0.003 * typical, rel=4e-3)
    relative = scores["relative_exceedance"]
    assert (relative.value, relative.low) == (0, 0)
    assert relative.high == pytest.approx(left.high / scores["exceedance_uncontrolled"].value)
    # and have as many events as those have
    events = scores["events_per_lyapunov_time_controlled"]
    assert (events.value, events.low) == (0, 0)
    expected = 0.003 * records.events_uncontrolled[exceeding > 0].mean() / 3
    assert events.high == pytest.approx(expected, rel=4e-3)
    # three laminarisations in the whole time at risk
    hazard = scores["laminarisation_hazard_controlled"]
    assert (hazard.value, hazard.low) == (0, 0)
    assert hazard.high == pytest.approx(3 / (1000 * 4), rel=4e-3)


def test_flows_that_do_not_count_need_no_defined_energy() -> None:
    """Of a flow that laminarises, control may leave an energy that is no number."""
    records = random_records(20, 4, 0.1)
    laminar = np.where(np.arange(20) == 7, 0, -1)  # at the first forecast, at once
    other = np.where(np.arange(20) == 7, np.nan, records.input_controlled)
    scores = score(replace(records, laminar_step_controlled=laminar, input_controlled=other))
    assert scores["input_controlled"].value == pytest.approx(np.nanmean(other))
    # one laminarisation; 19 flows at risk for 8 steps, and one for none: 76 Lyapunov times
    assert scores["laminarisation_hazard_controlled"].value == pytest.approx(1 / 76)


def test_flows_that_do_not_count_need_no_defined_cost() -> None:
    laminar = np.where(np.arange(20) == 7, 0, -1)
    records = replace(random_records(20, 0, 0.5), laminar_step_controlled=laminar)
    effort = np.where(laminar < 0, 2.0, np.nan)
    found = score_flows(records, SPAN, 9, np.random.default_rng(0), {"effort": effort})["effort"]
    assert (found.value, *found.samples) == (2.0,) * 10


def test_no_flow_at_all_has_no_scores() -> None:
    empty = record_flows(flows_of([series()], [series()]), None)
    none = FlowRecords(**{name: value[:0] for name, value in vars(empty).items()})
    assert all(np.isnan(interval.value) for interval in score(none).values())


# -- the energy budget -----------------------------------------------------------------------------


@pytest.mark.parametrize("reynolds", [400.0, 2000.0])
def test_energy_changes_by_input_less_dissipation(reynolds: float) -> None:
    """d/dt of the kinetic energy along the right-hand side: the quadratic terms exchange only."""
    system = MoehlisFaisstEckhardt(reynolds)
    state = np.random.default_rng(0).normal(size=(9, 500))
    budget = system.energy_budget(state)
    change = (state * system.right_hand_side(state)).sum(axis=0)
    np.testing.assert_allclose(budget.input - budget.dissipation, change, atol=1e-13)
    # at rest at the laminar state: k = 0.5 and input equals dissipation, beta^2 / Re
    laminar = system.energy_budget(np.eye(9)[:, :1])
    assert laminar.input == pytest.approx(np.pi**2 / 4 / reynolds)
    assert laminar.dissipation == laminar.input


def test_the_budget_of_a_flow_closes_over_time() -> None:
    """Energy at the end less that at the start is the integral of input less dissipation."""
    start = turbulent_washouts(FLOW, 20, SCHEDULE)[:, -1].T.copy()
    samples = integrate(FLOW, start, 0.25, 4000)
    budget = FLOW.energy_budget(np.ascontiguousarray(samples.transpose(1, 0, 2)))
    gained = scipy.integrate.simpson(budget.input - budget.dissipation, dx=0.25, axis=0)
    energy = FLOW.observable(samples.transpose(1, 0, 2))
    np.testing.assert_allclose(gained, energy[-1] - energy[0], atol=1e-6)
    spent = np.trapezoid(budget.dissipation, dx=0.25, axis=0)
    assert (spent > 100 * np.abs(gained - energy[-1] + energy[0])).all()


def test_a_force_adds_its_work_to_the_input() -> None:
    force = [0.001, 0, -0.002, 0, 0, 0, 0, 0, 0.0]
    forced = actuated_system(FLOW, {"reynolds": 800.0}, force)
    state = np.random.default_rng(0).normal(size=(9, 50))
    budget = forced.energy_budget(state)
    assert budget is not None
    change = (state * forced.right_hand_side(state)).sum(axis=0)
    np.testing.assert_allclose(budget.input - budget.dissipation, change, atol=1e-13)


def test_a_system_without_a_budget_has_no_energies() -> None:
    lorenz = Lorenz63()
    assert lorenz.energy_budget(np.ones((3, 2))) is None
    assert actuated_system(lorenz, {}, [1.0, 0, 0]).energy_budget(np.ones((3, 2))) is None
    assert energy_means((lorenz,), np.ones((2, 4, 3)), np.zeros((2, 4), np.uint8)) is None


def test_steps_under_actuation_have_the_budget_of_the_actuation() -> None:
    states = np.random.default_rng(0).normal(size=(3, 8, 9))
    actuated = np.random.default_rng(1).random((3, 8)) < 0.5

    def by_hand(name: str) -> FloatArray:
        means = []
        for flow in range(3):
            values = [
                getattr((RAISED if on else FLOW).energy_budget(state[:, np.newaxis]), name)[0]
                for state, on in zip(states[flow], actuated[flow], strict=True)
            ]
            means.append(np.mean(values))
        return np.array(means)

    found = energy_means((FLOW, RAISED), states, actuated.astype(np.uint8))
    assert found is not None
    np.testing.assert_allclose(found.input, by_hand("input"), rtol=1e-13)
    np.testing.assert_allclose(found.dissipation, by_hand("dissipation"), rtol=1e-13)
    free = np.zeros((3, 8), dtype=np.uint8)
    alone, never = (energy_means(one, states, free) for one in ((FLOW,), (FLOW, RAISED)))
    assert alone is not None
    assert never is not None
    np.testing.assert_array_equal(alone.input, never.input)


# -- strength --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("strength", "reynolds"), [(1.0, 2000.0), (0.5, 1200.0), (0.25, 800.0), (0.125, 600.0)]
)
def test_strength_is_a_share_of_the_change(strength: float, reynolds: float) -> None:
    assert actuated_system(FLOW, {"reynolds": 2000.0}, None, strength) == replace(
        FLOW, reynolds=reynolds
    )
    force = np.arange(9.0)
    state = np.random.default_rng(0).normal(size=(9, 4))
    pushed = actuated_system(FLOW, {}, list(force), strength)
    np.testing.assert_array_equal(
        pushed.right_hand_side(state),
        FLOW.right_hand_side(state) + (strength * force)[:, np.newaxis],
    )


@pytest.mark.parametrize("strength", [0.0, -1.0, np.nan])
def test_an_actuator_without_strength_is_refused(strength: float) -> None:
    with pytest.raises(ValueError, match="strength"):
        actuated_system(FLOW, {"reynolds": 2000.0}, None, strength)


# -- differences between runs ----------------------------------------------------------------------

OF_RUNS = Span(steps=40, integration_steps=160, steps_at_risk=50, steps_per_lyapunov_time=4)
FLOWS, RESAMPLES = 30, 200


def records_of(seed, effect=0.5, row=None):
    """Flows of which all runs have the same without control."""
    common, own = np.random.default_rng(0), np.random.default_rng(seed)
    uncontrolled = common.integers(0, 20, FLOWS)
    none = np.full(FLOWS, -1)
    unknown = np.full(FLOWS, np.nan)
    return FlowRecords(
        row=np.arange(FLOWS) if row is None else row,
        exceeding_uncontrolled=uncontrolled,
        exceeding_controlled=own.binomial(uncontrolled, effect),
        events_uncontrolled=none + 2,
        events_controlled=none + 1,
        actuated_integration_steps=own.integers(0, 80, FLOWS),
        switchings=own.integers(0, 5, FLOWS),
        laminar_step_uncontrolled=np.where(np.arange(FLOWS) == 3, 7, none),
        laminar_step_controlled=none,
        input_uncontrolled=unknown,
        input_controlled=unknown,
        dissipation_uncontrolled=unknown,
        dissipation_controlled=unknown,
    )


def scored(found):
    return score_flows(found, OF_RUNS, RESAMPLES, np.random.default_rng(11))


def run(seed, forecaster="esn", strategy="a", span=OF_RUNS, **options):
    found = records_of(seed, **options)
    return ComparedRun(forecaster, strategy, found.row, span, scored(found))


def by_hand(one, other):
    """Differences of both scores in each resample, flow by flow."""
    weights = bootstrap_weights(FLOWS, RESAMPLES, np.random.default_rng(11))
    samples = {name: [] for name in COMPARED}
    for sample in [np.ones(FLOWS, dtype=int), *weights]:
        drawn = [flow for flow in np.repeat(np.arange(FLOWS), sample) if flow != 3]
        left, spent = [], []
        for found in (one, other):
            free = sum(found.exceeding_uncontrolled[flow] for flow in drawn)
            left.append(sum(found.exceeding_controlled[flow] for flow in drawn) / free)
            steps = sum(found.actuated_integration_steps[flow] for flow in drawn)
            spent.append(steps / (len(drawn) * OF_RUNS.integration_steps))
        samples["relative_exceedance"].append(left[0] - left[1])
        samples["control_fraction"].append(spent[0] - spent[1])
    return samples


def test_differences_are_those_of_each_resample():
    pairs = list(paired_differences([run(1), run(2, "equations", effect=0.2)]))
    assert [name for _, _, name, _ in pairs] == list(COMPARED)
    expected = by_hand(records_of(1), records_of(2, effect=0.2))
    for one, other, name, difference in pairs:
        assert (one.forecaster, other.forecaster) == ("esn", "equations")
        assert difference.value == pytest.approx(expected[name][0])
        np.testing.assert_allclose(difference.samples, expected[name][1:], rtol=1e-12, atol=1e-14)
        cells = with_interval(difference, 0.9)
        np.testing.assert_allclose(
            [cells["low"], cells["high"]], np.quantile(expected[name][1:], [0.05, 0.95])
        )


def test_what_runs_share_cancels():
    """A difference of runs that err in the same flows is known better than either of them."""
    one = records_of(1)
    more = records_of(1)
    more.exceeding_controlled[:] = np.minimum(one.exceeding_controlled + 1, 20)
    first, second = scored(one), scored(more)
    difference = second["relative_exceedance"] - first["relative_exceedance"]
    assert difference.samples.std() < 0.5 * first["relative_exceedance"].samples.std()


def test_who_is_compared():
    runs = {
        "network": run(1),
        "equations": run(2, "equations"),
        "network, other strategy": run(3, strategy="b"),
        "equations, third": run(4, "equations", strategy="c"),
        "reactive": run(5, None, strategy="reactive"),
        "other flows": run(6, row=np.arange(1, FLOWS + 1)),
        "other span": run(7, span=Span(80, 320, 90, 4)),
    }
    names = {id(found): name for name, found in runs.items()}
    pairs = {
        (names[id(one)], names[id(other)])
        for one, other, _, _ in paired_differences(list(runs.values()))
    }
    assert pairs == {
        ("network", "equations"),
        ("network", "network, other strategy"),
        ("equations", "equations, third"),
        ("network", "reactive"),
        ("equations", "reactive"),
        ("network, other strategy", "reactive"),
        ("equations, third", "reactive"),
    }


def test_networks_that_differ_by_their_seeds_are_their_median():
    members = [
        (ForecasterName("esn", 500, "RV", seed), scored(records_of(seed))) for seed in range(3)
    ]
    other = ForecasterName("equations"), scored(records_of(9))
    found = medians_over_seeds([members[0], other, *members[1:]])
    assert list(found) == ["median of esn-N500-RV", "equations"]
    for name in COMPARED:
        np.testing.assert_array_equal(
            found["median of esn-N500-RV"][name].samples,
            np.median([scores[name].samples for _, scores in members], axis=0),
        )
    (single,) = medians_over_seeds(members[:1])
    assert single == "esn-N500-RV-seed0"


# -- settings chosen on half of the flows ----------------------------------------------------------

OF_CHOICE = Span(steps=100, integration_steps=100, steps_at_risk=100, steps_per_lyapunov_time=10)


def sample(left, acting, effort=None, rows=None):
    """Flows with 20 exceeding steps each without control; ``left`` steps and acting steps given."""
    rows = np.arange(len(left)) if rows is None else np.asarray(rows)
    values = {name: np.zeros(len(left), dtype=np.int64) for name in RECORDS}
    values |= {
        "row": rows,
        "exceeding_uncontrolled": np.full(len(left), 20),
        "exceeding_controlled": np.asarray(left),
        "actuated_integration_steps": np.asarray(acting),
        "laminar_step_uncontrolled": np.full(len(left), -1),
        "laminar_step_controlled": np.full(len(left), -1),
    }
    costs = {} if effort is None else {"effort": np.asarray(effort, dtype=float)}
    return FlowSample(FlowRecords(**values), OF_CHOICE, costs)


@pytest.mark.parametrize(
    ("tolerance", "chosen"),
    [
        (0.0, 1),  # the only one that leaves nothing, at any cost
        (0.06, 2),  # leaves 5 %, and acts less
        (0.05, 2),  # just as much as may be left
        (0.5, 0),  # leaves 40 %, and acts least
    ],
)
def test_the_cheapest_within_the_tolerance_is_chosen(tolerance, chosen):
    candidates = [sample([8, 8], [1, 1]), sample([0, 0], [9, 9]), sample([2, 0], [5, 5])]
    assert choose(candidates, tolerance) == chosen


def test_the_least_exceedance_counts_where_none_is_within_the_tolerance():
    candidates = [sample([8, 8], [1, 1]), sample([4, 4], [9, 9]), sample([4, 4], [5, 5])]
    assert choose(candidates, 0.1) == 2


def test_effort_is_the_cost_where_it_was_recorded_for_all():
    acting_longer, pushing_harder = sample([0], [9], [0.1]), sample([0], [1], [0.2])
    assert choose([acting_longer, pushing_harder], 0.01) == 0
    assert choose([sample([0], [9]), pushing_harder], 0.01) == 1


def test_settings_whose_scores_are_not_defined_are_the_last_choice():
    assert choose([sample([], []), sample([20], [50])], 0.01) == 1


def test_nothing_to_choose_from_is_refused():
    with pytest.raises(ValueError, match="nothing to choose from"):
        choose([], 0.01)


def test_the_row_of_a_series_decides_in_which_half_its_flow_is():
    whole = sample([1, 2, 3, 4], [0, 0, 0, 0], [1, 2, 3, 4], rows=[7, 10, 12, 13])
    choosing, scored = whole.halves()
    assert choosing.records.row.tolist() == [10, 12]
    assert scored.records.exceeding_controlled.tolist() == [1, 4]
    assert scored.costs["effort"].tolist() == [1, 4]


def test_values_are_those_of_the_flows():
    values = sample([2, 6], [10, 30], [0.1, 0.3]).values()
    assert values["relative_exceedance"] == pytest.approx(8 / 40)
    assert values["control_fraction"] == pytest.approx(40 / 200)
    assert values["effort"] == pytest.approx(0.2)

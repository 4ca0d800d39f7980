"""Settings chosen on half of the flows: which are chosen, and that the scored flows have no say."""

import numpy as np
import pytest

from burstcast.control.choice import FlowSample, choose
from burstcast.control.records import RECORDS, FlowRecords, Span

SPAN = Span(steps=100, integration_steps=100, steps_at_risk=100, steps_per_lyapunov_time=10)


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
    return FlowSample(FlowRecords(**values), SPAN, costs)


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

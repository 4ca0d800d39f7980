"""Differences between runs of control, against resampling by hand."""

import numpy as np
import pytest

from burstcast.control.differences import COMPARED, ComparedRun, paired_differences
from burstcast.control.records import FlowRecords, Span, score_flows
from burstcast.forecasters._names import ForecasterName
from burstcast.statistics.resampling import bootstrap_weights
from burstcast.tables.cells import medians_over_seeds, with_interval

SPAN = Span(steps=40, integration_steps=160, steps_at_risk=50, steps_per_lyapunov_time=4)
FLOWS, RESAMPLES = 30, 200


def records(seed, effect=0.5, row=None):
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
    return score_flows(found, SPAN, RESAMPLES, np.random.default_rng(11))


def run(seed, forecaster="esn", strategy="a", span=SPAN, **options):
    found = records(seed, **options)
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
            spent.append(steps / (len(drawn) * SPAN.integration_steps))
        samples["relative_exceedance"].append(left[0] - left[1])
        samples["control_fraction"].append(spent[0] - spent[1])
    return samples


def test_differences_are_those_of_each_resample():
    pairs = list(paired_differences([run(1), run(2, "equations", effect=0.2)]))
    assert [name for _, _, name, _ in pairs] == list(COMPARED)
    expected = by_hand(records(1), records(2, effect=0.2))
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
    one = records(1)
    more = records(1)
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
    members = [(ForecasterName("esn", 500, "RV", seed), scored(records(seed))) for seed in range(3)]
    other = ForecasterName("equations"), scored(records(9))
    found = medians_over_seeds([members[0], other, *members[1:]])
    assert list(found) == ["median of esn-N500-RV", "equations"]
    for name in COMPARED:
        np.testing.assert_array_equal(
            found["median of esn-N500-RV"][name].samples,
            np.median([scores[name].samples for _, scores in members], axis=0),
        )
    (single,) = medians_over_seeds(members[:1])
    assert single == "esn-N500-RV-seed0"

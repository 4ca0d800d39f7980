"""What the figures show is what they were given."""

import re
import string
import warnings
from itertools import product
from unittest import mock

import numpy as np
import pandas as pd
import pytest
from helpers_figures import (
    ARGUMENTS,
    ENDS,
    EVENT,
    EXAMPLES,
    NO_SIZE,
    PREDICTION_TIMES,
    SCORES,
    SERIES,
    TIME,
    alarm_rows,
    as_published,
    burst,
    control_tables,
    density_rows,
    drawn,
    drawn_texts,
    frontier_rows,
    growing_errors,
    overlapping_texts,
    own_flow,
    percentile_rows,
    plane_event,
    plane_states,
    published_scores,
    ranking_rows,
    reliability_rows,
    return_rows,
    reynolds_rows,
    score_rows,
    search_rows,
    statistics_rows,
)
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text
from sklearn.decomposition import PCA

from burstcast.data.encoders.base import EncodingCase
from burstcast.data.encoders.pod import PodEncoder
from burstcast.figures.control_tradeoff import over_flows
from burstcast.figures.encoder_loss import kept
from burstcast.figures.parts import medians
from burstcast.figures.parts.alarm_scores import alarms_shown, median_networks, times_shown
from burstcast.figures.parts.frame import (
    axis_floor,
    axis_limits,
    observable_label,
    true_and_forecast,
)
from burstcast.figures.parts.looks import (
    controller_lines,
    families,
    forecaster_lines,
    ordered_validations,
    validation,
)
from burstcast.figures.parts.style import drawable_symbol, label_ends, new_figure, render
from burstcast.figures.reliability import FEW_FORECASTS
from burstcast.forecasters._labels import forecaster_label
from burstcast.systems.measured import MeasuredSeries
from kolmogorov_flow import KolmogorovFlow


def lines_with(axes, y):
    """How many lines of a panel have these heights."""
    return sum(
        len(line.get_ydata()) == len(y) and np.allclose(line.get_ydata(), y)
        for line in axes.get_lines()
    )


def texts(figure):
    # the layout takes long, and changes no words but numbers at ticks
    with mock.patch.object(figure, "get_layout_engine", return_value=None):
        return [text.words for text in drawn_texts(figure)]


def scores_of(table, **changes):
    return drawn("classification_scores", percentiles=table, fixed_neurons=500, **changes)


def horizons_of(table, **changes):
    return drawn("horizon_by_size", percentiles=table, **changes)


# -- scores of networks ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sizes", "validations"),
    [
        ((500.0,), ("SSV", "RV")),
        ((500.0, 700.0), ("SSV",)),
        (tuple(500.0 * n for n in range(1, 7)), ("SSV", "RV")),
    ],
)
def test_scores_adapt_to_the_campaign(sizes, validations):
    table = percentile_rows(SCORES, sizes, validations, PREDICTION_TIMES)
    figure = scores_of(table)
    assert len(figure.axes) == 3 * min(len(sizes), 3)
    if len(sizes) > 4:  # of six sizes, the smallest, the largest, and two between them
        labels = figure.axes[8].get_legend_handles_labels()[1]
        assert labels == ["500", "1500", "2000", "3000"]
    assert overlapping_texts(drawn_texts(figure)) == []


def test_scores_say_which_size_they_show_in_place_of_a_missing_one():
    assert "1500 neurons" in texts(drawn("classification_scores", fixed_neurons=2000))
    with pytest.raises(ValueError, match="no value in column neurons"):
        medians.nearest_value(pd.DataFrame({"neurons": [np.nan]}), "neurons", 1)


def test_undefined_medians_leave_a_gap_and_no_zero():
    table = percentile_rows(SCORES, (500.0,), ("RV",), PREDICTION_TIMES)
    table.loc[table["prediction_time_lt"] == 3.0, ["p25", "p50", "p75"]] = np.nan
    assert all(len(line.get_xdata()) == 2 for line in scores_of(table).axes[0].get_lines())


def test_reference_forecasters_are_drawn_beside_the_networks():
    table = percentile_rows(SCORES, (500.0, 1000.0), prediction_times=PREDICTION_TIMES)
    one = table.query("validation == 'RV' and neurons == 500")
    equations = one.assign(forecaster="equations", p50=0.5, **NO_SIZE)
    figure = scores_of(pd.concat([table, equations]))
    assert lines_with(figure.axes[0], [0.5, 0.5, 0.5]) == 1
    assert "equations, true state" in texts(figure)
    horizons = percentile_rows({"mean_horizon_lt": 4.5}, (500.0, 1000.0))
    others = horizons.iloc[:1].assign(forecaster="linear_inverse", p50=1.25, **NO_SIZE)
    figure = horizons_of(pd.concat([horizons, others]))
    assert lines_with(figure.axes[0], [1.25, 1.25]) == 1
    assert "linear inverse model" in texts(figure)


def test_a_single_size_has_no_panel_of_one_tick():
    scores = percentile_rows(SCORES, (500.0,), prediction_times=PREDICTION_TIMES)
    side_by_side = scores_of(pd.concat([scores, scores.assign(forecaster="equations", **NO_SIZE)]))
    assert len({axes.get_position().y0 for axes in side_by_side.axes}) == 1
    assert {"RV", "SSV"} <= set(texts(side_by_side))
    assert "equations, true state" not in texts(side_by_side)  # right throughout
    horizons = percentile_rows({"mean_horizon_lt": 4.5}, (500.0,))
    alone = {"forecaster": "linear_inverse", "p25": 1.25, "p50": 1.25, "p75": 1.25}
    others = horizons.iloc[:1].assign(**alone, **NO_SIZE)
    figure = horizons_of(pd.concat([others, horizons]))
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.get_yticklabels()] == [
        "network, 500 neurons, RV",
        "network, 500 neurons, SSV",
        "linear inverse model",
    ]
    places = [bars.lines[0].get_xdata()[0] for bars in axes.containers]
    assert places == sorted(places, reverse=True)
    one_size = statistics_rows().query("neurons.isna() or neurons == 500")
    assert len(drawn("profile_errors", percentiles=one_size).axes) == 3
    assert len(drawn("long_term_density", percentiles=one_size).axes) == 1
    arguments = published_scores()
    small = {
        name: table.query("neurons == 500")
        for name, table in arguments.items()
        if "neurons" in table
    }
    small.pop("published", None)
    assert len(drawn("published_scores", **small).axes) == 3


def test_other_networks_are_drawn_at_their_sizes():
    """As of networks with true washouts: no size stands for the others."""
    networks = percentile_rows({"mean_horizon_lt": 4.5}, (500.0, 1000.0))
    others = networks[networks["validation"] == "RV"].assign(forecaster="esn_true_washout")
    figure = horizons_of(pd.concat([networks, others.assign(p50=[1.25, 1.75])]))
    lines = {line.get_label(): line.get_xydata().tolist() for line in figure.axes[0].get_lines()}
    assert lines["network, true washout"] == [[500.0, 1.25], [1000.0, 1.75]]
    scores = percentile_rows(SCORES, prediction_times=PREDICTION_TIMES)
    figure = scores_of(pd.concat([scores, scores.assign(forecaster="esn_true_washout", p50=0.25)]))
    assert lines_with(figure.axes[0], [0.25] * len(PREDICTION_TIMES)) == 2


# -- published values ------------------------------------------------------------------------------

HORIZONS = reynolds_rows("mean_horizon_lt")
F_SCORES = reynolds_rows("f_score", PREDICTION_TIMES)
SHOWN = {  # of a figure: its table and the name of that, panels, and rows that are curves there
    "horizon_by_size": ("percentiles", "horizon", [(0, {})]),
    "classification_scores": (
        *("percentiles", "classification"),
        [(3, {"metric": "recall", "neurons": 1000.0})]
        + [(4, {"metric": "recall", "prediction_time_lt": 3.0})]
        + [(5, {"metric": "recall", "neurons": size}) for size in (500.0, 1000.0, 1500.0)],
    ),
    "by_reynolds": (
        *("scores", "classification"),
        [(1, {"prediction_time_lt": 2.0}), (-1, {"reynolds": 400.0}), (-1, {"reynolds": 800.0})],
    ),
}


@pytest.mark.parametrize("name", SHOWN)
def test_medians_lie_beside_the_published_ones_of_our_sizes(name):
    argument, kind, curves = SHOWN[name]
    given = ARGUMENTS[name]()[argument]
    table = given[0] if isinstance(given, list) else given
    theirs = table.assign(**{end: 0.87 * table[end] for end in ("p25", "p50", "p75")})
    everything = pd.concat([theirs, theirs.assign(neurons=3000.0, p50=0.123)])
    published = [as_published(everything, kind), as_published(HORIZONS, "horizon")]
    figure = drawn(name, published=pd.concat(published))
    for panel, chosen in curves:
        shown = medians.select(table, validation="RV", **chosen)["p50"]
        for heights, count in ((shown, 1), (0.87 * shown, 1), (0 * shown + 0.123, 0)):
            assert lines_with(figure.axes[panel], list(heights)) == count
    assert "published" in texts(figure)
    assert overlapping_texts(drawn_texts(figure)) == []
    elsewhere = pd.concat(published).assign(neurons=3000.0)
    assert "published" not in texts(drawn(name, published=elsewhere))


@pytest.mark.parametrize("name", ["long_term_density", "profile_errors"])
def test_published_errors_of_the_training_set_are_on_the_right_edge(name):
    table = statistics_rows()
    theirs = table[table["forecaster"] != "floor"].assign(p25=0.011, p50=0.0123, p75=0.02)
    published = as_published(theirs, "statistics")
    figure = drawn(name, published=published)
    panel = figure.axes[-1]
    assert panel.get_ylim()[1] > 0.0123
    diamonds = [line for line in panel.get_lines() if line.get_marker() == "D"]
    assert [line.get_xydata().tolist() for line in diamonds] == [[[1.0, 0.0123]]]
    assert lines_with(panel, [0.0123] * 3) == 1  # of the networks
    assert "published" in texts(figure)
    elsewhere = published.assign(reynolds=600.0)
    assert "published" not in texts(drawn(name, published=elsewhere))
    assert "published" not in texts(drawn(name, published=None))


def test_published_reductions_are_those_of_networks():
    percentiles = control_tables()["percentiles"]
    without = percentiles[percentiles["metric"] == "exceedance_uncontrolled"]
    shares = {"p25": 0.2, "p50": 0.3, "p75": 0.4}
    left = without.assign(**{name: share * without["p50"] for name, share in shares.items()})
    theirs = as_published(left.assign(metric="exceedance_probability"), "control")
    figure = drawn("control_tradeoff", published=theirs)
    opened = [line for line in figure.axes[0].get_lines() if line.get_gid() == "published"]
    values = [line.get_xdata()[0] for line in opened]
    assert values == pytest.approx([1 - 0.3 / 1.02] * 3)
    assert "published" in texts(figure)
    assert "published" not in texts(drawn("control_tradeoff"))


# -- the search, and the growth of errors ----------------------------------------------------------


def test_the_search_shows_the_best_objective_of_each_point_and_marks_the_least():
    axes = drawn("hyperparameter_search").axes[0]
    grid, bayesian = [shown for shown in axes.collections if isinstance(shown, PathCollection)]
    assert len(grid.get_offsets()) == 9
    assert bayesian.get_offsets().tolist() == [[0.3, 2.0], [0.5, 3.0]]
    assert float(np.min(bayesian.get_array())) == -4.0
    assert [line.get_xydata().tolist() for line in axes.get_lines()] == [[[0.3, 2.0]]]
    line = search_rows().query("spectral_radius == 0.3")
    assert drawn("hyperparameter_search", trace=line).axes  # of one spectral radius: no shades


def test_errors_grow_as_they_do_and_forecasts_are_valid_until_they_are_too_large():
    figure = drawn("error_growth")
    error, valid = figure.axes
    assert [text.get_text() for text in valid.texts] == [
        f"{size} neurons" for size in (500, 1000, 2000, 4000)
    ]
    time_lt = 0.5 * np.arange(1, 9)
    truth = growing_errors()["truth"]
    unrelated = np.median(np.abs(truth - np.roll(truth, 100, axis=0)))
    assert lines_with(error, list(1.1 * 10 / 2000 * np.exp(time_lt) / unrelated)) == 1
    # errors of all starting points are the same: all are valid, or none
    for size in (500, 1000, 2000, 4000):
        assert lines_with(valid, list(1.1 * 10 / size * np.exp(time_lt) <= 0.2)) == 1


# -- Reynolds numbers ------------------------------------------------------------------------------


def by_reynolds(horizons, scores, **changes):
    changes = {"prediction_times_lt": [2.0], **changes}
    return drawn("by_reynolds", horizons=[horizons], scores=[scores], **changes)


def test_by_reynolds_needs_the_size_and_shows_published_values_beside_ours_alone():
    with pytest.raises(ValueError, match="no network of 500 neurons"):
        drawn("by_reynolds", neurons=500)
    ours = [table.query("reynolds != 600") for table in (HORIZONS, F_SCORES)]
    kinds = {"horizon": HORIZONS, "classification": F_SCORES}
    theirs = [as_published(table.query("reynolds == 600"), kind) for kind, table in kinds.items()]
    assert "published" not in texts(by_reynolds(*ours, published=pd.concat(theirs)))


def test_by_reynolds_draws_a_single_reynolds_number():
    for strategies in (["RV"], ["SSV", "RV"]):
        one = f"validation in {strategies} and reynolds == 400"
        figure = by_reynolds(*(table.query(one) for table in (HORIZONS, F_SCORES)))
        assert len(figure.axes) == 2 + len(strategies)
        assert overlapping_texts(drawn_texts(figure)) == []


def test_f_scores_at_each_reynolds_number_in_its_order():
    # names that sort otherwise, and one case that was not asked so far ahead
    names = {"Re400": "zeta", "Re600": "Alpha", "Re1000": "Re1000", "Re800": "Re0800"}
    scores = F_SCORES.assign(case=F_SCORES["case"].map(names)).sort_values("case", kind="stable")
    scores = scores[(scores["reynolds"] != 600) | (scores["prediction_time_lt"] < 3)]
    figure = by_reynolds(HORIZONS, scores, prediction_times_lt=[2.0, 3.0])
    panel = figure.axes[-1]
    assert panel.get_title() == "RV"
    _, labels = panel.get_legend_handles_labels()
    assert labels == ["400", "600", "800", "1000"]
    for reynolds in (400.0, 600.0, 800.0, 1000.0):
        chosen = medians.select(scores, validation="RV", reynolds=reynolds)
        assert len(chosen) == (2 if reynolds == 600 else 3)
        assert lines_with(panel, list(chosen["p50"])) == 1
    assert "published" not in texts(figure)


# -- probabilities ---------------------------------------------------------------------------------


def test_networks_that_differ_by_seeds_are_medians_of_scores_and_ends():
    rows = alarm_rows("prediction_time_lt", (1.0, 2.0))
    shown = median_networks(rows, "prediction_time_lt")
    for kind in ("esn", "equations"):
        expected, found = (
            table.query(f"forecaster == '{kind}' and prediction_time_lt == 2")[ENDS]
            for table in (rows, shown)
        )
        np.testing.assert_allclose(found.to_numpy(), [expected.median().to_numpy()])


def test_alarms_of_one_size_and_strategy_and_of_everybody_else_are_shown():
    rows = alarm_rows("prediction_time_lt", (1.0,))
    networks = rows["neurons"].notna()
    small, other = rows[networks].assign(neurons=500.0), rows[networks].assign(validation="SSV")
    pd.testing.assert_frame_equal(alarms_shown(pd.concat([rows, small, other]), 1900, "RV"), rows)
    pd.testing.assert_frame_equal(alarms_shown(rows, 1900, "WFV"), rows)
    # a single seed has no committee
    pd.testing.assert_frame_equal(alarms_shown(rows[~networks], 2000, "RV"), rows[~networks])


def test_prediction_times_that_are_not_in_the_table_are_not_shown():
    table = pd.DataFrame({"prediction_time_lt": [1.0, 2.0]})
    assert times_shown(table, [2.0, 3.0]) == [2.0]
    assert times_shown(table, [3.0]) == [2.0]


def test_published_scores_lie_beside_ours_with_intervals_of_a_network():
    figure = drawn("published_scores")
    words = set(texts(figure))
    # of 500, 1000 and 1500 neurons, those that double, and 500 with squares
    assert {"500 neurons", "1000 neurons", "500 neurons, quadratic", "published"} <= words
    assert "1500 neurons" not in words
    arguments = published_scores()
    for axes, metric in zip(figure.axes, ("precision", "recall", "f_score"), strict=False):
        ours = arguments["scores"]
        for kind, neurons in (("esn", 500.0), ("esn", 1000.0), ("esn_quadratic", 500.0)):
            of = {"forecaster": kind, "neurons": neurons, "metric": metric, "validation": "RV"}
            medians_of = list(medians.select(ours, **of)["p50"])
            assert lines_with(axes, medians_of) == 1
        assert (
            lines_with(axes, [0.5] * len(PREDICTION_TIMES)) == 2
        )  # nothing is published of squares
    (band,) = figure.axes[3].collections[0].get_paths()
    low, high = band.vertices[:, 1].min(), band.vertices[:, 1].max()
    reached = arguments["horizons"].query("validation == 'RV'")["p50"]
    assert (low, high) == pytest.approx((0.9 * reached.min(), 1.02 * reached.max()))


def test_the_six_most_skilful_forecasters_have_curves():
    scores = score_rows("alarm_f_score", "brier_skill")
    votes = scores.assign(probability="votes", value=scores["value"] / 2)
    new = scores[scores["forecaster"] == "analogues"].assign(forecaster="lstm", value=0.97)
    everything = pd.concat([scores, votes, new])
    figure = drawn("forecast_skill", scores=everything)
    assert [len(axes.get_lines()) for axes in figure.axes] == [6, 6]
    calibrated = everything.query("probability == 'calibrated'")
    means = calibrated.query("metric == 'brier_skill'").groupby("forecaster")["value"].mean()
    left_out = ["equations", "climatology", "persistence", "observable_now"]
    means = means.drop(left_out, errors="ignore")
    best = means.sort_values(ascending=False).index[:6]
    assert "lstm" in best
    for kind in best:
        rows = calibrated.query("metric == 'alarm_f_score' and forecaster == @kind")
        values = rows.groupby("prediction_time_lt")["value"].median()
        assert lines_with(figure.axes[0], list(values)) >= 1
        assert forecaster_label(kind) in texts(figure)
    assert forecaster_label("equations") not in texts(figure)  # always right
    baselines = everything[everything["forecaster"].isin(["climatology", "persistence"])]
    assert "climatology" in texts(drawn("forecast_skill", scores=baselines))


def test_a_new_kind_of_forecaster_looks_like_no_other():
    kinds = ["equations_noisy", "persistence", "lstm", "transformer"]
    lines = forecaster_lines(kinds)
    assert list(lines) == kinds
    assert len({(str(line["color"]), str(line["linestyle"])) for line in lines.values()}) == 4
    controllers = controller_lines([*kinds, "esn", "random"])
    assert len({(line["color"], line["marker"]) for line in controllers.values()}) == 6
    assert families(kinds) == [
        ("equations", ["equations_noisy"]),
        ("other forecasters", ["lstm", "transformer"]),
        ("without a forecast", ["persistence"]),
    ]


def test_reliability_is_drawn_of_forecasters_with_many_probabilities():
    rows = reliability_rows()
    (diagram,) = drawn("reliability").axes
    mean = np.linspace(0, 1, 11)
    assert lines_with(diagram, (0.95 * mean).tolist()) == 1
    assert lines_with(diagram, (0.9 * mean).tolist()) == 1
    assert "forecasts, 40 to 7000, log" in texts(drawn("reliability"))
    without = rows[rows["forecaster"] != "esn_committee"]
    two = pd.concat([without, without[:1].assign(forecaster="esn", neurons=2000.0)])
    assert len(drawn("reliability", bins=two).axes) == 9


def test_precision_and_recall_are_of_alarms_from_a_probability_on():
    shown = reliability_rows().query("forecaster in ['esn_committee', 'equations', 'climatology']")
    figure = drawn("precision_recall", bins=shown)
    (axes,) = figure.axes
    line = next(one for one in axes.get_lines() if one.get_label() == "committee of networks")
    # alarms from 0.9 on: 40 at 1 and 40 at 0.9, of which 95 % and 85.5 % are right
    recall, precision = line.get_xydata().T
    frequencies = 0.95 * np.linspace(0, 1, 11)
    hits = np.cumsum(40 * frequencies[::-1])
    np.testing.assert_allclose(precision[1:3], [0.95, (0.95 + 0.855) / 2])
    np.testing.assert_allclose(recall[1:11], hits[:10] / hits[9])
    assert recall[0] == 0
    assert not {"climatology", "equations, true state"} & set(texts(figure))
    of_none = reliability_rows().query("forecaster == 'climatology'")
    assert "can be wrong" in " ".join(texts(drawn("precision_recall", bins=of_none)))


def test_bins_of_few_forecasts_are_not_joined():
    keys = {"case": "Re400", "forecaster": "quadratic", "neurons": np.nan, "validation": None}
    keys |= {"probability": "calibrated", "prediction_time_lt": 3.0}
    bins = pd.DataFrame(
        {
            **{**keys, "bin": range(4), "consistency_low": 0.0, "consistency_high": 1.0},
            "forecasts": [100, FEW_FORECASTS - 1, FEW_FORECASTS, 50],
            "mean_probability": [0.0, 0.3, 0.6, 1.0],
            "observed_frequency": [0.0, 1.0, 0.5, 1.0],
        }
    )
    lines = drawn("reliability", bins=bins).axes[0].lines
    lines = [line for line in lines if line.get_marker() == "o"]
    shown = {line.get_linestyle(): line.get_xdata().tolist() for line in lines}
    assert (shown["-"], shown["None"]) == ([0.0, 0.6, 1.0], [0.3])


# -- control ---------------------------------------------------------------------------------------


def test_bars_of_control_are_intervals_over_flows():
    quartiles, papers = (
        table.query("forecaster == 'random' and prediction_time_lt == 1")
        for table in control_tables().values()
    )
    ends = {
        "relative_exceedance": [(0.86, 1.28), (1.02, 1.5), (0.91, 1.37)],
        "control_fraction": [(0.07, 0.11), (0.08, 0.1), (0.08, 0.12)],
    }
    strategies = pd.concat(
        papers[papers["metric"] == metric].assign(seed=seed, low=low, high=high)
        for metric, pairs in ends.items()
        for seed, (low, high) in enumerate(pairs)
    )
    late = strategies.assign(delay_lt=1.0, low=9.0, high=9.9)  # another strategy than the paper's
    all_strategies = pd.concat([strategies, late])
    intervals = over_flows(quartiles, all_strategies).set_index("metric")
    bounds = intervals[["p25", "p75"]]
    assert bounds.loc["reduction"].tolist() == pytest.approx([1 - 1.37, 1 - 0.91])
    assert bounds.loc["control_fraction"].tolist() == [0.08, 0.11]
    assert intervals["p50"].tolist() == quartiles["p50"].tolist()
    shown = quartiles.assign(p50=-0.1)
    figure = drawn("control_tradeoff", percentiles=shown, strategies=all_strategies)
    # the bar holds zero, which quartiles of three networks exclude
    bars = figure.axes[0].collections[0].get_segments()[0]
    assert bars[0, 0] < 0 < bars[1, 0]


def curve_of(axes, label):
    """Points of a curve with bars: positions and values, ``(2, points)``."""
    (bars,) = (bars for bars in axes.containers if bars.get_label() == label)
    return np.transpose(bars.lines[0].get_xydata())


def test_the_frontier_shows_what_is_left_against_what_was_spent():
    figure = drawn("control_frontier")
    rules, frontier = figure.axes
    names = ("reactive", "the paper's strategy, network", "receding horizon, network")
    committee = "receding horizon, committee of networks"
    assert {*names, committee, "interval over flows", "other settings"} <= set(texts(figure))
    # the run that leaves nothing and acts least betters all others; a small marker is any run
    assert curve_of(frontier, names[2]).tolist() == [pytest.approx([0.033]), [0.0]]
    assert curve_of(frontier, committee).tolist() == [pytest.approx([0.025]), [0.0]]
    assert lines_with(frontier, [4e-2, 4e-2, 2e-3, 2e-3, 0.0, 0.0]) == 1
    # rules have a panel of their own, and no run of theirs betters another
    np.testing.assert_allclose(curve_of(rules, "reactive"), [[0.24, 0.5], [0.06, 0.01]])
    # nothing left has a place on the axis, and no bar
    low, high = frontier.get_ylim()
    assert low < 0 < high
    (bars,) = (each for each in frontier.containers if each.get_label() == committee)
    (segment,) = bars.lines[2][0].get_segments()
    assert np.ptp(segment[:, 1]) == 0
    assert "0: no event observed" in texts(figure)


def test_return_levels_stand_against_return_periods_and_bounds_where_nothing_was_seen():
    figure = drawn("return_levels")
    usual, late = figure.axes
    free = [[20.0, 200.0, 2000.0], [0.1, 0.2, 0.3]]
    for axes in (usual, late):
        np.testing.assert_allclose(curve_of(axes, "no control"), free)
    # of two horizons the one under which events are rarer; its highest level was not seen
    label = next(name for name in texts(figure) if name.startswith("receding horizon"))
    np.testing.assert_allclose(curve_of(usual, label), [[9e3, 9e4], [0.1, 0.2]])
    assert any(name.endswith("1 LT late") for name in texts(figure))
    bounds = [line for line in usual.lines if line.get_markerfacecolor() == "white"]
    positions = [line.get_xydata().tolist() for line in bounds]
    assert [[pytest.approx(1e5 / 3), 0.3]] in positions
    assert usual.get_xscale() == "log"
    of_free = return_rows().query("strategy == 'uncontrolled'")
    assert len(drawn("return_levels", times=of_free).axes) == 1


def test_of_many_forecasters_those_with_most_runs_are_shown():
    table, receding = frontier_rows(), "strategy == 'receding_horizon' and horizon_lt == 3"
    few = table.query(f"forecaster == 'equations' and {receding}")
    others = [few.assign(forecaster=f"kind{number}") for number in range(3)]
    for axes in drawn("control_frontier", scores=pd.concat([table, *others])).axes:
        labels = [bars.get_label() for bars in axes.containers]
        assert len(labels) <= 4
        assert "receding horizon, kind2" not in labels


def test_the_frontier_of_strategies_that_act_as_often_has_ticks():
    table = frontier_rows()
    spent = table["metric"] == "control_fraction"
    narrow = 0.03 + 0.1 * table.loc[spent, ["value", "low", "high"]]
    table.loc[spent, ["value", "low", "high"]] = narrow.clip(upper=0.045)
    axes = drawn("control_frontier", scores=table).axes[0]
    low, high = axes.get_xlim()
    assert sum(low <= tick <= high for tick in axes.get_xticks()) >= 2


def test_the_frontier_leaves_out_other_spans_starts_spells_of_quiet_and_networks():
    table = frontier_rows()
    others = [
        table.assign(**{name: value, "value": 0.123}).head(6)
        for name, value in (
            *(("starts", "unselected"), ("span_lt", 200.0), ("quiet_lt", 0.0)),
            *(("neurons", 500), ("validation", "SSV"), ("forecaster", "random")),
        )
    ]
    more = drawn("control_frontier", scores=pd.concat([table, *others]))
    assert render(more, "png") == render(drawn("control_frontier"), "png")


def test_the_frontier_tells_apart_what_is_observed():
    table = frontier_rows()
    seen = table.assign(observed=None), table.assign(observed="modes_4", value=0.5 * table["value"])
    shown = texts(drawn("control_frontier", scores=pd.concat(seen)))
    assert {"reactive", "reactive, observed modes 4"} <= set(shown)


def test_the_frontier_is_of_the_usual_conditions():
    table = frontier_rows()
    simple = table.query("delay_lt == 0 and strength == 1 and noise == 0.01")
    assert overlapping_texts(drawn_texts(drawn("control_frontier", scores=simple))) == []
    late = drawn("control_frontier", scores=table.query("delay_lt == 1"))
    assert "Without control no event" in " ".join(texts(late))
    alone = drawn("control_frontier", scores=simple.query("strategy == 'reactive'"))
    assert len(alone.axes) == 1


# -- observables -----------------------------------------------------------------------------------


def test_events_are_shaded_where_the_signal_exceeds_the_threshold():
    peaks = (2.0, 6.0)
    observable = np.maximum(*(burst(TIME, peak) for peak in peaks))
    panel = drawn("observable_and_density", observable=observable[np.newaxis]).axes[0]
    above = TIME[observable >= SERIES["threshold"]]
    for patch, (low, high) in zip(panel.patches, ((0, 4), (4, 8)), strict=True):
        inside = panel.transData.inverted().transform(patch.get_extents())
        event = above[(low < above) & (above < high)]
        assert inside[:, 0] == pytest.approx([event[0], event[-1]], abs=1e-6)


SUNK = burst(TIME, 4.0) - 0.3
SUNK_FORECAST = np.where(TIME >= 1.5, SUNK - 0.02, np.nan)
CURVES = ("truth", "forecast", "uncontrolled", "controlled", "true", "observable")


def sunk(values):
    """Arguments with all observables 0.3 lower."""
    return {
        name: sunk(value)
        if isinstance(value, dict)
        else value - 0.3
        if name.endswith(CURVES)
        else value
        for name, value in values.items()
    }


@pytest.mark.parametrize(
    "name",
    [
        *("validation_strategies", "prediction_schematic", "control_schematic"),
        *("horizon_evaluations", "prediction_examples", "observable_and_density"),
    ],
)
def test_negative_observables_are_not_cut_off(name):
    arguments = sunk(ARGUMENTS[name]()) | {"threshold": -0.1}
    if name == "observable_and_density":
        arguments["density"] = {"bins": 40, "range": None}
    panels = drawn(name, **arguments).axes
    whole = {221, len(TIME)}
    shown = [
        (panel, y)
        for panel in panels
        for line in panel.get_lines()
        if (y := np.asarray(line.get_ydata(), dtype=float)).size in whole
    ]
    assert shown
    for panel, y in shown:
        low, high = panel.get_ylim()
        assert low <= np.nanmin(y)
        assert np.nanmax(y) <= high or name == "horizon_evaluations"
        assert high - low < 1.0  # nor is room given away


def test_observables_that_are_never_negative_are_drawn_from_zero():
    assert axis_floor(burst(TIME, 4.0)) == 0.0
    # unless they never come near it
    assert 2.9 < axis_floor(3.0 + burst(TIME, 4.0)) < 3.02
    assert axis_floor(SUNK, SUNK_FORECAST) < np.nanmin(SUNK_FORECAST) < 0.0


def test_an_axis_has_room_for_the_name_of_the_threshold():
    curve = np.array([2.0, 3.0])
    floor, top = axis_limits(2.99, curve)
    assert floor == pytest.approx(1.94)
    assert top > 2.99 + 0.19 * (3.0 - floor)
    assert axis_limits(2.1, curve)[1] == pytest.approx(3.0 + 0.06 * 1.06)


@pytest.mark.parametrize(
    ("symbol", "name", "label"),
    [
        ("lynx", "Lynx", "$lynx$"),
        (r"\mathrm{n1}", "N1", r"$\mathrm{n1}$"),
        (r"\mathrm{a\_b}", "a_b", r"$\mathrm{a\_b}$"),
        ("k", "kinetic energy", "Kinetic energy, $k$"),
    ],
)
def test_an_axis_says_a_name_once(symbol, name, label):
    assert observable_label(symbol, name) == label


DENSITIES = density_rows().filter(like="density").columns
NOTHING = {
    "prediction_examples": {"examples": {**EXAMPLES, "outcome": np.array([])}},
    "prediction_schematic": {"examples": {**EXAMPLES, "outcome": np.array([])}},
    "horizon_evaluations": {"examples": {**EXAMPLES, "evaluation_lead_time_lt": np.array([])}},
    "midplane_planes": {"event": {"mark": np.array([])}},
    "vorticity_isosurfaces": {"event": {"mark": np.array([])}},
    "control_schematic": {"event": {"mark": np.array([])}},
    "suppressed_event": {"event": {"mark": np.array([])}},
    "burst_forecast": {"event": {"time_lt": np.array([])}},
    "control_density": {"densities": [density_rows().assign(**dict.fromkeys(DENSITIES, np.nan))]},
    "control_frontier": {"scores": frontier_rows().assign(value=np.nan)},
    "control_tradeoff": {"percentiles": control_tables()["percentiles"].assign(p50=np.nan)},
}


@pytest.mark.parametrize("name", NOTHING)
def test_a_figure_of_what_did_not_occur_says_so(name):
    (reason,) = texts(drawn(name, **NOTHING[name]))
    assert re.match("No |Without control no event occurred", reason)


def test_strategies_come_in_the_papers_order():
    assert ordered_validations(["RV", "other", "SSV"]) == ["SSV", "RV", "other"]


def test_the_network_schematic_prints_the_numbers_in_use():
    shown = " ".join(texts(drawn("network_schematic")))
    for number in ("N_r = 2000", "N_u = 9", "0.29", "0.33", "0.1"):
        assert number in shown


# -- bands and bars --------------------------------------------------------------------------------


def test_quartiles_of_one_network_are_no_band_and_two_sizes_are_no_line():
    rows = pd.DataFrame({"neurons": [100.0, 200.0, 300.0], "p50": [0.5, 0.6, 0.7]})
    for count, spread, entries, joined in (
        (3, 0.1, 1, True),
        (3, 0.0, 0, True),
        (2, 0.1, 1, False),
    ):
        axes = Figure().subplots()
        quartiles = rows.assign(p25=rows["p50"] - spread, p75=rows["p50"] + spread)
        medians.draw(axes, quartiles.iloc[:count], "neurons", validation("RV"))
        assert len(medians.spread_handles([axes])) == entries
        assert lines_with(axes, [0.5, 0.6, 0.7][:count]) == 1
        assert (axes.lines[0].get_linestyle() != "None") is joined


def test_errors_beside_each_other_have_axes_of_one_kind():
    table = statistics_rows()
    of_u = (table["metric"] == "nrmse_u") & (table["forecaster"] == "floor")
    far = table.assign(p25=table["p25"].where(~of_u, 1e-6), p50=table["p50"].where(~of_u, 1e-6))
    for shown, scale in ((table, "linear"), (far, "log")):
        panels = drawn("profile_errors", percentiles=shown).axes[3:]
        assert [panel.get_yscale() for panel in panels] == [scale] * 3


def test_labels_at_the_ends_of_curves_lie_at_their_heights_and_not_on_each_other():
    figure = new_figure(3.4, 2.4)
    axes = figure.subplots()
    for label, end in (("low", 0.2), ("high", 0.9), ("higher", 0.91), ("ends sooner", np.nan)):
        axes.plot([0, 1, 2], [0.0, 0.5, end], label=label)
    axes.set_ylim(0, 1)
    label_ends(figure, [axes])
    heights = {text.get_text(): text.xy[1] for text in axes.texts}
    assert heights["low"] == pytest.approx(0.2)
    assert heights["ends sooner"] == pytest.approx(0.5)
    assert heights["high"] < 0.9 < 0.91 < heights["higher"]
    assert overlapping_texts(drawn_texts(figure)) == []


# -- the networks' own flow ------------------------------------------------------------------------


def test_ticks_of_a_narrow_range_can_be_told_apart():
    arguments = own_flow(rate=1e-5, spectrum=False)
    shares = arguments["curves"]["survival"]
    ends = {"survival_low": shares, "survival_high": shares}
    networks = arguments["curve_percentiles"].query("forecaster == 'esn' and neurons == 1000")
    networks = networks.assign(**dict.fromkeys(("p25", "p50", "p75"), np.repeat(shares, 2).array))
    curves = arguments["curves"].assign(**ends)
    figure = drawn("own_flow", **{**arguments, "curves": curves, "curve_percentiles": networks})
    figure.canvas.draw()
    axes = figure.axes[0]
    low, high = axes.get_ylim()
    assert low > 0.95
    ticks = (*axes.yaxis.get_major_ticks(), *axes.yaxis.get_minor_ticks())
    shown = [tick.label1.get_text() for tick in ticks if low <= tick.get_loc() <= high]
    assert len(shown) > 2
    assert len(set(shown)) == len(shown)


def test_spectra_are_drawn_where_they_were_computed():
    assert len(drawn("own_flow", **own_flow(spectrum=False)).axes) == 2
    exponents = drawn("own_flow").axes[2]
    data = exponents.containers[0].lines[0]
    assert data.get_ydata().tolist() == own_flow()["exponents"][0]["lyapunov_exponent"].tolist()
    # the tenth exponent is far below those of the flow: an arrow, with its median
    median = medians.select(own_flow()["exponent_percentiles"][0], number=10, neurons=1000)["p50"]
    assert [text.get_text() for text in exponents.texts] == [f"${median.item():.2g}$"]


# -- flows -----------------------------------------------------------------------------------------


def test_isosurfaces_are_closed_and_lie_where_the_vorticity_has_their_level():
    figure = drawn("vorticity_isosurfaces")
    boxes = [axes for axes in figure.axes if axes.name == "3d"]
    assert len(boxes) == 2
    surface = [c for c in boxes[0].collections if hasattr(c, "_faces")][-1]
    corners = np.asarray(surface._faces).reshape(-1, 3)[:, [0, 2, 1]]
    low, high = corners.min(axis=0), corners.max(axis=0)
    assert (low >= [0, -1, 0]).all()
    assert (high <= [4 * np.pi, 1, 2 * np.pi]).all()
    still = {**EVENT, "true_state": 0 * EVENT["true_state"] + 1e-12 * np.eye(9)[0]}
    assert drawn("vorticity_isosurfaces", event=still).axes  # no surface: an empty box


def test_all_modes_hold_all_and_few_leading_ones_what_their_coefficients_say():
    """Modes, shares and decoded observables by scikit-learn's PCA."""
    flow = KolmogorovFlow(40.0, 1, 2)
    states = np.random.default_rng(2).normal(0.1, 1.0, (1, 400, flow.dimension))
    states *= np.linspace(2.0, 0.5, flow.dimension)
    case = EncodingCase(flow, {"modes": flow.dimension, "symmetrised": False})
    encoder, numbers = PodEncoder.fit(states, case), np.array([1, 5, flow.dimension])
    shares = kept(encoder, flow, states[0].T, numbers)
    assert [shares[name][-1] for name in shares] == pytest.approx([1.0, 1.0, 1.0])
    variance = np.cumsum(PCA().fit(states[0]).explained_variance_ratio_)
    np.testing.assert_allclose(shares["variance"], variance[numbers - 1])
    true = flow.observable(states[0].T)
    for place, number in enumerate(numbers):
        few = PCA(number).fit(states[0])
        decoded = flow.observable(few.inverse_transform(few.transform(states[0])).T)
        assert shares["mean"][place] == pytest.approx(decoded.mean() / true.mean())
        correlation = np.corrcoef(decoded, true)[0, 1]
        assert shares["correlation"][place] == pytest.approx(correlation)


def fields_of(figure):
    fields = [axes for axes in figure.axes if axes.images]
    assert len({axes.images[0].get_clim() for axes in fields}) == 1
    return fields


def test_burst_vorticity_has_one_scale_and_shows_the_strongest_peak_of_the_test_series():
    fields = fields_of(drawn("burst_vorticity"))
    low, high = fields[0].images[0].get_clim()
    assert low == -high
    assert high == pytest.approx(max(np.abs(axes.images[0].get_array()).max() for axes in fields))
    titles = [axes.get_title(loc="right") for axes in fields]
    assert titles == ["$-2.0$ LT", "$-1.0$ LT", "$-0.5$ LT", "peak", "$+1.0$ LT"]
    flow = KolmogorovFlow(largest_wavenumber=3, forcing_wavenumber=2)
    corner = flow.vorticity(plane_states()["states"][1, 60], np.zeros((1, 2)))[0]
    assert fields[3].images[0].get_array()[0, 0] == pytest.approx(corner)


def test_burst_forecast_decodes_channels_and_finds_the_true_state_in_its_series():
    fields = fields_of(drawn("burst_forecast"))
    titles = [axes.get_title(loc="right") for axes in fields]
    assert titles == 2 * ["$-0.1$ LT", "$+0.3$ LT", "$+0.7$ LT", "$+1.1$ LT"]
    true, forecast = np.split(np.array([axes.images[0].get_array() for axes in fields]), 2)
    np.testing.assert_allclose(forecast, 0.75 * true, atol=1e-12)
    flow = KolmogorovFlow(largest_wavenumber=3, forcing_wavenumber=2)
    corner = flow.vorticity(plane_event()["states"][1, 54], np.zeros((1, 2)))[0]
    assert true[0, 0, 0] == pytest.approx(corner)


def test_lost_skill_draws_onsets_of_committees_and_says_each_alarm_once():
    equations, others = drawn("lost_skill").axes
    labels = [[bars.get_label() for bars in axes.containers] for axes in (equations, others)]
    assert labels[0] == ["sensors: filtered"]  # the true state is right throughout
    assert [" ".join(label.split()) for label in labels[1]] == [
        "published precursor",
        "invariants: committee of networks, 50 neurons",
        "invariants: network, 90 neurons",
        "observable now",
    ]
    # the third forecaster of the table, of onsets alone
    line = equations.containers[0].lines[0]
    np.testing.assert_allclose(line.get_xdata(), [0.5, 1, 2])
    np.testing.assert_allclose(line.get_ydata(), 0.9 * np.exp(-0.3 * np.array([0.5, 1, 2]) - 0.4))


def test_lost_skill_shows_each_kind_at_its_best_and_six_curves_in_a_panel():
    table = ranking_rows()
    now = table[(table["alarm"] == "observable_now") & (table["case"] == "flow")]
    more = [
        now.assign(alarm=f"kind{number}", forecaster=f"kind{number}", case=case)
        for number, case in product(range(2), ("flow", "sensors"))
    ]
    more[0]["value"] += 0.01  # the first is better in the flow
    figure = drawn("lost_skill", tables=[table, *more])
    assert [len(axes.containers) for axes in figure.axes] == [1, 6]
    assert "flow: kind0" in texts(figure)
    assert "sensors: kind0" not in texts(figure)


# -- names of users --------------------------------------------------------------------------------

NAMES = [*string.punctuation, "θ", "ß", "a&b", "T_2m_°C", "price [$/MWh]", "50$ and 60$_x", "x_1"]
WITH_SYMBOLS = [name for name, make in ARGUMENTS.items() if "symbol" in make()]


@pytest.mark.parametrize("name", WITH_SYMBOLS)
def test_symbols_and_names_of_users_are_drawn(name):
    named = {"observable_name": "50$ and 60$_x"} if "observable_name" in ARGUMENTS[name]() else {}
    for text in drawn(name, symbol="x_1", **named).findobj(Text):
        MathTextParser("path").parse(text.get_text())


@pytest.mark.parametrize("column", NAMES)
def test_columns_of_any_name_are_formulas(column):
    """Columns of weather stations are called "%"."""
    space = MeasuredSeries([column], column)
    symbol = drawable_symbol(space.observable_symbol)
    texts = [observable_label(symbol, space.observable_name), *true_and_forecast(symbol)]
    for text in (*texts, rf"$\overline{{{symbol}}} > {symbol}_e$"):
        MathTextParser("path").parse(text)
    assert column.isidentifier() or r"\mathrm{observable}" in texts[0]


@pytest.mark.parametrize(
    ("symbol", "drawable"), [("k", "k"), ("x_1", "{x_1}"), ("%", r"\mathrm{observable}")]
)
def test_symbols_of_systems_are_formulas(symbol, drawable):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        assert drawable_symbol(symbol) == drawable
    assert len(told) == (symbol == "%")


def test_characters_that_the_font_lacks_are_told_once():
    with pytest.warns(UserWarning, match="the font of figures has no 度, 温, and") as told:
        render(drawn("observable_and_density", symbol="x", observable_name="温度"), "png")
    assert len(told) == 1

"""What the figures show is what they were given."""

import numpy as np
import pandas as pd
import pytest
from gallery_figures import (
    DENSITY,
    EDGES,
    GALLERY,
    PREDICTION_TIMES,
    SCORES,
    TIME,
    USUAL,
    X,
    Y,
    Z,
    alarm_rows,
    control_rows,
    frontier_rows,
    reliability_rows,
    reynolds_rows,
    score_rows,
    statistics_rows,
)
from helpers_figures import (
    THRESHOLD,
    burst,
    drawn_texts,
    interval_rows,
    overlapping_texts,
    percentile_rows,
)
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from sklearn.decomposition import PCA

from burstcast.encoders.base import EncodingCase
from burstcast.encoders.pod import PodEncoder
from burstcast.figures.burst_forecast import draw as burst_forecast
from burstcast.figures.by_reynolds import by_reynolds
from burstcast.figures.classification_scores import classification_scores
from burstcast.figures.control_conditions import control_conditions
from burstcast.figures.control_density import ControlledDensity, control_density
from burstcast.figures.control_frontier import control_frontier
from burstcast.figures.control_schematic import control_schematic
from burstcast.figures.control_tradeoff import control_tradeoff
from burstcast.figures.encoder_loss import kept
from burstcast.figures.forecast_skill import draw as forecast_skill
from burstcast.figures.horizon_by_size import horizon_by_size
from burstcast.figures.horizon_evaluations import HorizonEvaluation, horizon_evaluations
from burstcast.figures.long_term_density import long_term_density
from burstcast.figures.observable_and_density import observable_and_density
from burstcast.figures.parts.alarm_scores import alarms_shown, median_network, times_shown
from burstcast.figures.parts.observable_axis import axis_floor, axis_limits
from burstcast.figures.parts.percentile_curves import (
    draw_percentiles,
    draw_single_intervals,
    nearest_value,
    select,
    spread_handles,
)
from burstcast.figures.parts.style import (
    BLUE,
    columns_that_fit,
    ordered_validations,
    render,
    true_runs,
    validation_style,
)
from burstcast.figures.prediction_examples import PredictionExample, prediction_examples
from burstcast.figures.prediction_schematic import prediction_schematic
from burstcast.figures.profile_errors import profile_errors
from burstcast.figures.reliability import draw as reliability
from burstcast.figures.validation_strategies import ValidationLayout, validation_strategies
from burstcast.figures.vorticity_isosurfaces import FlowSnapshot, vorticity_isosurfaces
from burstcast.forecasters._labels import forecaster_label
from burstcast.systems.kolmogorov import KolmogorovFlow


def lines_with(axes: Axes, y: list[float]) -> int:
    """How many lines of a panel have these heights."""
    return sum(
        len(line.get_ydata()) == len(y) and np.allclose(line.get_ydata(), y)
        for line in axes.get_lines()
    )


def texts(figure: Figure) -> list[str]:
    return [text.words for text in drawn_texts(figure)]


@pytest.mark.parametrize(
    ("sizes", "validations"),
    [
        ((500.0,), ("SSV", "RV")),
        ((500.0, 700.0), ("SSV",)),
        (tuple(500.0 * n for n in range(1, 7)), ("SSV", "RV")),
    ],
)
def test_scores_adapt_to_the_campaign(
    sizes: tuple[float, ...], validations: tuple[str, ...]
) -> None:
    table = percentile_rows(
        SCORES, sizes=sizes, validations=validations, prediction_times=PREDICTION_TIMES
    )
    figure = classification_scores(table, 500, 3)
    assert len(figure.axes) == (9 if len(sizes) > 1 else 3)
    by_time = figure.axes[0]
    for validation in validations:
        chosen = select(table, metric="precision", validation=validation, neurons=500.0)
        assert lines_with(by_time, list(chosen["p50"])) == 1
    assert overlapping_texts(drawn_texts(figure)) == []


def test_scores_say_which_size_they_show_in_place_of_a_missing_one() -> None:
    table = percentile_rows(SCORES, prediction_times=PREDICTION_TIMES)
    assert "1500 neurons" in texts(classification_scores(table, 2000, 3))


def test_undefined_medians_leave_a_gap_and_no_zero() -> None:
    table = percentile_rows(
        SCORES, sizes=(500.0,), validations=("RV",), prediction_times=PREDICTION_TIMES
    )
    late = table["prediction_time_lt"] == 3.0
    table.loc[late, ["p25", "p50", "p75"]] = np.nan
    figure = classification_scores(table, 500, 3)
    assert all(len(line.get_xdata()) == 2 for line in figure.axes[0].get_lines())


def test_reference_forecasters_are_drawn_beside_the_networks() -> None:
    table = percentile_rows(SCORES, sizes=(500.0,), prediction_times=PREDICTION_TIMES)
    equations = table[table["validation"] == "RV"].assign(
        forecaster="equations", neurons=np.nan, validation=np.nan, p50=0.5
    )
    figure = classification_scores(pd.concat([table, equations]), 500, 3)
    assert lines_with(figure.axes[0], [0.5, 0.5, 0.5]) == 1
    assert "equations, true state" in texts(figure)
    horizons = percentile_rows({"mean_horizon_lt": 4.5}, sizes=(500.0, 1000.0))
    others = horizons.iloc[:1].assign(
        forecaster="linear_inverse", neurons=np.nan, validation=np.nan, p50=1.25
    )
    figure = horizon_by_size(pd.concat([horizons, others]), interval_rows(horizons))
    assert lines_with(figure.axes[0], [1.25, 1.25]) == 1
    assert "linear inverse model" in texts(figure)


def test_other_networks_are_drawn_at_their_sizes() -> None:
    """As of networks with true washouts: no size stands for the others."""
    networks = percentile_rows({"mean_horizon_lt": 4.5}, sizes=(500.0, 1000.0))
    others = networks[networks["validation"] == "RV"].assign(forecaster="esn_true_washout")
    others["p50"] = [1.25, 1.75]
    both = pd.concat([networks, others])
    figure = horizon_by_size(both, interval_rows(both))
    (line,) = [
        line for line in figure.axes[0].get_lines() if line.get_label() == "network, true washout"
    ]
    assert [*line.get_xdata()] == [500.0, 1000.0]
    assert [*line.get_ydata()] == [1.25, 1.75]
    alone = horizon_by_size(networks, interval_rows(networks))
    bars = [
        [
            collection.get_segments()
            for collection in one.axes[0].collections
            if collection.get_gid()
        ]
        for one in (figure, alone)
    ]
    assert bars[0]
    np.testing.assert_array_equal(*bars)
    scores = percentile_rows(SCORES, prediction_times=PREDICTION_TIMES)
    drawn = classification_scores(
        pd.concat([scores, scores.assign(forecaster="esn_true_washout", p50=0.25)]), 500, 3
    )
    assert lines_with(drawn.axes[0], [0.25] * len(PREDICTION_TIMES)) == 2


def test_published_values_are_shown_only_at_our_sizes() -> None:
    table = percentile_rows({"mean_horizon_lt": 4.5}, sizes=(500.0, 1000.0))
    published = percentile_rows({"mean_horizon_lt": 4.0}, sizes=(500.0, 3000.0))
    figure = horizon_by_size(table, interval_rows(table), published=published)
    shown = select(published, validation="RV", neurons=500.0)["p50"]
    assert lines_with(figure.axes[0], list(shown)) == 1
    assert figure.axes[0].get_xlim()[1] < 3000
    assert "published" in texts(figure)
    elsewhere = published[published["neurons"] == 3000.0]
    figure = horizon_by_size(table, interval_rows(table), published=elsewhere)
    assert "published" not in texts(figure)


def test_published_scores_are_shown_in_every_column() -> None:
    table = percentile_rows(SCORES, prediction_times=PREDICTION_TIMES)
    published = table.assign(**{name: 0.9 * table[name] for name in ("p25", "p50", "p75")})
    figure = classification_scores(table, 500, 3, sizes_validation="RV", published=published)
    recall = select(published, metric="recall", validation="RV")
    at_size, by_size, of_sizes = figure.axes[3:6]
    assert lines_with(at_size, list(select(recall, neurons=500.0)["p50"])) == 1
    assert lines_with(by_size, list(select(recall, prediction_time_lt=3.0)["p50"])) == 1
    for size in (500.0, 1000.0, 1500.0):
        assert lines_with(of_sizes, list(select(recall, neurons=size)["p50"])) == 1
    assert overlapping_texts(drawn_texts(figure)) == []


def test_published_errors_of_the_training_set_are_on_the_right_edge() -> None:
    table = statistics_rows()
    published = table[table["forecaster"] != "floor"].assign(p25=0.011, p50=0.0123, p75=0.02)
    for draw in (long_term_figure, profiles_figure):
        figure = draw(table, published)
        panel = figure.axes[-1]
        assert panel.get_ylim()[1] > 0.0123
        diamonds = [line for line in panel.get_lines() if line.get_marker() == "D"]
        assert [line.get_xydata().tolist() for line in diamonds] == [[[1.0, 0.0123]]]
        assert lines_with(panel, [0.0123] * 3) == 1  # of the networks
        assert "published" in texts(figure)
        assert "published" not in texts(draw(table, published.iloc[:0]))
        assert "published" not in texts(draw(table, None))


def test_errors_beside_each_other_have_axes_of_one_kind() -> None:
    table = statistics_rows()
    of_u = (table["metric"] == "nrmse_u") & (table["forecaster"] == "floor")
    far = table.assign(p25=table["p25"].where(~of_u, 1e-6), p50=table["p50"].where(~of_u, 1e-6))
    for shown, scale in ((table, "linear"), (far, "log")):
        panels = profiles_figure(shown, None).axes[3:]
        assert [panel.get_yscale() for panel in panels] == [scale] * 3


def long_term_figure(table: pd.DataFrame, published: pd.DataFrame | None) -> Figure:
    return long_term_density(
        EDGES, DENSITY, DENSITY, None, table, interval_rows(table), THRESHOLD, published=published
    )


def profiles_figure(table: pd.DataFrame, published: pd.DataFrame | None) -> Figure:
    profiles = np.zeros((3, Y.size))
    return profile_errors(
        Y, profiles, profiles, None, table, interval_rows(table), published=published
    )


def test_published_reductions_are_those_of_networks() -> None:
    published = select(control_rows(), forecaster="esn", metric="reduction")
    published = published.assign(**{name: 0.8 * published[name] for name in ("p25", "p50", "p75")})
    figure = control_tradeoff(control_rows(), published=published)
    assert lines_with(figure.axes[0], list(published["p50"])) == 1
    assert "published" in texts(figure)
    assert "published" not in texts(control_tradeoff(control_rows()))


def test_figures_of_one_case_refuse_several() -> None:
    table = percentile_rows({"mean_horizon_lt": 4.5})
    both = pd.concat([table, table.assign(case="Re600")])
    with pytest.raises(ValueError, match="Re400, Re600"):
        horizon_by_size(both, interval_rows(both))


def test_by_reynolds_shows_medians_and_needs_the_size() -> None:
    horizon = reynolds_rows("mean_horizon_lt", None)
    scores = reynolds_rows("f_score", PREDICTION_TIMES)
    figure = by_reynolds(horizon, scores, 2000, [2.0])
    chosen = select(scores, validation="RV", prediction_time_lt=2.0)
    assert lines_with(figure.axes[1], list(chosen["p50"])) == 1
    with pytest.raises(ValueError, match="no network of 500 neurons"):
        by_reynolds(horizon, scores, 500, [2.0])


def test_by_reynolds_draws_a_single_reynolds_number() -> None:
    horizon = reynolds_rows("mean_horizon_lt", None).query("reynolds == 400")
    scores = reynolds_rows("f_score", PREDICTION_TIMES).query("reynolds == 400")
    for strategies in (["RV"], ["SSV", "RV"]):
        shown = [table[table["validation"].isin(strategies)] for table in (horizon, scores)]
        figure = by_reynolds(*shown, 2000, [2.0])
        assert len(figure.axes) == 2 + len(strategies)
        assert overlapping_texts(drawn_texts(figure)) == []


def test_f_scores_at_each_reynolds_number_in_its_order() -> None:
    horizon = reynolds_rows("mean_horizon_lt", None)
    scores = reynolds_rows("f_score", PREDICTION_TIMES)
    # names that sort otherwise, and one case that was not asked so far ahead
    names = {"Re400": "zeta", "Re600": "Alpha", "Re1000": "Re1000", "Re800": "Re0800"}
    scores = scores.assign(case=scores["case"].map(names)).sort_values("case", kind="stable")
    scores = scores[(scores["reynolds"] != 600) | (scores["prediction_time_lt"] < 3)]
    figure = by_reynolds(horizon, scores, 2000, [2.0, 3.0])
    panel = figure.axes[-1]
    assert panel.get_title() == "RV"
    _, labels = panel.get_legend_handles_labels()
    assert labels == ["400", "600", "800", "1000"]
    for reynolds in (400.0, 600.0, 800.0, 1000.0):
        chosen = select(scores, validation="RV", reynolds=reynolds)
        assert len(chosen) == (2 if reynolds == 600 else 3)
        assert lines_with(panel, list(chosen["p50"])) == 1
    assert "published" not in texts(figure)


def test_published_values_by_reynolds_are_those_that_we_have_as_well() -> None:
    horizon = reynolds_rows("mean_horizon_lt", None).query("reynolds != 600")
    scores = reynolds_rows("f_score", PREDICTION_TIMES).query("reynolds != 600")
    theirs = reynolds_rows("f_score", PREDICTION_TIMES).query("reynolds <= 600")
    theirs = theirs.assign(**{name: 0.9 * theirs[name] for name in ("p25", "p50", "p75")})
    figure = by_reynolds(horizon, scores, 2000, [2.0], published_classification=theirs)
    chosen = select(theirs, validation="RV", reynolds=400.0)
    assert lines_with(figure.axes[-1], list(chosen["p50"])) == 1
    assert lines_with(figure.axes[1], list(select(chosen, prediction_time_lt=2.0)["p50"])) == 1
    other = select(theirs, validation="RV", reynolds=600.0)
    assert lines_with(figure.axes[-1], list(other["p50"])) == 0
    assert "published" in texts(figure)
    smaller = theirs.assign(neurons=500.0)
    figure = by_reynolds(horizon, scores, 2000, [2.0], published_classification=smaller)
    assert "published" not in texts(figure)


def test_events_are_shaded_where_the_signal_exceeds_the_threshold() -> None:
    signal = burst(TIME, 4.0)
    figure = observable_and_density(TIME, signal, EDGES, DENSITY, THRESHOLD)
    spans = [patch.get_extents() for patch in figure.axes[0].patches]
    assert len(spans) == 1
    inside = figure.axes[0].transData.inverted().transform(spans[0])
    above = TIME[signal >= THRESHOLD]
    assert inside[:, 0] == pytest.approx([above[0], above[-1]], abs=1e-6)


def test_true_runs() -> None:
    assert true_runs(np.array([True, True, False, True])) == [(0, 1), (3, 3)]
    assert true_runs(np.array([False, False])) == []


def test_isosurfaces_follow_the_field() -> None:
    grid = np.meshgrid(X, Y, Z, indexing="ij")
    velocity = np.stack([grid[1], 0 * grid[1], 0 * grid[1]])
    # The surface scalar = 0.5 of this field is the plane y = 0.5, closed at the ends of the box.
    figure = vorticity_isosurfaces(X, Y, Z, [FlowSnapshot("t", velocity, grid[1])], 0.5)
    surface = [c for c in figure.axes[0].collections if hasattr(c, "_faces")][-1]
    heights = np.asarray(surface._faces)[..., 2]
    assert {-1.0, -0.5, 0.5, 1.0} <= set(np.round(np.unique(heights), 6))
    assert np.abs(heights).min() == pytest.approx(0.5)
    with pytest.raises(ValueError, match="must be positive"):
        vorticity_isosurfaces(X, Y, Z, [], 0.0)


def test_a_field_without_surface_leaves_an_empty_box() -> None:
    velocity = np.ones((3, len(X), len(Y), len(Z)))
    snapshot = FlowSnapshot("laminar", velocity, np.zeros((len(X), len(Y), len(Z))))
    assert vorticity_isosurfaces(X, Y, Z, [snapshot], 0.4).axes


def test_nothing_to_draw_is_an_error() -> None:
    with pytest.raises(ValueError, match="no example"):
        prediction_examples([], THRESHOLD, 2.0)
    with pytest.raises(ValueError, match="no evaluation"):
        horizon_evaluations(TIME, TIME, [], THRESHOLD, 0.01)
    with pytest.raises(ValueError, match="no case"):
        control_density([])
    undefined = np.full(len(EDGES) - 1, np.nan)
    with pytest.raises(ValueError, match="no density is positive"):
        control_density([ControlledDensity("Re = 400", EDGES, THRESHOLD, undefined, {})])
    with pytest.raises(ValueError, match="no value in column neurons"):
        nearest_value(pd.DataFrame({"neurons": [np.nan]}), "neurons", 1)


def test_strategies_come_in_the_papers_order() -> None:
    assert ordered_validations(["RV", "other", "SSV"]) == ["SSV", "RV", "other"]


def test_the_network_schematic_prints_the_numbers_in_use() -> None:
    shown = " ".join(texts(GALLERY["network_schematic"]()))
    for number in ("N_r = 2000", "N_u = 9", "0.29", "0.33", "0.1"):
        assert number in shown


def test_single_networks_are_medians_of_scores_and_ends_and_others_as_they_are() -> None:
    rows = alarm_rows("prediction_time_lt", (1.0, 2.0))
    median = median_network(rows, "prediction_time_lt")
    single = rows[rows["forecaster"] == "esn"]
    at_two = single.loc[single["prediction_time_lt"] == 2.0, ["value", "low", "high"]]
    shown = median[(median["forecaster"] == "esn") & (median["prediction_time_lt"] == 2.0)]
    expected = at_two.median().to_numpy()
    np.testing.assert_allclose(shown[["value", "low", "high"]].to_numpy()[0], expected)
    others = rows[rows["forecaster"] != "esn"].reset_index(drop=True)
    pd.testing.assert_frame_equal(median[median["forecaster"] != "esn"], others)


def test_alarms_of_one_size_and_strategy_and_of_everybody_else_are_shown() -> None:
    rows = alarm_rows("prediction_time_lt", (1.0,))
    networks = rows["neurons"].notna()
    small = rows[networks].assign(neurons=500.0)
    other = rows[networks].assign(validation="SSV")
    table = pd.concat([rows, small, other])
    pd.testing.assert_frame_equal(alarms_shown(table, 1900, "RV"), rows)
    pd.testing.assert_frame_equal(alarms_shown(rows, 1900, "WFV"), rows)
    # a single seed has no committee
    pd.testing.assert_frame_equal(alarms_shown(rows[~networks], 2000, "RV"), rows[~networks])


def test_prediction_times_that_are_not_in_the_table_are_not_shown() -> None:
    table = pd.DataFrame({"prediction_time_lt": [1.0, 2.0]})
    assert times_shown(table, [2.0, 3.0]) == [2.0]
    assert times_shown(table, [3.0]) == [2.0]


def test_everybody_has_a_curve_of_skill() -> None:
    scores = score_rows("f_score", "brier_skill")
    votes = scores.assign(probability="votes", value=scores["value"] / 2)
    left, right = forecast_skill(pd.concat([scores, votes]), 2000, "RV").axes
    committee = scores[(scores["forecaster"] == "esn_committee") & (scores["metric"] == "f_score")]
    for panel in (left, right):
        assert lines_with(panel, committee["value"].tolist()) == 1
        assert len(panel.get_lines()) == scores["forecaster"].nunique()


def test_reliability_is_drawn_of_those_who_tell_probabilities() -> None:
    rows = reliability_rows()
    diagram, _ = reliability(rows, [3.0], 2000, "RV").axes
    mean = np.linspace(0, 1, 11)
    assert lines_with(diagram, (0.95 * mean).tolist()) == 1
    assert lines_with(diagram, (0.9 * mean).tolist()) == 1
    without = rows[rows["forecaster"] != "esn_committee"]
    two = pd.concat([without, without[:1].assign(forecaster="esn", neurons=2000.0)])
    assert len(reliability(two, [3.0], 2000, "RV").axes) == 2 * 9


def test_the_frontier_shows_what_is_left_against_what_was_spent_and_against_conditions() -> None:
    table = frontier_rows()
    figure, others = control_frontier(table, USUAL), control_conditions(table, USUAL)
    rules, frontier = figure.axes
    by_delay, by_strength, by_noise = others.axes
    assert "delay" in by_delay.get_xlabel().lower()
    # of the network, along the horizon, with decisions every 0.25 LT
    curves = [line for line in frontier.get_lines() if line.get_linestyle() != "None"]
    (slow,) = (line for line in curves if line.get_xdata()[0] == 0.125 and line.get_color() == BLUE)
    assert list(slow.get_xdata()) == pytest.approx([0.125, 0.0625, 0.0375])
    assert list(slow.get_ydata()) == pytest.approx([4e-2, 2e-3, 0.0])
    # rules have a panel of their own
    assert lines_with(rules, [0.01, 0.06]) > 0
    assert lines_with(frontier, [0.01, 0.06]) == 0
    # the runs without delay belong to the curve over delays
    assert lines_with(by_delay, [2e-3, 4e-2, 4e-2]) == 1
    assert lines_with(by_strength, [4e-2, 4e-2, 2e-3]) == 1
    assert lines_with(by_noise, [2e-3, 4e-2, 4e-2]) == 1
    # nothing left has a place on the axis, and the bound above it
    low, high = frontier.get_ylim()
    assert low < 0 < high
    assert {"reactive", "echo state network", "interval over flows"} <= set(texts(figure))
    assert {"receding horizon, 2 LT", "echo state network"} <= set(texts(others))
    # a committee beside them, and by what share of the votes it acts
    (voted,) = (line for line in curves if list(line.get_xdata()) == [0.045, 0.025])
    assert list(voted.get_ydata()) == [5e-4, 0.0]
    assert "committee of networks" in texts(figure)
    assert "receding horizon, every 0.25 LT, 0.5 of the votes" in texts(figure)


def test_the_frontier_of_strategies_that_act_as_often_has_ticks() -> None:
    table = frontier_rows()
    spent = table["metric"] == "control_fraction"
    narrow = 0.03 + 0.1 * table.loc[spent, ["value", "low", "high"]]
    table.loc[spent, ["value", "low", "high"]] = narrow.clip(upper=0.045)
    axes = control_frontier(table, USUAL).axes[0]
    low, high = axes.get_xlim()
    assert sum(low <= tick <= high for tick in axes.get_xticks()) >= 2


def test_the_frontier_leaves_out_other_spans_starts_and_spells_of_quiet() -> None:
    table = frontier_rows()
    plain = control_frontier(table, USUAL)
    others = [
        table.assign(**{name: value, "value": 0.123}).head(6)
        for name, value in (("starts", "unselected"), ("span_lt", 200.0), ("quiet_lt", 0.0))
    ]
    more = control_frontier(pd.concat([table, *others]), USUAL)
    assert render(more, "png") == render(plain, "png")


def test_the_frontier_tells_apart_what_is_observed() -> None:
    table = frontier_rows()
    seen = table.assign(observed=None), table.assign(observed="modes_4", value=0.5 * table["value"])
    said = " ".join(texts(control_frontier(pd.concat(seen), USUAL)))
    assert "observed modes 4" in said


def test_strategies_under_one_condition_alone_are_not_compared_under_several() -> None:
    table = frontier_rows()
    simple = table[(table["delay_lt"] == 0) & (table["strength"] == 1) & (table["noise"] == 0.01)]
    assert overlapping_texts(drawn_texts(control_frontier(simple, USUAL))) == []
    said = " ".join(texts(control_conditions(simple, USUAL)))
    assert "No strategy was tried under several conditions" in said


def test_a_frontier_of_nothing_says_so() -> None:
    table = frontier_rows().assign(value=np.nan)
    assert "no event occurred" in " ".join(texts(control_frontier(table, USUAL)))


def test_bars_are_the_intervals_of_single_networks():
    table = percentile_rows({"mean_horizon_lt": 4.5}, validations=("RV",))
    intervals = interval_rows(table)
    (axes,) = horizon_by_size(table, intervals).axes
    bars = [
        collection.get_segments()
        for collection in axes.collections
        if isinstance(collection, LineCollection)
    ]
    (segments,) = (found for found in bars if len(found) == table["neurons"].nunique())
    expected = intervals.groupby("neurons")[["low", "high"]].median()
    np.testing.assert_allclose([segment[:, 1] for segment in segments], expected.to_numpy())
    np.testing.assert_allclose([segment[0, 0] for segment in segments], expected.index)


# -- observables that are negative -----------------------------------------------------------------

SINKING = burst(TIME, 4.0) - 0.3
FORECAST = np.where(TIME >= 1.5, SINKING - 0.02, np.nan)
LAYOUT = ValidationLayout("RV", "Recycle Validation", (0, 0.5), (0.5, 8), np.array([[0.5, 2.5]]))
NEGATIVE = {
    "validation_strategies": lambda: validation_strategies(TIME, SINKING, [LAYOUT], -0.1),
    "prediction_schematic": lambda: prediction_schematic(
        TIME - 1.5, SINKING, FORECAST, -0.1, 2.0, washout_lt=0.5
    ),
    "control_schematic": lambda: control_schematic(
        TIME - 1.0, SINKING, SINKING - 0.05, FORECAST, -0.1, 2.0, (1.0, 2.5)
    ),
    "horizon_evaluations": lambda: horizon_evaluations(
        TIME - 4.0, SINKING, [HorizonEvaluation(2.0, TIME - 4.0, FORECAST, 1.0)], -0.1, 0.01
    ),
    "prediction_examples": lambda: prediction_examples(
        [PredictionExample("true positive", TIME, SINKING, FORECAST)], -0.1, 2.0
    ),
    "observable_and_density": lambda: observable_and_density(
        TIME, SINKING, EDGES - 0.3, DENSITY, -0.1
    ),
}


@pytest.mark.parametrize("name", NEGATIVE)
def test_negative_observables_are_not_cut_off(name):
    axes = NEGATIVE[name]().axes
    curves = [
        (panel, np.asarray(line.get_ydata(), dtype=float))
        for panel in axes
        for line in panel.get_lines()
    ]
    shown = [(panel, y) for panel, y in curves if y.size == SINKING.size]
    assert shown
    for panel, y in shown:
        low, high = panel.get_ylim()
        assert low <= np.nanmin(y)
        assert np.nanmax(y) <= high
        assert high - low < 4 * np.ptp(SINKING)  # nor is room given away


def test_observables_that_are_never_negative_are_drawn_from_zero():
    assert axis_floor(burst(TIME, 4.0)) == 0.0
    # unless they never come near it
    assert 2.9 < axis_floor(3.0 + burst(TIME, 4.0)) < 3.02
    assert axis_floor(SINKING, FORECAST) < np.nanmin(FORECAST) < 0.0


def test_an_axis_has_room_for_the_name_of_the_threshold():
    curve = np.array([2.0, 3.0])
    floor, top = axis_limits(2.99, curve)
    assert floor == pytest.approx(1.94)
    assert top > 2.99 + 0.19 * (3.0 - floor)
    assert axis_limits(2.1, curve)[1] == pytest.approx(3.0 + 0.06 * 1.06)


def test_quartiles_of_one_network_are_no_band():
    rows = pd.DataFrame({"neurons": [100.0, 200.0, 300.0], "p50": [0.5, 0.6, 0.7]})
    style = validation_style("RV")
    for spread, entries in ((0.1, 1), (0.0, 0)):
        axes = Figure().subplots()
        quartiles = rows.assign(p25=rows["p50"] - spread, p75=rows["p50"] + spread)
        draw_percentiles(axes, quartiles, "neurons", style)
        assert len(spread_handles([axes])) == entries
        assert lines_with(axes, [0.5, 0.6, 0.7]) == 1


def test_an_axis_holds_the_intervals_of_single_networks():
    axes = Figure().subplots()
    ends = {"low": [0.1, 0.2], "high": [0.8, 0.9]}
    keys = {"forecaster": "esn", "neurons": [100.0, 200.0], "metric": "f_score", "validation": "RV"}
    axes.plot([100.0, 200.0], [0.5, 0.5])
    draw_single_intervals(
        axes, pd.DataFrame({**keys, **ends}), "f_score", "RV", validation_style("RV")
    )
    low, high = axes.get_ylim()
    assert low < 0.1
    assert high > 0.9


def test_references_have_a_column_of_the_legend_for_their_long_names():
    kinds = ("esn_aware", "quadratic", "quadratic_aware", "quadratic_aware_filtered")
    metric = {"metric": "mean_horizon_lt", "p25": 4.4, "p50": 4.4, "p75": 4.4}
    rows = [{"forecaster": kind, "neurons": np.nan, "validation": None, **metric} for kind in kinds]
    rows.append({"forecaster": "esn", "neurons": 1000.0, "validation": "RV", **metric})
    percentiles = pd.DataFrame(rows).assign(case="Re400")
    ends = percentiles.tail(1).assign(low=4.0, high=4.8)
    frames = {text.words: text.frame for text in drawn_texts(horizon_by_size(percentiles, ends))}
    columns = [frames[forecaster_label(kind)].x0 for kind in kinds]
    assert columns == pytest.approx([columns[0]] * 4)
    assert frames["RV"].x0 == pytest.approx(frames["interval of one network"].x0)
    assert frames["RV"].x0 > max(frames[forecaster_label(kind)].x1 for kind in kinds)


def test_lost_skill_draws_onsets_of_committees_and_says_each_alarm_once():
    figure = GALLERY["lost_skill"]()
    equations, learnt = figure.axes
    labels = [[bars.get_label() for bars in axes.containers] for axes in (equations, learnt)]
    assert labels[0] == ["flow: equations, true state", "sensors: equations, filtered"]
    assert labels[1] == [
        "published precursor",
        "invariants: committee of networks, 50 neurons",
        "invariants: network, 90 neurons",
        "observable now",
    ]
    # the first forecaster, of onsets alone
    line = equations.containers[0].lines[0]
    np.testing.assert_allclose(line.get_xdata(), [0.5, 1, 2])
    np.testing.assert_allclose(line.get_ydata(), 0.9 * np.exp(-0.3 * np.array([0.5, 1, 2])))


def test_all_modes_hold_all_and_few_leading_ones_what_their_coefficients_say():
    """Modes, shares and decoded observables by scikit-learn's PCA."""
    flow = KolmogorovFlow(40.0, 1, 2)
    states = np.random.default_rng(2).normal(0.1, 1.0, (1, 400, flow.dimension))
    states *= np.linspace(2.0, 0.5, flow.dimension)
    encoder = PodEncoder.fit(
        states, EncodingCase(flow, {"modes": flow.dimension, "symmetrised": False})
    )
    numbers = np.array([1, 5, flow.dimension])
    found = kept(encoder, flow, states[0].T, numbers)
    assert [found[name][-1] for name in found] == pytest.approx([1.0, 1.0, 1.0])
    pca = PCA().fit(states[0])
    np.testing.assert_allclose(
        found["variance"], np.cumsum(pca.explained_variance_ratio_)[numbers - 1]
    )
    for number, mean, correlation in zip(numbers, found["mean"], found["correlation"], strict=True):
        few = PCA(number).fit(states[0])
        decoded = flow.observable(few.inverse_transform(few.transform(states[0])).T)
        true = flow.observable(states[0].T)
        assert mean == pytest.approx(decoded.mean() / true.mean())
        assert correlation == pytest.approx(np.corrcoef(decoded, true)[0, 1])


def test_burst_vorticity_has_one_scale_and_the_times_of_its_fields():
    figure = GALLERY["burst_vorticity"]()
    fields = [axes for axes in figure.axes if axes.images]
    limits = {axes.images[0].get_clim() for axes in fields}
    assert len(fields) == 4
    ((low, high),) = limits
    assert low == -high
    assert high == pytest.approx(max(np.abs(axes.images[0].get_array()).max() for axes in fields))
    titles = [axes.get_title(loc="right") for axes in fields]
    assert titles == ["$-2.0$ LT", "$-1.0$ LT", "peak", "$+1.0$ LT"]


def test_burst_forecast_shows_truth_and_forecast_on_one_scale_at_the_same_times():
    figure = GALLERY["burst_forecast"]()
    fields = [axes for axes in figure.axes if axes.images]
    assert len(fields) == 8
    assert len({axes.images[0].get_clim() for axes in fields}) == 1
    titles = [axes.get_title(loc="right") for axes in fields]
    assert titles == 2 * ["$+0.2$ LT", "$+0.6$ LT", "$+1.0$ LT", "$+1.4$ LT"]
    true, forecast = (np.asarray(fields[place].images[0].get_array()) for place in (2, 6))
    np.testing.assert_allclose(forecast, 0.75 * true)


def test_burst_forecast_decodes_channels_and_finds_the_true_state_in_its_series():
    generator = np.random.default_rng(3)
    flow = KolmogorovFlow(largest_wavenumber=4)
    states = 0.1 * generator.standard_normal((3, 12, flow.dimension))
    gain, constant = np.eye(flow.dimension), np.zeros(flow.dimension)
    marks = np.array([1, 2, 4, 5])
    channels = np.hstack([states[2, 3 + marks], np.zeros((4, 1))])  # a forecast without an error
    event = {
        "time_lt": np.arange(8.0),
        "true": np.arange(8.0),
        "forecast": np.arange(8.0),
        "mark": marks,
        "forecast_state": channels,
        "series": 2,
        "first_step": 3,
    }
    figure = burst_forecast(
        event=event,
        gain=gain,
        constant=constant,
        states=states,
        source={"system": "kolmogorov", "parameters": {"largest_wavenumber": 4}},
        forecaster="equations_filtered",
        threshold=0.2,
        symbol="D",
        observable_name="dissipation",
    )
    true, forecast = np.split(
        np.array([axes.images[0].get_array() for axes in figure.axes if axes.images]), 2
    )
    np.testing.assert_allclose(forecast, true, atol=1e-12)
    corner = flow.vorticity(states[2, 4], np.zeros((1, 2)))[0]
    assert true[0, 0, 0] == pytest.approx(corner)


def test_a_legend_has_as_many_columns_as_have_room():
    def handles(*lengths):
        return [Line2D([], [], label="x" * length) for length in lengths]

    assert columns_that_fit(handles(10, 10, 10), 3) == 3
    assert columns_that_fit(handles(60, 60, 60), 3) == 2
    assert columns_that_fit(handles(60, 60, 10, 10, 10, 10), 3) == 3  # short ones beside long ones
    assert columns_that_fit(handles(90, 90, 90), 3) == 1

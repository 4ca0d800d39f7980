"""The published percentiles, from the repository's own file, and ours compared with them."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from burstcast.base.files.tables import read_table
from burstcast.figures.parts.published import (
    compare,
    intervals_of_control,
    published_percentiles,
    published_reductions,
)
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.mfe_modes import flow_modes
from burstcast_workflow.tables.declarations import TABLES

RESOURCE = Path(__file__).parents[2] / "resources" / "published_percentiles.csv"
KINDS = {name: name for name in ("classification", "horizon", "statistics", "control")}
KINDS["hyperparameters"] = "hyper"


@pytest.fixture(scope="module")
def published():
    return read_table(RESOURCE)


@pytest.mark.parametrize("table", KINDS)
def test_every_published_value_belongs_to_a_table_of_ours(published, table):
    rows = published_percentiles(published, table)
    assert rows["p50"].notna().all()
    assert ((rows["p25"] <= rows["p50"]) | rows["p25"].isna()).all()
    assert ((rows["p50"] <= rows["p75"]) | rows["p75"].isna()).all()
    assert set(rows["metric"]) <= set(TABLES[table].percentiles)
    comparable = published["metric"] != "input_scaling"
    assert len(rows) == ((published["kind"] == KINDS[table]) & comparable).sum()


def ratios(published, table):
    """What published values are multiplied by, by metric."""
    raw = published[published["kind"] == KINDS[table]].reset_index(drop=True)
    ours = published_percentiles(published, table)
    assert len(raw) == len(ours)
    names = ["p25", "p50", "p75"]
    return (ours[names] / raw[names]).groupby(ours["metric"]).agg(["min", "max"])


def test_what_published_values_are_multiplied_by(published):
    """Errors of the velocity are by the range from wall to wall; exceedances those of steps."""
    factors = ratios(published, "statistics")
    assert factors.loc["nrmse_u"].to_numpy() == pytest.approx(1 / 1.97)
    assert (factors.drop(index="nrmse_u") == 1).all(axis=None)
    assert ratios(published, "control").to_numpy() == pytest.approx(1 / 1.02)
    for table in ("classification", "horizon"):
        assert (ratios(published, table) == 1).all(axis=None)


def test_the_range_from_wall_to_wall_is_about_twice_that_of_half_a_channel():
    """Where the factor is from: the mean flow is odd about the midplane."""
    mean = np.zeros(9)
    mean[[0, 8]] = 0.216, -0.087  # the mean amplitudes of the shear flow at Re = 400
    matrices = flow_modes(MoehlisFaisstEckhardt(400.0)).profile_matrices(np.linspace(-1, 1, 201))
    profile, _, _ = matrices.profiles(mean, np.outer(mean, mean))
    assert np.ptp(profile) / np.ptp(profile[100:]) == pytest.approx(1.97, abs=0.02)


def test_exceedances_as_reductions_of_ours_without_control(published):
    theirs = published_percentiles(published, "control").query("reynolds == 400")
    rows = [(1.0, "uncontrolled", 0.12), (1.0, "controlled", 0.02), (2.0, "uncontrolled", 0.0)]
    ours = our_rows(
        *((2000, "RV", time, f"exceedance_{run}", value) for time, run, value in rows),
        named=["p50"],
    )
    (row,) = published_reductions(theirs, ours).to_dict("records")
    assert (row["metric"], row["prediction_time_lt"]) == ("reduction", 1.0)
    assert row["p50"] == pytest.approx(1 - 0.027678 / 1.02 / 0.12)
    assert row["p25"] < row["p50"] < row["p75"]
    assert published_reductions(theirs, ours.assign(neurons=500)).empty


# -- ours beside them ------------------------------------------------------------------------------
PERCENTILES = ["p25", "p50", "p75"]


def published_rows(*rows):
    columns = ["kind", "reynolds", "neurons", "validation", "prediction_time", "metric"]
    return pd.DataFrame(rows, columns=[*columns, *PERCENTILES])


def our_rows(*rows, named=(*PERCENTILES, "networks"), forecaster="esn"):
    """Rows of neurons, validation and prediction time, metric, and what is ``named``."""
    keys = ["neurons", "validation", "prediction_time_lt", "metric"]
    table = pd.DataFrame(rows, columns=[*keys, *named])
    table.insert(0, "forecaster", forecaster)
    return table.assign(case="Re400", reynolds=400.0)


F_SCORES = published_rows(
    ("classification", 400, 500, "RV", 1.0, "f_score", 0.86, 0.87, 0.88),
    ("classification", 400, 500, "RV", 2.0, "f_score", 0.65, 0.66, 0.67),
    ("classification", 400, 500, "RV", 3.0, "f_score", 0.44, 0.45, 0.46),
    ("classification", 600, 500, "RV", 1.0, "f_score", 0.90, 0.91, 0.92),
)
OUR_F_SCORES = our_rows(
    # prediction times as an arithmetic progression gives them
    (500, "RV", 1.0 + 1e-13, "f_score", 0.80, 0.81, 0.82, 10),
    (500, "RV", 2.0, "f_score", 0.64, 0.65, 0.67, 10),
    (500, "RV", 3.0, "f_score", 0.48, 0.49, 0.50, 10),
    (500, "SSV", 1.0, "f_score", 0.70, 0.71, 0.72, 10),
    (700, "RV", 1.0, "f_score", 0.90, 0.91, 0.92, 10),
)
OUR_INTERVALS = our_rows(
    *((500, "RV", 1.0, "f_score", seed, 0.79, high) for seed, high in enumerate((0.83, 0.88, 0.9))),
    *((500, "RV", 3.0, "f_score", seed, low, 0.52) for seed, low in enumerate((0.44, 0.46, 0.47))),
    named=["seed", "low", "high"],
)


def test_ours_beside_each_published_value_that_we_have():
    twin = OUR_F_SCORES.assign(case="another", p50=0.1)
    both = pd.concat([twin, OUR_F_SCORES], ignore_index=True)
    table = compare(F_SCORES, {"classification": both}, {"classification": OUR_INTERVALS})
    assert table["kind"].unique().tolist() == ["classification"]
    # every case of a Reynolds number
    other = table[table["case"] == "another"]
    assert other["p50"].tolist() == [0.1] * 3
    assert other["low"].isna().all()
    table = table[table["case"] == "Re400"]
    assert table["prediction_time_lt"].tolist() == [1.0, 2.0, 3.0]
    assert table["published_p50"].tolist() == [0.87, 0.66, 0.45]
    assert table["p50"].tolist() == [0.81, 0.65, 0.49]
    # medians over the networks of the ends of their intervals
    assert table[["low", "high"]].iloc[[0, 2]].values.tolist() == [[0.79, 0.88], [0.46, 0.52]]
    assert table[["low", "high"]].iloc[1].isna().all()
    # in the bootstrap interval; between the quartiles, of which there is no interval; in neither
    assert table["inside"].tolist() == [True, True, False]
    assert table.dtypes["published_p50"] == table.dtypes["low"] == "float64"
    assert table.dtypes["inside"] == "boolean"


def test_nothing_can_be_said_about_the_errors_of_one_training_set():
    theirs = published_rows(
        ("statistics", 400, None, "TRAIN", None, "nrmse_u", None, 0.0197, None),
        ("statistics", 400, 500, "RV", None, "nrmse_u", 0.01, 0.0197, 0.03),
    )
    of_training = our_rows((None, None, None, "nrmse_u", *[0.01] * 3, 1), forecaster="training")
    of_networks = our_rows((500, "RV", None, "nrmse_u", 0.02, 0.03, 0.04, 3))
    ours = pd.concat([of_training, of_networks]).drop(columns="prediction_time_lt")
    table = compare(theirs, {"statistics": ours}, {})
    assert table["forecaster"].tolist() == ["training", "esn"]
    assert table["published_p50"].tolist() == pytest.approx([0.01, 0.01])
    assert table["inside"].isna().tolist() == [True, False]
    assert not table["inside"].iloc[1]


def test_what_nobody_has_is_left_out_and_undefined_medians_are_neither_inside_nor_outside(
    published,
):
    assert compare(published, {"survival": pd.DataFrame()}, {}).empty
    assert compare(F_SCORES, {"horizon": OUR_F_SCORES}, {}).empty
    mixed = published[published["kind"] == "hyper"]
    ours = our_rows(
        (500, "RV", None, "input_scaling", 0.3, 0.4, 0.5, 10),
        (500, "RV", None, "spectral_radius", 0.1, 0.15, 0.2, 10),
    )
    table = compare(mixed, {"hyperparameters": ours}, {})
    assert table["metric"].tolist() == ["spectral_radius"]
    undefined = OUR_F_SCORES.assign(**dict.fromkeys(PERCENTILES, np.nan), networks=0)
    table = compare(F_SCORES, {"classification": undefined}, {})
    assert len(table) == 3
    assert table["inside"].isna().all()
    with pytest.raises(ValueError, match="nothing is published for the table survival"):
        published_percentiles(published, "survival")


def test_control_is_compared_under_the_conditions_of_the_paper():
    network = {"forecaster": "esn", "neurons": 2000, "validation": "RV", "seed": 0}
    keys = {"case": "Re400", "reynolds": 400.0, **network, "prediction_time_lt": 1.0}
    control = pd.DataFrame([{**keys, "exceedance_controlled": 0.025}])
    run = {**keys, "strategy": "prediction_triggered", "metric": "exceedance_controlled"}
    run |= {"noise": 0.01, "value": 0.025, "low": 0.02, "high": 0.03}
    others = [{"noise": 0.03, "value": 0.031}, {"strategy": "reactive"}, {"metric": "reduction"}]
    strategies = pd.DataFrame([{**run, "low": 0.1, **other} for other in others] + [run])
    intervals = intervals_of_control(strategies, control)
    assert intervals[["low", "high"]].values.tolist() == [[0.02, 0.03]]
    # a campaign whose control has no networks in one of the tables: columns without any text
    equations = {"forecaster": "equations", "neurons": np.nan, "validation": np.nan}
    assert intervals_of_control(strategies, control.assign(**equations)).empty
    both = pd.concat([strategies, strategies.assign(**equations)])
    kept_intervals = intervals_of_control(both, control.assign(**equations))
    assert kept_intervals["forecaster"].tolist() == ["equations"]
    theirs = ("control", 400, 2000, "RV", 1, "exceedance_probability", 0.0273, 0.0277, 0.0291)
    ours = our_rows((2000, "RV", 1.0, "exceedance_controlled", 0.025, 0.025, 0.025, 1))
    table = compare(published_rows(theirs), {"control": ours}, {"control": intervals})
    assert table["published_p50"].tolist() == pytest.approx([0.0277 / 1.02])
    assert table["inside"].tolist() == [True]

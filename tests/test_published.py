"""The published percentiles, from the repository's own file."""

from pathlib import Path

import numpy as np
import pytest

from burstcast.published import published_percentiles
from burstcast.statistics.moments import StateMoments
from burstcast.statistics.profiles import flow_modes, velocity_profiles
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast_workflow.harness.tables import read_table

RESOURCE = Path(__file__).parents[1] / "resources" / "published_percentiles.csv"


@pytest.fixture(scope="module")
def published():
    return read_table(RESOURCE)


def test_horizon_of_the_paper(published):
    table = published_percentiles(published, "horizon")
    row = table[(table["neurons"] == 1000) & (table["validation"] == "RV")]
    assert row[["reynolds", "forecaster", "metric"]].values.tolist() == [
        [400, "esn", "mean_horizon_lt"]
    ]
    assert row[["p25", "p50", "p75"]].values.tolist() == [[4.1621, 4.2328, 4.2873]]


def test_training_rows_are_a_forecaster_of_their_own(published):
    table = published_percentiles(published, "statistics")
    training = table[table["forecaster"] == "training"]
    assert set(training["metric"]) == {
        "kantorovich",
        "mean_log_error",
        "nrmse_u",
        "nrmse_uu",
        "nrmse_uv",
    }
    assert training[["validation", "neurons"]].isna().all(axis=None)
    assert set(table["forecaster"]) == {"training", "esn"}


@pytest.mark.parametrize("table", ["classification", "horizon", "hyperparameters", "statistics"])
def test_every_published_value_belongs_to_a_table(published, table):
    rows = published_percentiles(published, table)
    assert rows["p50"].notna().all()
    assert ((rows["p25"] <= rows["p50"]) | rows["p25"].isna()).all()
    assert ((rows["p50"] <= rows["p75"]) | rows["p75"].isna()).all()
    assert len(rows) == (published["kind"] == {"hyperparameters": "hyper"}.get(table, table)).sum()


def test_tables_without_published_values(published):
    with pytest.raises(ValueError, match="nothing is published for the table control"):
        published_percentiles(published, "control")


def test_errors_of_the_velocity_are_in_our_normalisation(published):
    """By the range from wall to wall; the authors divide by that from the centre to a wall."""
    raw = published[published["kind"] == "statistics"].reset_index(drop=True)
    ours = published_percentiles(published, "statistics")
    ratio = raw["p50"] / ours["p50"]
    assert ratio[raw["metric"] == "nrmse_u"].tolist() == pytest.approx([1.97] * 3)
    assert (ratio[raw["metric"] != "nrmse_u"] == 1).all()


def test_the_range_from_wall_to_wall_is_about_twice_that_of_half_a_channel():
    """Where the factor is from: the mean flow is odd about the midplane."""
    mean = np.zeros(9)
    mean[[0, 8]] = 0.216, -0.087  # the mean amplitudes of the shear flow at Re = 400
    y = np.linspace(-1, 1, 201)
    modes = flow_modes(MoehlisFaisstEckhardt(400.0))
    assert modes is not None
    matrices = modes.profile_matrices(y)
    moments = StateMoments(1, mean, np.outer(mean, mean))
    profile = velocity_profiles(matrices, moments).u
    assert np.ptp(profile) / np.ptp(profile[100:]) == pytest.approx(1.97, abs=0.02)

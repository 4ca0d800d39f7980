"""The published percentiles, from the repository's own file."""

from pathlib import Path

import pytest

from burstcast.published import published_percentiles
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

"""Files and columns that do not belong into a table are refused."""

import numpy as np
import pytest

from burstcast_workflow.harness.call import job_identity, provenance
from burstcast_workflow.harness.storage import write_json, write_netcdf
from burstcast_workflow.jobs.origins import origins
from burstcast_workflow.jobs.tables import Tables, TablesOfCase, as_declared
from burstcast_workflow.tables.registry import plain

CASE = TablesOfCase({}, {"case": "Re400"})


def written(directory, case, suffix):
    """A file of a job of a case."""
    path = directory / f"{case}{suffix}"
    record = provenance(job_identity("horizon", {"case": case, "forecaster": "equations"}), {})
    if suffix == ".json":
        write_json(path, {"provenance": record})
    else:
        write_netcdf(path, {}, record)
    return path


def test_files_that_do_not_belong_together_are_refused(tmp_path):
    assert CASE.gathered([]) == []
    twice = [written(tmp_path, "Re400", suffix) for suffix in (".json", ".nc")]
    with pytest.raises(ValueError, match="are both of the job") as error:
        origins(twice)
    assert all(str(path) in str(error.value) for path in twice)
    cases = [written(tmp_path, case, ".json") for case in ("Re400", "Re600")]
    assert [origin.identity["case"] for origin in origins(cases)] == ["Re400", "Re600"]
    with pytest.raises(ValueError, match="is of the case Re600"):
        CASE.gathered(cases)
    write_json(tmp_path / "x.json", {"seed": 1})
    with pytest.raises(ValueError, match=r"x\.json does not say which job wrote it"):
        origins([tmp_path / "x.json"])


# -- columns --------------------------------------------------------------------------------------

ROWS = [
    {"f_score": 0.5, "case": "a", "seed": 1, "nrmse_u": None},
    {"case": "b", "seed": None, "f_score": None},
]
DECLARED = ["case", "reynolds*", "seed", "nrmse_u*", "f_score"]


def test_columns_as_declared_in_their_order_and_no_others():
    table = as_declared(ROWS, DECLARED, "scores")
    assert list(table.columns) == ["case", "seed", "f_score"]
    assert table["seed"].dtype == "Int64"
    more = [*ROWS, {"case": "c", "seed": 3, "f_score": np.nan, "reynolds": 400, "nrmse_u": 0.1}]
    for rows in (more, []):
        assert list(as_declared(rows, DECLARED, "scores").columns) == plain(DECLARED)
    with pytest.raises(ValueError, match="table scores declares no column f_score"):
        as_declared(ROWS, DECLARED[:-1], "scores")
    with pytest.raises(ValueError, match="table scores declares recall, which no row has"):
        as_declared(ROWS, [*DECLARED, "recall"], "scores")


def test_tables_are_written_where_they_are_declared(tmp_path):
    settings = {"tables": {"scores": {"columns": DECLARED}, "events": {"columns": ["case"]}}}
    paths = [str(tmp_path / f"{name}.csv") for name in settings["tables"]]
    with pytest.raises(ValueError, match=r"writes \['scores'\]; its rule declares \['events'"):
        Tables(settings, {}).write(paths, scores=ROWS)


def test_other_metrics_than_those_declared_are_refused(tmp_path):
    settings = {"tables": {"scores": {"columns": ["metric", "value"], "metrics": ["recall"]}}}
    rows = [{"metric": name, "value": 0.5} for name in ("recall", "specificity")]
    with pytest.raises(ValueError, match="table scores declares no metric specificity"):
        Tables(settings, {}).write([str(tmp_path / "scores.csv")], scores=rows)
    Tables(settings, {}).write([str(tmp_path / "scores.csv")], scores=rows[:1])

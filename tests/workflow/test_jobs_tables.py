"""Files of many jobs: each is what it says it is, and so are the rows of tables made from it."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.base.names import KEYS
from burstcast_workflow.harness.job import job_identity, provenance
from burstcast_workflow.harness.storage import write_json, write_netcdf
from burstcast_workflow.jobs.gather import origins
from burstcast_workflow.jobs.tables import Tables, TablesOfCase, as_declared
from burstcast_workflow.tables.registry import plain

CASE = TablesOfCase({}, {"case": "Re400"})
NAMES = ["esn-N30-RV-seed0", "esn-N30-RV-seed1", "esn-N40-SSV-seed0", "equations", "quadratic"]
LABELS = {
    "esn-N30-RV-seed0": ("esn", 30, "RV", 0),
    "esn-N30-RV-seed1": ("esn", 30, "RV", 1),
    "esn-N40-SSV-seed0": ("esn", 40, "SSV", 0),
    "equations": ("equations", None, None, None),
    "quadratic": ("quadratic", None, None, None),
}


def written(directory, wildcards, suffix=".json", rule="horizon", of_job=None):
    text = json.dumps([wildcards, of_job])
    path = directory / f"{abs(hash(text))}-{rule}{suffix}"
    record = provenance(job_identity(rule, wildcards), of_job or {})
    if suffix == ".json":
        write_json(path, {"provenance": record, "value": wildcards.get("forecaster", "")})
    else:
        write_netcdf(path, {}, record)
    return path


def forecaster(name="esn-N30-RV-seed0", case="Re400"):
    return {"case": case, "forecaster": name}


@settings(deadline=None, max_examples=30)
@given(st.permutations(NAMES), st.permutations(["a", "b", "c", "d", "e"]))
def test_rows_are_labelled_by_the_files_in_any_order_and_at_any_place(
    tmp_path_factory, names, places
):
    """A table is the same but for the order of its rows."""
    directory = tmp_path_factory.mktemp("files")
    paths = []
    for name, place in zip(names, places, strict=True):
        paths.append(written(directory, forecaster(name)).rename(directory / f"{place}.json"))
    rows = [{**file.name.keys, **file.content} for file in CASE.gathered(paths)]
    assert [row["value"] for row in rows] == list(names)
    for row in rows:
        assert tuple(row[key] for key in KEYS[2:]) == LABELS[row["value"]]


def test_what_a_job_was_told_is_known_of_its_files(tmp_path):
    plan = {"strategy": "reactive", "settings": {"level": 0.05}}
    wildcards = {"case": "Re400", "controller": "esn-N30-RV-seed0-random", "strategy": "reactive"}
    for suffix in (".json", ".nc"):
        path = written(tmp_path, wildcards, suffix, "control", {"control.run": plan})
        (file,) = CASE.gathered([path])
        keys = file.name.keys
        assert (keys["forecaster"], keys["neurons"], keys["seed"]) == ("random", 30, 0)
        assert file.plan == plan
        assert origins([path])[0].identity == {"rule": "control", **wildcards}


def test_key_columns_of_a_case():
    declared = {"scores": {"columns": ["case", "reynolds*", "value"]}}
    rows = {"scores": [{"value": 1}]}
    for case, parameters, reynolds in (
        ("Re400", {"reynolds": 400}, 400),
        ("lorenz", {"sigma": 10}, None),
    ):
        settings = {"case.parameters": parameters, "tables": declared}
        made = TablesOfCase(settings, {"case": case}).with_keys(rows)
        assert made == {"scores": [{"case": case, "reynolds": reynolds, "value": 1}]}


def test_files_that_do_not_belong_together_are_refused(tmp_path):
    assert CASE.gathered([]) == []
    twice = [written(tmp_path, forecaster(), suffix) for suffix in (".json", ".nc")]
    with pytest.raises(ValueError, match="are both of the job") as error:
        origins(twice)
    assert all(str(path) in str(error.value) for path in twice)
    cases = [written(tmp_path, forecaster(case=case)) for case in ("Re400", "Re600")]
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

"""Files of many jobs, paired with what is asked for by what they say they are."""

import json
import random

import pytest
from burstcast_workflow.gather import NETWORK, by_key, gathered
from burstcast_workflow.job import job_identity, provenance
from burstcast_workflow.storage import write_json, write_netcdf
from hypothesis import given, settings
from hypothesis import strategies as st

NAMES = ["Re400", "Re1000", "alpha", "Zeta", "zeta", "nan", "inf", "1e5x"]


def written(directory, wildcards, suffix=".json", rule="horizon"):
    text = json.dumps(wildcards)
    path = directory / f"{abs(hash(text))}-{rule}{suffix}"
    record = provenance(job_identity(rule, wildcards), {})
    if suffix == ".json":
        write_json(path, {"provenance": record})
    else:
        write_netcdf(path, {}, record)
    return path


def network(case="Re400", neurons=30, validation="RV", seed=0):
    return {"case": case, "neurons": neurons, "validation": validation, "seed": seed}


def wildcards(record):
    return {name: str(value) for name, value in record.items()}


@settings(deadline=None)  # it writes files
@given(st.lists(st.sampled_from(NAMES), min_size=1, unique=True), st.randoms())
def test_files_in_any_order_find_their_records(tmp_path_factory, cases, generator):
    directory = tmp_path_factory.mktemp("files")
    records = [network(case, seed=seed) for case in cases for seed in range(2)]
    paths = {
        (record["case"], record["seed"]): written(directory, wildcards(record))
        for record in records
    }
    shuffled = generator.sample([*paths.values()], len(paths))
    for record, path in gathered(records, shuffled, NETWORK):
        assert path == str(paths[record["case"], record["seed"]])


def test_files_by_their_case(tmp_path):
    records = [{"case": name, "event_threshold": 0.1} for name in NAMES]
    paths = {name: written(tmp_path, {"case": name}, ".nc") for name in NAMES}
    found = by_key(records, random.Random(1).sample([*paths.values()], len(paths)), ("case",))
    assert found == {name: str(path) for name, path in paths.items()}


def test_a_file_too_few_and_one_too_many_are_both_named(tmp_path):
    records = [network(), network(seed=1)]
    paths = [written(tmp_path, wildcards(record)) for record in (network(), network(seed=2))]
    with pytest.raises(ValueError, match="differ") as error:
        gathered(records, paths, NETWORK)
    assert "asked for and not found: case Re400, neurons 30, validation RV, seed 1;" in str(
        error.value
    )
    assert (
        f"found and not asked for: case Re400, neurons 30, validation RV, seed 2 ({paths[1]})"
        in str(error.value)
    )


def test_two_files_of_one_network(tmp_path):
    paths = [written(tmp_path, wildcards(network()), suffix) for suffix in (".json", ".nc")]
    with pytest.raises(ValueError, match="is found twice"):
        gathered([network()], paths, NETWORK)


def test_who_controls_is_told_apart_by_the_rule(tmp_path):
    keys = ("rule", *NETWORK, "prediction_time_lt")
    of_network = {**network(), "prediction_time_lt": 1.5}
    of_case = {"case": "Re400", "prediction_time_lt": 1.5}
    records = [
        {"rule": "control", **of_network},
        {"rule": "control_random", **of_network},
        {"rule": "control_equations", **dict.fromkeys(NETWORK), **of_case},
    ]
    paths = [
        written(tmp_path, wildcards(found), rule=rule)
        for rule, found in (
            ("control_equations", of_case),
            ("control", of_network),
            ("control_random", of_network),
        )
    ]
    pairs = gathered(records, paths, keys)
    assert [path for _, path in pairs] == [str(paths[1]), str(paths[2]), str(paths[0])]


def test_a_file_that_does_not_say_what_it_is(tmp_path):
    write_json(tmp_path / "x.json", {"seed": 1})
    with pytest.raises(ValueError, match=r"x\.json does not say which job wrote it"):
        gathered([network()], [tmp_path / "x.json"], NETWORK)

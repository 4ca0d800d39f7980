"""Files of many jobs, paired with what is asked for by what they say they are."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast_workflow.harness.job import job_identity, provenance
from burstcast_workflow.harness.storage import write_json, write_netcdf
from burstcast_workflow.jobs.gather import gathered

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


def forecaster(case="Re400", name="esn-N30-RV-seed0"):
    return {"case": case, "forecaster": name}


def asked(*identities):
    """What is asked for: identities, with keys of tables that nothing is found by."""
    return [{"identity": identity, "keys": {"row": row}} for row, identity in enumerate(identities)]


def wildcards(identity):
    return {name: str(value) for name, value in identity.items()}


@settings(deadline=None)
@given(st.lists(st.sampled_from(NAMES), min_size=1, unique=True), st.randoms())
def test_files_in_any_order_find_their_records(tmp_path_factory, cases, generator):
    directory = tmp_path_factory.mktemp("files")
    kinds = ("esn-N30-RV-seed0", "equations")
    identities = [forecaster(case, name) for case in cases for name in kinds]
    paths = [written(directory, wildcards(identity)) for identity in identities]
    records = asked(*identities)
    shuffled = generator.sample(paths, len(paths))
    expected = [(record, str(path)) for record, path in zip(records, paths, strict=True)]
    assert gathered(records, shuffled) == expected


def test_a_file_too_few_and_one_too_many_are_both_named(tmp_path):
    one, lacking, strange = (forecaster(name=f"esn-N30-RV-seed{seed}") for seed in range(3))
    paths = [written(tmp_path, wildcards(identity)) for identity in (one, strange)]
    with pytest.raises(ValueError, match="differ") as error:
        gathered(asked(one, lacking), paths)
    assert ('asked for and not found: {"case": "Re400", "forecaster": "esn-N30-RV-seed1"};') in str(
        error.value
    )
    assert (
        'found and not asked for: {"case": "Re400", "forecaster": "esn-N30-RV-seed2"} '
        f"({paths[1]})"
    ) in str(error.value)


def test_two_files_of_one_forecaster(tmp_path):
    paths = [written(tmp_path, wildcards(forecaster()), suffix) for suffix in (".json", ".nc")]
    with pytest.raises(ValueError, match="is found twice"):
        gathered(asked(forecaster()), paths)


def test_one_forecaster_asked_for_twice(tmp_path):
    path = written(tmp_path, wildcards(forecaster()))
    with pytest.raises(ValueError, match="is asked for twice"):
        gathered(asked(forecaster(), forecaster()), [path])


def test_a_file_that_does_not_say_what_it_is(tmp_path):
    write_json(tmp_path / "x.json", {"seed": 1})
    with pytest.raises(ValueError, match=r"x\.json does not say which job wrote it"):
        gathered(asked(forecaster()), [tmp_path / "x.json"])


def test_nothing_is_asked_for(tmp_path):
    assert gathered([], []) == []
    path = written(tmp_path, {"case": "Re400"})
    with pytest.raises(ValueError, match="found and not asked for"):
        gathered([], [path])

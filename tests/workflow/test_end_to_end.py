"""The tiny preset from the equations to the figures, as Snakemake runs it."""

import copy
import json
import re

import netCDF4
import numpy as np
import pytest
import yaml
from helpers_rebuilds import ROOT, TINY, Project, rules_of
from snakemake.utils import update_config

from burstcast.base.files import units
from burstcast.base.files.netcdf import read_attributes, read_netcdf
from burstcast.base.files.tables import read_table

# -- what comes out --------------------------------------------------------------------------------


def test_the_claim_of_the_run_has_all_code(finished):
    claim = json.loads((finished.results / ".run.json").read_text())
    names = {entry.partition(" @")[0] for entry in claim["code"]}
    scripts = {"forecasters/train.py", "evaluation/horizon.py", "tables/joined.py"}
    assert scripts | {"burstcast.networks.readout", "burstcast.systems.mfe"} <= names
    assert "burstcast.systems.lorenz63" not in names


def test_a_committee_of_one_network_controls_as_that_network(finished):
    runs = finished.results / "Re400/control"
    plan = "receding_horizon-decision_interval0.5-horizon1"
    committee, alone = (
        read_netcdf(runs / f"esn-N40-RV-{who}" / name / "flows.nc")
        for who, name in (("committee", f"{plan}-vote_share0.5"), ("seed0", plan))
    )
    assert committee.keys() == alone.keys()
    for variable, values in committee.items():
        np.testing.assert_array_equal(values, alone[variable])
    assert alone["actuated_integration_steps"].sum() > 0


def test_noise_is_in_what_is_observed_and_not_in_the_truth(finished):
    case = finished.results / "Re400"
    states = read_netcdf(case / "ensemble.nc", "state")["state"]
    events = read_netcdf(case / "events.nc")
    sigma = states[:3].reshape(-1, 9).std(axis=0)
    assert len(events["step"]) == 8
    for number in range(8):
        series, step = events["series"][number], events["step"][number]
        assert series >= 3
        true = states[series, step - 2 * 61 - 29 : step + 1]
        energy = 0.5 * (true**2).sum(axis=1)
        np.testing.assert_allclose(events["truth"][number], energy, rtol=1e-14)
        noise = (events["observed"][number] - true) / sigma
        assert noise.std() == pytest.approx(0.01, rel=0.1)


def test_the_search_keeps_its_whole_trace(finished):
    case = finished.results / "Re400"
    for number, validation in enumerate(("RV", "SSV")):
        network = case / "networks" / f"esn-N40-{validation}-seed0"
        trace = read_table(network / "search.csv")
        assert trace["source"].tolist() == ["grid"] * 12 + ["bayesian"] * 3
        assert set(trace["validation"]) == {validation}
        assert sorted(set(trace["tikhonov"])) == [1e-12, 1e-9, 1e-6]
        assert trace["evaluation"].tolist() == sorted(list(range(5)) * 3)
        errors = read_netcdf(case / "scan/esn-N40-seed0/RV+SSV.nc")["log_error"].reshape(
            4, 2, 3, -1
        )
        mean = np.nanmean(errors[:, number].reshape(12, -1), axis=1)
        np.testing.assert_allclose(trace["objective"][:12], mean, rtol=1e-12)


def test_files_say_what_made_them_and_variables_their_units(finished):
    defined = {value for name, value in vars(units).items() if name.isupper()}
    count, numbers = 0, set()
    for path in finished.results.glob("[!.]*/**/*"):
        if path.suffix not in (".nc", ".json"):
            continue
        netcdf, count = path.suffix == ".nc", count + 1
        record = read_attributes(path) if netcdf else json.loads(path.read_text())["provenance"]
        assert set(record) >= {"source", "rule", "settings", "numpy", "scipy", "llvmlite"}, path
        assert str(finished.directory) not in json.dumps(record)
        for name, (unit, kind) in described(path).items() if netcdf else ():
            # a forecaster's coefficients belong to quantities of all kinds
            assert (unit is None) == (path.name == "forecaster.nc"), (path, name)
            if unit is not None:
                assert unit in defined, (path, name)
                assert (unit == units.LYAPUNOV_TIMES) == name.endswith("_lt"), (path, name)
                assert unit == units.NUMBER or kind == "f", (path, name)
            if unit == units.NUMBER and kind == "f":
                numbers.add(name)
    assert count > 20
    nrmse = {"nrmse_u", "nrmse_uu", "nrmse_uv"}
    assert numbers == nrmse | {"log_error", "mean_log_error"}


def described(path):
    """Units and kind of numbers of the variables of a file, by name."""
    with netCDF4.Dataset(path) as file:
        return {
            name: (getattr(variable, "units", None), variable.dtype.kind)
            for name, variable in file.variables.items()
        }


def test_nothing_is_written_outside_of_the_results(finished):
    before = {path.name for path in finished.directory.iterdir()}
    assert before == {
        *("Snakefile", "config.yaml", "profiles", "resources", "src", "workflow"),
        *("results", ".snakemake", ".burstcast_cache"),
    }
    assert [path.name for path in finished.results.parent.iterdir()] == ["tiny"]


# -- mistakes --------------------------------------------------------------------------------------


FEW = {"laminarisation_threshold": 0.25}
COMPUTED = {"lyapunov": {"given_exponent": None}}
SCAN = "scan", "scan/esn-N30-seed0/RV+SSV.csv"
MISTAKES = {  # by the case that has it: job, target, settings, message
    "many_tests": (
        *("evaluation_set", "evaluation_set.nc", {"test_series": 37, **FEW}),
        r"training.series is 3 and test_series is 37, but only 3\d series did not laminarise",
    ),
    "many_of_lyapunov": (
        *("lyapunov", "lyapunov.json", {"lyapunov": {"series": 39}, **FEW}),
        r"lyapunov.series is 39, but only 3\d series",
    ),
    "many_in_training": (
        *(*SCAN, {"training": {"series": 39}, "test_series": 1, **FEW}),
        r"training.series is 39, but only 3\d series",
    ),
    "many_intervals": (
        *(*SCAN, {**COMPUTED, "recycle_validation": {"intervals_per_series": 50}}),
        r"recycle_validation.intervals_per_series, .*: 50 validation intervals .* only \d int",
    ),
    "always_events": (
        *("events", "events.nc", {"event_threshold": 0.02}),
        "event_threshold is 0.02, but it must exceed the mean of the observable",
    ),
    "all_laminar": (
        *("simulate", "ensemble.nc"),
        {"laminarisation_threshold": 0.01, "event_threshold": 0.001},
        "all 40 series exceeded laminarisation_threshold, 0.01",
    ),
}


def test_the_first_job_that_knows_of_a_mistake_names_the_setting(job_server, tmp_path):
    project = Project.create(tmp_path / "project", job_server)
    case = yaml.safe_load((ROOT / TINY).read_text())["cases"]["Re400"]
    case |= {"parameters": {"reynolds": 400}, "lyapunov": {"given_exponent": 0.0163}}
    cases = {name: copy.deepcopy(case) for name in MISTAKES}
    for name, (_, _, settings, _) in MISTAKES.items():
        update_config(cases[name], settings)
    networks = {"esn": {"neurons": [30, 40], "validation": ["SSV", "RV"], "seeds": 1}}
    outcome = project.snakemake(
        *(f"results/tiny/{name}/{target}" for name, (_, target, _, _) in MISTAKES.items()),
        overlay={"cases": cases, "campaign": [{"cases": list(cases), "forecasters": networks}]},
    )
    assert outcome.status == 1
    for name, (rule, _, _, message) in MISTAKES.items():
        failure = re.compile(rf"^{rule} \(case={name}\b.*\) failed: ValueError: {message}", re.M)
        assert len(failure.findall(outcome.text)) == 1, outcome.text
    before = {"event_threshold", "time_unit"}
    assert rules_of(set(project.logs())) - before == {rule for rule, *_ in MISTAKES.values()}


def test_forecasts_that_do_not_fit_a_computed_lyapunov_time(finished, tmp_path):
    project = finished.copy(tmp_path / "project")
    settings = {
        "evaluation_set": ("evaluation_set.nc", "classification.longest_prediction_time_lt"),
        "events": ("events.nc", "horizon.longest_lead_time_lt"),
    }
    outcome = project.snakemake(
        *(f"results/tiny/Re400/{file}" for file, _ in settings.values()),
        overlay={
            "cases": {"Re400": COMPUTED},
            "classification": {"longest_prediction_time_lt": 100},
            "horizon": {"longest_lead_time_lt": 100},
        },
    )
    assert outcome.status == 1
    for rule, (_, setting) in settings.items():
        (failure,) = re.findall(rf"^{rule} \(.*\) failed: ValueError: (.*)$", outcome.text, re.M)
        assert setting in failure

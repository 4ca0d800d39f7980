"""The tiny preset from the equations to the figures, as Snakemake runs it."""

import json
import math
import re

import netCDF4
import numpy as np
import pytest
import yaml
from helpers_rebuilds import ROOT, TINY, Project, digests, jobs_since, rules_of

from burstcast.base.files import units
from burstcast.base.files.netcdf import read_attributes, read_netcdf
from burstcast.base.files.tables import read_table


def table(run, name):
    return read_table(run.results / "tables" / f"{name}.csv")


def results(project):
    """Digests of all that a run computes; logs and benchmarks tell the time."""
    return {
        name: digest
        for name, digest in digests(project.results).items()
        if name.split("/")[0] != "logs"
    }


# -- what comes out --------------------------------------------------------------------------------


def test_the_claim_of_the_run_has_all_code(finished):
    claim = json.loads((finished.results / ".run.json").read_text())
    names = {entry.partition(" @")[0] for entry in claim["code"]}
    scripts = {"forecasters/train.py", "evaluation/horizon.py", "tables/joined.py"}
    assert scripts | {"burstcast.networks.readout", "burstcast.systems.mfe"} <= names
    assert "burstcast.systems.lorenz63" not in names


def test_a_perfect_forecaster_is_perfect_and_a_noisy_one_nearly(finished):
    rows = table(finished, "classification")
    perfect, noisy = (rows[rows["forecaster"] == name] for name in ("equations", "equations_noisy"))
    assert (perfect[["precision", "recall", "f_score"]] == 1).all(axis=None)
    assert perfect["neurons"].isna().all()
    counts = ["true_positive", "false_positive", "false_negative", "true_negative"]
    # the same points count, whoever forecasts
    assert perfect[counts].sum(axis=1).tolist() == noisy[counts].sum(axis=1).tolist()
    assert noisy["f_score"].mean() < 1
    horizons = table(finished, "horizon").set_index("forecaster")["mean_horizon_lt"]
    assert horizons["equations"] == 2  # the longest that is asked for
    assert horizons["esn"].max() < horizons["equations_noisy"] <= 2


def test_classification_is_counted_from_the_series_themselves(finished):
    """Counts of one network at every prediction time, from the ensemble and its forecasts."""
    case = finished.results / "Re400"
    ensemble = read_netcdf(case / "ensemble.nc")
    test_set = read_netcdf(case / "evaluation_set.nc")
    forecast = read_netcdf(case / "networks" / "esn-N40-RV-seed0" / "forecast.nc")
    rows = table(finished, "classification")
    rows = rows[(rows["neurons"] == 40) & (rows["validation"] == "RV")]
    energy = 0.5 * (ensemble["state"][3:15] ** 2).sum(axis=2)  # after the training series
    for row in rows.to_dict("records"):
        time = row["prediction_time_lt"]
        counts = dict.fromkeys(["tp", "fp", "fn", "tn"], 0)
        for point, (series, step) in enumerate(
            zip(test_set["series"], test_set["step"], strict=True)
        ):
            observed = 0.5 * (test_set["washout"][point] ** 2).sum(axis=1)
            assert len(observed) == 30
            if observed.max() >= 0.07:
                continue
            window = energy[series, step + math.floor(61 * time) : step + 61 * (time + 1) + 1]
            happened = window[0] < 0.07 <= window.max()
            first, last = round(2 * time) - 1, round(2 * time) + 1
            largest = forecast["largest"][point, first:last].max()
            predicted = forecast["first"][point, first] < 0.07 <= largest
            counts[("t" if predicted == happened else "f") + ("p" if predicted else "n")] += 1
        names = ("true_positive", "false_positive", "false_negative", "true_negative")
        assert [row[name] for name in names] == list(counts.values())
        assert sum(counts.values()) > 20


def test_a_committee_of_one_network_controls_as_that_network(finished):
    runs = finished.results / "Re400" / "control"
    plan = "receding_horizon-decision_interval0.5-horizon1"
    alone = runs / "esn-N40-RV-seed0" / plan
    committee = runs / "esn-N40-RV-committee" / f"{plan}-vote_share0.5"
    ours, theirs = read_netcdf(committee / "flows.nc"), read_netcdf(alone / "flows.nc")
    assert ours.keys() == theirs.keys()
    for variable, values in ours.items():
        np.testing.assert_array_equal(values, theirs[variable])
    assert theirs["actuated_integration_steps"].sum() > 0


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


def test_the_search_keeps_its_whole_trace_and_the_standard_errors_of_the_intervals(finished):
    case = finished.results / "Re400"
    for validation in ("RV", "SSV"):
        network = case / "networks" / f"esn-N40-{validation}-seed0"
        trace = read_table(network / "search.csv")
        assert trace["source"].tolist() == ["grid"] * 12 + ["bayesian"] * 3
        assert set(trace["validation"]) == {validation}
        assert sorted(set(trace["tikhonov"])) == [1e-12, 1e-9, 1e-6]
        assert trace["evaluation"].tolist() == sorted(list(range(5)) * 3)
        excess = trace["objective"] - trace["objective"].min()
        np.testing.assert_allclose(trace["excess"], excess, rtol=0, atol=1e-12)
        chosen = json.loads((network / "hyperparameters.json").read_text())
        assert chosen["objective"] == trace["objective"].min()
        attributes = read_attributes(network / "forecaster.nc")
        for name in ("spectral_radius", "input_scaling", "tikhonov"):
            assert attributes[name] == chosen[name]
    trace = read_table(case / "networks" / "esn-N40-RV-seed0" / "search.csv")
    errors = read_netcdf(case / "scan" / "esn-N40-seed0" / "RV+SSV.nc")["log_error"]
    of_grid = errors[np.tile(np.repeat([True, False], 3), 4)]  # RV, then SSV, at each point
    assert of_grid.shape[1] > 1
    np.testing.assert_allclose(of_grid.mean(axis=1), trace["objective"][:12], rtol=1e-12)
    error = of_grid.std(axis=1, ddof=1) / np.sqrt(of_grid.shape[1])
    np.testing.assert_allclose(trace["standard_error"][:12], error, rtol=1e-12)


def test_files_say_what_made_them(finished):
    count = 0
    for path in finished.results.glob("[!.]*/**/*"):
        if path.suffix == ".nc":
            record = read_attributes(path)
        elif path.suffix == ".json":
            record = json.loads(path.read_text())["provenance"]
        else:
            continue
        count += 1
        assert set(record) >= {"source", "rule", "settings", "numpy", "scipy", "llvmlite"}, path
        assert str(finished.directory) not in json.dumps(record)
    assert count > 20


def test_all_variables_have_their_units(finished):
    defined = {value for name, value in vars(units).items() if name.isupper()}
    numbers = set()
    for path in finished.results.rglob("*.nc"):
        with netCDF4.Dataset(path) as file:
            for name, variable in file.variables.items():
                unit = getattr(variable, "units", None)
                # a forecaster's coefficients belong to quantities of all kinds
                assert (unit is None) == (path.name == "forecaster.nc"), (path, name)
                assert unit in {None, *defined}, (path, name)
                if unit is not None:
                    assert (unit == units.LYAPUNOV_TIMES) == name.endswith("_lt"), (path, name)
                    assert unit == units.NUMBER or variable.dtype.kind == "f", (path, name)
                if unit == units.NUMBER and variable.dtype.kind == "f":
                    numbers.add(name)
    nrmse = {"nrmse_u", "nrmse_uu", "nrmse_uv"}
    assert numbers == nrmse | {"log_error", "mean_log_error"}


def test_nothing_is_written_outside_of_the_results(finished):
    before = {path.name for path in finished.directory.iterdir()}
    assert before == {
        *("Snakefile", "config.yaml", "profiles", "resources", "src", "workflow"),
        *("results", ".snakemake", ".burstcast_cache"),
    }
    assert [path.name for path in finished.results.parent.iterdir()] == ["tiny"]


# -- running it again ------------------------------------------------------------------------------


def test_a_second_run_does_nothing_and_what_is_left_are_the_figures(finished, tmp_path):
    project = finished.copy(tmp_path / "project")
    logs = project.logs()
    outcome = project.made("forecasters", "tables")
    assert "Nothing to be done" in outcome.text
    assert project.logs() == logs
    jobs = project.dry_run()
    assert set(jobs) == {"examples", "flow_event", "suppressed_event", "figure", "report_page"}
    assert jobs["figure"] > 15


def test_a_deleted_network_rebuilds_its_chain_only(finished, tmp_path):
    project = finished.copy(tmp_path / "project")
    before, logs = results(project), project.logs()
    (project.results / "Re400/networks/esn-N30-SSV-seed0/forecaster.nc").unlink()
    project.made("forecasters", "tables")
    ran = jobs_since(logs, project.logs())
    network = "esn-N30-SSV-seed0.log"
    of_network = {name for name in ran if name.endswith(network)}
    assert of_network == {f"train/Re400/{network}"} | {
        f"{rule}/Re400/networks/{network}"
        for rule in ("forecast", "calibration_forecast", "horizon")
    }
    tables = {
        *("probability_scores", "reliability_table", "lead_times"),
        *("classification_table", "horizon_table", "warnings_table"),
    }
    joined = {f"joined_{name}" for name in ("probabilities", "forecasts", "horizon", "warnings")}
    assert rules_of(ran - of_network) <= {"calibrate", *tables, *joined}
    assert results(project) == before


def test_one_core_gives_the_same_bits_as_two(finished, tmp_path, monkeypatch):
    monkeypatch.setenv("BURSTCAST_TEST_CORES", "1")
    project = finished.without_results(tmp_path / "project")
    names = ("dataset", "classification", "horizon")
    project.made(*(f"results/tiny/tables/{name}.csv" for name in names))
    alone = results(project)
    together = results(finished)
    assert len(alone) > 30
    assert alone == {name: together[name] for name in alone}


def test_a_target_builds_what_it_needs_and_no_server_is_needed_for_it(finished, tmp_path):
    # jobs in processes of their own, as users run them
    project = Project(finished.without_results(tmp_path / "project").directory)
    project.made("results/tiny/tables/data_generation_parameters.csv")
    assert rules_of(set(project.logs())) == {"simulate", "data_generation_parameters"}
    alone, together = results(project), results(finished)
    # the data, its summary, the table and its LaTeX
    assert len(alone) == 4
    assert alone == {name: together[name] for name in alone}


# -- mistakes --------------------------------------------------------------------------------------


def test_a_bad_config_stops_before_any_job(finished, tmp_path):
    project = finished.without_results(tmp_path / "project")
    outcome = project.snakemake(overlay={"horizon": {"evnts": 3}})
    assert outcome.status == 1
    assert outcome.text.count("horizon.evnts: unknown setting; did you mean events?") == 1
    assert "Traceback" not in outcome.text
    assert "src/burstcast_workflow" not in outcome.text
    assert not (project.directory / "results").exists()


COMPUTED = {"lyapunov": {"given_exponent": None}}
FEW = {"laminarisation_threshold": 0.25}
SCAN = "scan", "scan/esn-N30-seed0/RV+SSV.csv"


@pytest.mark.parametrize(
    ("rule", "target", "case", "message"),
    [
        (
            *("evaluation_set", "evaluation_set.nc", {"test_series": 37, **FEW}),
            "training.series is 3 and test_series is 37, but only 34 series did not laminarise",
        ),
        (
            *("lyapunov", "lyapunov.json", {"lyapunov": {"series": 35}, **FEW}),
            "lyapunov.series is 35, but only 34 series",
        ),
        (
            *(*SCAN, {"training": {"series": 39}, "test_series": 1, **FEW}),
            "training.series is 39, but only 34 series",
        ),
        (
            *(*SCAN, {**COMPUTED, "recycle_validation": {"intervals_per_series": 50}}),
            r"recycle_validation.intervals_per_series, .*: 50 validation intervals .* only \d int",
        ),
        (
            *("events", "events.nc", {"event_threshold": 0.02}),
            "event_threshold is 0.02, but it must exceed the mean of the observable",
        ),
        (
            *("simulate", "ensemble.nc"),
            {"laminarisation_threshold": 0.01, "event_threshold": 0.001},
            "all 40 series exceeded laminarisation_threshold, 0.01",
        ),
    ],
)
def test_the_first_job_that_knows_of_a_mistake_names_the_setting(
    finished, tmp_path, rule, target, case, message
):
    project = finished.copy(tmp_path / "project")
    overlay = {"cases": {"Re400": case}}
    logs = project.logs()
    outcome = project.snakemake(f"results/tiny/Re400/{target}", overlay=overlay)
    assert outcome.status == 1
    failure = re.compile(rf"^{rule} \(.*\) failed: ValueError: {message}", re.M)
    assert len(failure.findall(outcome.text)) == 1, outcome.text
    assert rules_of(jobs_since(logs, project.logs())) <= {"simulate", "lyapunov", rule}


def test_forecasts_that_do_not_fit_a_computed_lyapunov_time(finished, tmp_path):
    project = finished.copy(tmp_path / "project")
    overlay = {
        "cases": {"Re400": COMPUTED},
        "classification": {"longest_prediction_time_lt": 100},
        "horizon": {"longest_lead_time_lt": 100},
    }
    for rule, file, setting in (
        ("evaluation_set", "evaluation_set.nc", "classification.longest_prediction_time_lt"),
        ("events", "events.nc", "horizon.longest_lead_time_lt"),
    ):
        outcome = project.snakemake(f"results/tiny/Re400/{file}", overlay=overlay)
        assert outcome.status == 1
        (failure,) = re.findall(rf"^{rule} \(.*\) failed: ValueError: (.*)$", outcome.text, re.M)
        assert setting in failure


# -- another system --------------------------------------------------------------------------------

LORENZ = yaml.safe_load("""
    results: results/lorenz
    campaign:
      - cases: [lorenz63]
        forecasters: {esn: {neurons: [40], validation: [RV], seeds: 1}, equations_noisy: {}}
    cases:
      lorenz63:
        system: lorenz63
        ensemble: {duration: 30, transient: 20}
        test_series: 10
        recycle_validation: {series: 2, intervals_per_series: 3}
    control: {forecasters: {esn: null, equations: null}}
    statistics: {duration: 20}
    figures: {example_case: lorenz63}
""")


@pytest.fixture(scope="module")
def lorenz(finished, tmp_path_factory):
    project = finished.without_results(tmp_path_factory.mktemp("lorenz") / "project")
    names = ("dataset", "classification", "horizon")
    project.made(*(f"results/lorenz/tables/{name}.csv" for name in names), overlay=LORENZ)
    return project.directory / "results" / "lorenz"


def test_another_system_is_one_case_in_the_config(lorenz):
    (dataset,) = read_table(lorenz / "tables" / "dataset.csv").to_dict("records")
    assert dataset["case"] == "lorenz63"
    assert not {"reynolds", "lyapunov_exponent_given"} & set(dataset)  # of the shear flow alone
    assert dataset["series_kept"] == 40
    assert dataset["lyapunov_exponent"] == pytest.approx(0.906, rel=0.15)
    assert dataset["mean_observable"] == pytest.approx(23.5, rel=0.03)
    steps = dataset["steps_per_lyapunov_time"]
    assert steps == math.floor(1 / (0.02 * dataset["lyapunov_exponent"]))

    scores = read_table(lorenz / "tables" / "classification.csv")
    assert "reynolds" not in scores
    early = scores[(scores["forecaster"] == "esn") & (scores["prediction_time_lt"] == 1)]
    counts = early[["true_positive", "false_positive", "false_negative", "true_negative"]]
    assert counts.to_numpy().sum() > 50
    assert early["f_score"].iloc[0] > 0.5  # z of the Lorenz system is easily predicted
    horizons = read_table(lorenz / "tables" / "horizon.csv")
    assert horizons["events"].tolist() == [8, 8]


def test_the_computed_exponent_is_the_unit_of_time(lorenz):
    exponent = json.loads((lorenz / "lorenz63" / "lyapunov.json").read_text())["leading"]["mean"]
    steps = math.floor(1 / (0.02 * exponent))
    test_set = read_netcdf(lorenz / "lorenz63" / "evaluation_set.nc", "step", "washout")
    assert test_set["washout"].shape[1:] == (steps // 2, 3)
    assert set(np.diff(test_set["step"][:4])) == {steps}


def test_it_may_stand_beside_the_shear_flow(finished, tmp_path):
    project = finished.without_results(tmp_path / "project")
    both = [*yaml.safe_load((ROOT / TINY).read_text())["campaign"], *LORENZ["campaign"]]
    jobs = project.dry_run(overlay={"cases": LORENZ["cases"], "campaign": both})
    assert [jobs[rule] for rule in ("simulate", "train", "lyapunov")] == [2, 5, 2]

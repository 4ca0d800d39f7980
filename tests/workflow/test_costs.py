"""Predictions of the cost model: what schedulers are asked for, the time left, and the report."""

import copy
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from helpers_configs import predicted_costs

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.costs.model import (
    CLASSES,
    RULE_COSTS,
    SAFETY,
    SECONDS_PER,
    SNAKEMAKE_MIB,
    Cost,
    CostModel,
    ratios,
)
from burstcast_workflow.costs.records import (
    beyond_memory,
    costs_of_jobs,
    costs_of_plan,
    costs_text,
    main,
)
from burstcast_workflow.start import names_of_rules
from snaketrust.plan import planned

ROOT = Path(__file__).parents[2]
PAPER = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
PRESETS = sorted(path.stem for path in (ROOT / "workflow" / "presets").glob("*.yaml"))
NETWORK = {"case": "Re400", "forecaster": "esn-N2000-RV-seed0"}
PLAN = "prediction_triggered-prediction_time2-window1"
CONTROL = {"case": "Re400", "controller": "esn-N2000-RV-seed0", "strategy": PLAN}
WILDCARDS = {
    "search_grid": {"case": "Re400", "reservoir": "esn-N2000-seed0", "strategies": "RV+SSV"},
    "control": CONTROL,
    "gather": {},
    "figure": {"figure": "by_reynolds", "of_case": ""},
}


def model(**changes) -> CostModel:
    """Costs of the paper's campaign, with single settings changed (case_defaults__...=...)."""
    config = copy.deepcopy(PAPER)
    for name, value in changes.items():
        *parents, last = name.split("__")
        place = config
        for parent in parents:
            place = place.setdefault(parent, {})
        place[last] = value
    return CostModel(Campaign(load(config)))


def predicted(cost_class, costs=None, **wildcards) -> Cost:
    """Cost of a job of that class, with some wildcards changed."""
    usual = WILDCARDS.get(cost_class, NETWORK)
    return (costs or model()).predicted(cost_class, {**usual, **wildcards})


@pytest.fixture(scope="module")
def directory(tmp_path_factory) -> Path:
    """A directory without results to plan campaigns in."""
    found = tmp_path_factory.mktemp("campaign")
    shutil.copy(ROOT / "config.yaml", found)
    return found


def options(directory: Path, preset: str | None = None) -> list[str]:
    overlay = ["--configfile", str(ROOT / "workflow" / "presets" / f"{preset}.yaml")]
    project = ["--snakefile", str(ROOT / "Snakefile"), "--directory", str(directory)]
    return [*project, *(overlay if preset else [])]


@pytest.fixture(scope="module")
def plan(directory):
    """The paper's campaign, planned."""
    return planned([*options(directory), "--forceall"])


@pytest.fixture(scope="module")
def paper(plan):
    """Costs of the rules of the paper's campaign."""
    return costs_of_plan(plan)


# -- classes ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("cost_class", CLASSES)
def test_every_class_has_a_prediction(cost_class):
    cost = predicted(cost_class)
    assert 0.5 < cost.seconds < 150
    assert 50 < cost.memory_mib < 2048


@pytest.mark.parametrize(
    ("cost_class", "changes"),
    [
        ("integration", {"case_defaults__ensemble__series": 4000}),
        ("tangent", {"case_defaults__ensemble__duration": 8000}),
        ("search_points", {"search__bayesian_points": 18}),
        ("forecast", {"cases__Re400__test_series": 300}),
        ("horizon", {"horizon__events": 1000}),
        ("long_term", {"statistics__duration": 8000}),
        ("spectrum", {"statistics__lyapunov_exponents": 20}),
        ("control", {"control__span_lt": 40}),
    ],
)
def test_twice_the_work_takes_twice_the_time(cost_class, changes):
    seconds = predicted(cost_class).seconds
    assert predicted(cost_class, model(**changes)).seconds / seconds == pytest.approx(2, rel=0.2)


def test_larger_networks_take_more_time_and_memory():
    small, large = (predicted("forecast", forecaster=f"esn-N{n}-RV-seed0") for n in (2000, 4000))
    assert large.seconds / small.seconds == pytest.approx(2, rel=0.1)
    small, large = (predicted("search_grid", reservoir=f"esn-N{n}-seed0") for n in (5000, 10_000))
    assert 2**2 < large.seconds / small.seconds < 2**3
    gram_mib = (10_000**2 - 5000**2) * 8 / 2**20
    assert 3 * gram_mib < large.memory_mib - small.memory_mib < 8 * gram_mib


def test_other_kinds_of_forecasters_cost_what_the_equations_cost():
    for cost_class, who in (("forecast", "forecaster"), ("control", "controller")):
        kinds = ("equations", "equations_noisy", "persistence")
        assert len({predicted(cost_class, **{who: kind}) for kind in kinds}) == 1


def test_a_filter_costs_its_members_over_the_washout_and_the_forecast():
    kinds = "quadratic", "quadratic_filtered"
    plain, filtered = (predicted("forecast", forecaster=kind) for kind in kinds)
    half = predicted("forecast", model(forecasters__filter__members=20), forecaster=kinds[1])
    # washouts of 30 steps and forecasts of 366, from 9000 starting points with four steps each of
    # the equations, which take what 13 neurons do
    steps = SECONDS_PER["neuron step"] * 13 * 9000 * 4 * (30 + 366)
    assert filtered.seconds - half.seconds == pytest.approx(20 * steps, rel=0.02)
    assert plain.memory_mib < half.memory_mib < filtered.memory_mib


def test_control_costs_its_flows_and_the_forecasts_of_all_that_vote():
    at_random = predicted("control", controller="esn-N2000-RV-seed0-random")
    assert at_random.seconds < predicted("control").seconds
    settings = {"horizon_lt": [2, 4], "decision_interval_lt": [0.25, 0.5], "vote_share": [0.5]}
    block = {"strategy": "receding_horizon", "settings": settings, "committee": True}
    esn = {"neurons": [2000], "validation": ["RV"], "seeds": 5}
    costs = model(
        campaign=[{"reynolds": [400], "forecasters": {"esn": esn}}],
        control__strategies=[{**block, "forecasters": {"esn": {}}}],
    )

    def seconds(controller, horizon, interval):
        name = f"receding_horizon-decision_interval{interval}-horizon{horizon}-vote_share0.5"
        return predicted("control", costs, controller=controller, strategy=name).seconds

    one = seconds("esn-N2000-RV-seed0", 2, 0.25)
    assert seconds("esn-N2000-RV-committee", 2, 0.25) / one == pytest.approx(5, rel=0.1)
    assert one / seconds("esn-N2000-RV-seed0", 2, 0.5) == pytest.approx(2, rel=0.1)
    assert seconds("esn-N2000-RV-seed0", 4, 0.25) / one == pytest.approx(4.5 / 2.5, rel=0.1)


def test_prediction_does_not_depend_on_what_was_asked_before():
    costs = model()
    names = [f"esn-N{n}-RV-seed{seed}" for n, seed in ((500, 0), (3000, 0), (500, 7))]
    first, larger, again = (predicted("training", costs, forecaster=name) for name in names)
    assert first == again != larger
    assert predicted("training", forecaster=names[0]) == first
    earlier = PLAN.replace("time2", "time1")
    assert predicted("control", costs, strategy=earlier) != predicted("control", costs)
    # a Lyapunov time that is not known yet, and a class that there is not
    unknown = model(case_defaults__lyapunov__time_unit="computed")
    assert predicted("forecast", unknown).seconds > 1
    with pytest.raises(KeyError, match="closed_lop"):
        costs.predicted("closed_lop", NETWORK)


# -- what is asked for -----------------------------------------------------------------------------


@pytest.mark.parametrize("cost_class", ["search_grid", "integration", "gather"])
def test_requests_leave_a_margin_and_double_at_each_retry(cost_class):
    cost = predicted(cost_class)
    memory = [cost.mib_for(attempt) for attempt in (1, 2, 3)]
    minutes = [cost.minutes_for(attempt) for attempt in (1, 2, 3)]
    assert SAFETY == 2
    assert memory[0] == math.ceil(SAFETY * cost.memory_mib + SNAKEMAKE_MIB)
    assert minutes[0] * 60 >= SAFETY * cost.seconds
    for requests in (memory, minutes):
        assert all(type(request) is int for request in requests)
        assert requests == [requests[0], 2 * requests[0], 4 * requests[0]]


def test_rules_ask_for_what_is_predicted(directory):
    workflow = planned([*options(directory, "tiny"), "--forceall"])
    asked = [*costs_of_jobs(workflow.dag.jobs, names_of_rules(workflow)["costs"])]
    for job, cost in asked:
        assert job.resources["mem_mb"] == cost.mib_for(1)
        assert job.resources["runtime"] == cost.minutes_for(1)
    assert len(asked) == sum(bool(job.output) for job in workflow.dag.jobs)


# -- campaigns -------------------------------------------------------------------------------------


def test_totals_of_the_papers_campaign_are_those_that_the_benchmark_has_written(paper, plan):
    text = (ROOT / "benchmarks" / "measured.md").read_text(encoding="utf-8")
    _, section = text.split("<!-- predicted: begin -->")
    units = re.findall(r"^\| ([a-z ]+) \| ([-+.e\d]+) \| ([-+.e\d]+) \|$", section, re.M)
    assert {unit: float(ours) for unit, _, ours in units} == SECONDS_PER
    measured = {unit: float(rate) for unit, rate, _ in units}
    assert costs_text(costs_of_plan(plan, measured)) in section
    # the rates of the model itself are of a similar machine
    total = float(re.findall(r"on one core: ([.\d]+)", section)[0])
    assert paper["predicted_minutes"].sum() == pytest.approx(total, rel=0.1)


def test_budget_of_memory_and_time_of_the_papers_campaign(paper):
    assert paper["predicted_memory_mib"].max() < 2048
    assert paper["predicted_longest_seconds"].max() < 300
    tables = paper[paper["rule"].str.endswith("_table")]
    assert tables["predicted_longest_seconds"].max() < 60
    assert tables["predicted_memory_mib"].max() < 400


@pytest.mark.long
def test_every_preset_and_every_job_has_a_prediction_and_small_campaigns_cost_less(
    paper, directory
):
    totals = {"paper": paper["predicted_minutes"].sum()}
    for preset in PRESETS:
        jobs = predicted_costs(options(directory, preset))
        assert {"simulate", "scan", "search", "train", "forecast"} <= {*jobs["rule"]}
        for column in ("predicted_minutes", "predicted_memory_mib"):
            assert jobs[column].between(0, math.inf, inclusive="neither").all()
        totals[preset] = jobs["predicted_minutes"].sum()
    assert totals["tiny"] < totals["quick"] / 2 < totals["paper"] / 9


# -- records ---------------------------------------------------------------------------------------


def write_record(path, seconds, memory):
    path.parent.mkdir(parents=True, exist_ok=True)
    columns = {"s": seconds, "h:m:s": "0:00:01", "max_rss": memory}
    path.write_text("\n".join("\t".join(map(str, row)) for row in (columns, columns.values())))


def test_records_stand_beside_the_predictions_of_their_jobs(tmp_path, capsys):
    shutil.copy(ROOT / "config.yaml", tmp_path)
    arguments = options(tmp_path, "tiny")
    workflow = planned([*arguments, "--forceall"])
    assert costs_of_plan(workflow)["records"].sum() == 0
    root = tmp_path / "results" / "tiny"
    for validation, seconds, memory in (("RV", 1000, 70), ("SSV", 3000, 71)):
        record = root / "benchmarks" / "train" / "Re400" / f"esn-N30-{validation}-seed0.tsv"
        write_record(record, seconds, memory)
    write_record(root / "benchmarks" / "classification_table" / "Re400.tsv", 0.001, "-")
    # of another campaign
    write_record(root / "benchmarks" / "train" / "Re400" / "esn-N77-RV-seed0.tsv", 1, 1)
    output = root / "Re400" / "esn-N30-RV-seed0" / "forecaster.nc"
    output.parent.mkdir(parents=True)
    output.write_bytes(bytes(3 * 2**20))
    rows = costs_of_plan(workflow).set_index("rule")
    in_rules = [rule.name for rule in workflow.rules if rule.name in rows.index]
    assert rows.index.tolist() == in_rules
    assert rows["jobs"].sum() == sum(bool(job.output) for job in workflow.dag.jobs)
    measured = ["records", "median_seconds", "minutes", "longest_seconds", "memory_mib"]
    assert rows.loc["train", measured].tolist() == [2, 2000, 4000 / 60, 3000, 71]
    assert rows.loc["train", "disk_mib"] == 3
    assert rows.loc["classification_table", "memory_mib"] == 0
    assert rows.loc["scan", measured[1:]].isna().all()
    main(arguments)
    lines = {line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines()}
    assert lines["train"][5:7] == ["2", "2000.0"]
    assert len(lines["scan"]) == 6  # nothing was measured


def test_an_earlier_campaign_corrects_the_times_of_the_next(tmp_path, capsys):
    columns = "rule,records,median_seconds,predicted_median_seconds"
    rows = ["train,3,6.0,2.0", "search,2,0.1,20.0", "scan,0,,"]  # search came from a cache
    table = tmp_path / "results" / "other" / "benchmarks" / RULE_COSTS
    table.parent.mkdir(parents=True)
    table.write_text("\n".join([columns, *rows]))
    assert ratios(table) == {"train": 3.0, "search": 0.5}
    shutil.copy(ROOT / "config.yaml", tmp_path)
    workflow = planned([*options(tmp_path, "tiny"), "--forceall"])
    costs = names_of_rules(workflow)["costs"]
    by_rule = {job.rule.name: (job, cost) for job, cost in costs_of_jobs(workflow.dag.jobs, costs)}
    for rule, factor in {"train": 3.0, "search": 0.5, "scan": 1.0}.items():
        job, cost = by_rule[rule]
        plain = costs.predicted(costs.classes[rule], job.wildcards_dict)
        assert cost.seconds == pytest.approx(factor * plain.seconds)
        assert cost.memory_mib == plain.memory_mib
        assert job.resources["runtime"] == cost.minutes_for(1)
    # what is written for the next campaign is not corrected twice
    written = costs_of_plan(workflow).set_index("rule")["predicted_longest_seconds"]
    assert written["search"] == pytest.approx(2 * by_rule["search"][1].seconds, rel=0.1)
    main(options(tmp_path, "tiny"))
    assert "corrected by an earlier campaign: " in capsys.readouterr().out


def test_a_network_whose_gram_matrix_does_not_fit_is_named():
    jobs = []
    for cost_class, neurons in [("training", 3000), ("training", 500), ("forecast", 9000)]:
        name = {"case": "Re400", "forecaster": f"esn-N{neurons}-RV-seed0"}
        job = SimpleNamespace(rule=SimpleNamespace(name="train"), wildcards_dict=name)
        jobs.append((job, predicted(cost_class, **name)))
    matrix_mib = 3000**2 * 8 / 2**20
    assert beyond_memory(jobs, matrix_mib) == beyond_memory([], 1) == ""
    found = beyond_memory(jobs, 0.99 * matrix_mib)
    assert found.startswith("train of Re400, esn-N3000-RV-seed0 cannot run")
    assert "takes 0.1 GiB" in found
    # what only restores a network does not train it
    assert beyond_memory(jobs[2:], 1) == ""


def test_a_run_that_does_not_fit_leaves_the_results_as_they_were(tmp_path):
    results = tmp_path / "results" / "huge"
    results.mkdir(parents=True)
    (results / "notes.txt").write_text("mine")
    esn = {"neurons": [100_000], "validation": ["RV"], "seeds": 1}
    overlay = tmp_path / "huge.yaml"
    block = {"reynolds": [400], "forecasters": {"esn": esn}}
    overlay.write_text(yaml.safe_dump({"results": "results/huge", "campaign": [block]}))
    # on a machine with a page of memory
    code = "import os; os.sysconf = lambda name: 4096 if name == 'SC_PAGE_SIZE' else 1\n"
    command = [sys.executable, "-c", code + "from snakemake.cli import main; main()"]
    command += [*options(tmp_path), "--configfile", str(overlay)]
    for more, status in (["-n"], 0), ([], 1):
        run = subprocess.run([*command, *more], capture_output=True, text=True)
        assert run.returncode == status, run.stderr
        assert "cannot run on this machine: the Gram matrix" in run.stderr
        assert "takes 74.5 GiB" in run.stderr
        assert [path.name for path in results.rglob("*")] == ["notes.txt"]

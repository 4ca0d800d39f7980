import copy
import itertools
import math
import re
import shutil
from pathlib import Path

import pytest
import yaml
from helpers_rules import predicted_jobs

from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.cost_report import (
    PredictedJob,
    forecaster_costs,
    forecasters_report,
    job_table,
    main,
    report,
    rule_costs,
    write_costs,
)
from burstcast_workflow.costs import SAFETY, SECONDS_PER, SNAKEMAKE_MIB, Cost, CostModel
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.snakemake_plan import names_of_rules, planned

ROOT = Path(__file__).parents[2]
PAPER = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
PRESETS = sorted(path.stem for path in (ROOT / "workflow" / "presets").glob("*.yaml"))
DATA = {"case": "Re400"}
NETWORK = {"case": "Re400", "forecaster": "esn-N2000-RV-seed0"}
SCAN = {"case": "Re400", "reservoir": "esn-N2000-seed0", "strategies": "RV+SSV"}
PROBABILITIES = (
    "calibration_set",
    "calibration_forecast",
    "calibrate",
    "probability_scores",
    "probability_diagrams",
    "lead_times",
    "threshold_sweep",
)


def windows(prediction_time_lt) -> str:
    """The paper's strategy at a prediction time."""
    return f"prediction_triggered-prediction_time{prediction_time_lt}-window1"


WILDCARDS = {
    "integration": DATA,
    "tangent": DATA,
    "data": DATA,
    "search_grid": SCAN,
    "search_points": NETWORK,
    "choice": NETWORK,
    "training": NETWORK,
    "closed_loop": NETWORK,
    "leave_one_out": NETWORK,
    "spectrum": NETWORK,
    "control": {
        "case": "Re400",
        "controller": "esn-N2000-RV-seed0",
        "strategy": windows(2),
    },
    "gather": {},
    "bootstrap": {},
    "bootstrap_runs": {},
    "figure": {"figure": "by_reynolds", "of_case": ""},
}


def model(**changes) -> CostModel:
    """Costs of the paper's campaign, with single settings changed (case_defaults__...=...)."""
    config = copy.deepcopy(PAPER)
    for name, value in changes.items():
        *parents, last = name.split("__")
        place = config
        for parent in parents:
            place = place[parent]
        place[last] = value
    return CostModel(Campaign(load(config)))


def predicted(cost_class, stage="something_new", costs=None, **wildcards) -> Cost:
    """Cost of a job of that class, with some wildcards changed."""
    return (costs or model()).predicted(cost_class, stage, {**WILDCARDS[cost_class], **wildcards})


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
def paper(directory) -> list[PredictedJob]:
    """All jobs of the paper's campaign."""
    return predicted_jobs(options(directory))


# -- classes ---------------------------------------------------------------------------------------


def test_gram_matrices_and_solves_make_the_scan_grow_between_the_square_and_the_cube_of_the_size():
    sizes = (3000, 6000, 12000)
    scans = [predicted("search_grid", "scan", reservoir=f"esn-N{n}-seed0") for n in sizes]
    for smaller, larger in itertools.pairwise(scan.seconds for scan in scans):
        assert 2**2 < larger / smaller < 2**3


@pytest.mark.parametrize("stage", ["forecast", "horizon", "long_term"])
def test_closed_loops_grow_with_the_size_alone(stage):
    small, large = (
        predicted("closed_loop", stage, forecaster=f"esn-N{n}-RV-seed0").seconds
        for n in (2000, 4000)
    )
    assert large / small == pytest.approx(2, rel=0.1)


@pytest.mark.parametrize(
    ("cost_class", "stage", "changes"),
    [
        ("integration", "simulate", {"case_defaults__ensemble__series": 4000}),
        ("tangent", "lyapunov", {"case_defaults__ensemble__duration": 8000}),
        ("closed_loop", "forecast", {"cases__Re400__test_series": 300}),
        ("closed_loop", "horizon", {"horizon__events": 1000}),
        ("closed_loop", "long_term", {"statistics__duration": 8000}),
        ("spectrum", "lyapunov_spectrum", {"statistics__lyapunov_exponents": 20}),
        ("control", "control", {"control__span_lt": 40}),
    ],
)
def test_twice_the_work_takes_twice_the_time(cost_class, stage, changes):
    seconds = predicted(cost_class, stage).seconds
    more = predicted(cost_class, stage, model(**changes)).seconds
    assert more / seconds == pytest.approx(2, rel=0.2)


def test_scan_serves_all_strategies_at_every_point_of_the_grid():
    fine, coarse = (predicted("search_grid", "scan", model(search__grid=n)).seconds for n in (8, 4))
    assert fine / coarse == pytest.approx(4, rel=0.05)
    both = predicted("search_grid", "scan").seconds
    alone = predicted("search_grid", "scan", strategies="RV").seconds
    assert alone < both < 1.5 * alone  # they share the open loop and the Gram matrix


def test_search_pays_for_its_points():
    none, nine, eighteen = (
        predicted("search_points", "search", model(search__bayesian_points=points)).seconds
        for points in (0, 9, 18)
    )
    assert eighteen - none == pytest.approx(2 * (nine - none))
    assert nine - none > 9 * SECONDS_PER["surrogate fit"]


@pytest.mark.parametrize(
    ("cost_class", "stage"), [("closed_loop", "forecast"), ("closed_loop", "long_term")]
)
def test_backend_that_is_not_compiled_is_slower(cost_class, stage):
    compiled = predicted(cost_class, stage).seconds
    scipy = predicted(cost_class, stage, model(forecasters__esn__backend="scipy")).seconds
    assert 3 < scipy / compiled < 5


def test_a_filter_costs_its_members_over_the_washout_and_the_forecast():
    plain, filtered = (
        predicted("closed_loop", "forecast", forecaster=kind)
        for kind in ("quadratic", "quadratic_filtered")
    )
    half = predicted(
        "closed_loop",
        "forecast",
        model(forecasters__filter__members=20),
        forecaster="quadratic_filtered",
    )
    # washouts of 30 steps and forecasts of 366, from 9000 starting points with four steps each
    steps = SECONDS_PER["integration step"] * 9000 * 4 * (30 + 366)
    assert filtered.seconds - half.seconds == pytest.approx(20 * steps, rel=0.02)
    assert plain.seconds < half.seconds
    assert plain.memory_mib < half.memory_mib < filtered.memory_mib


def test_other_kinds_of_forecasters_cost_what_the_equations_cost():
    for cost_class, stage in (("closed_loop", "forecast"), ("control", "control")):
        kinds = ("equations", "equations_noisy", "persistence")
        costs = {predicted(cost_class, stage, forecaster=kind) for kind in kinds}
        assert len(costs) == 1
        # whatever the settings of networks
        networks = model(forecasters__esn__backend="scipy", forecasters__esn__connectivity=40)
        assert costs == {predicted(cost_class, stage, networks, forecaster="equations")}
    one, two, four = (
        predicted("closed_loop", "forecast", costs, forecaster="equations").seconds
        for costs in (
            model(
                case_defaults__ensemble__time_step=0.25 / finer,
                case_defaults__ensemble__sampling_stride=4 * finer,
            )
            for finer in (1, 2, 4)
        )
    )
    assert four - two == pytest.approx(2 * (two - one))


def test_random_alarms_cost_the_flows_of_control_without_forecasts():
    at_random = {"controller": "esn-N2000-RV-seed0-random"}
    flows = predicted("control", "control", **at_random).seconds
    control = predicted("control", "control").seconds
    assert flows < control
    costs = model(control__prediction_times_lt=[2, 12, 32])
    far, farther = (
        predicted("control", "control", costs, **at_random, strategy=windows(time))
        for time in (12, 32)
    )
    assert farther.seconds - flows == pytest.approx(3 * (far.seconds - flows), rel=0.02)


def test_decisions_cost_what_they_look_ahead_and_how_often():
    settings = {"horizon_lt": [2, 4], "decision_interval_lt": [0.25, 0.5]}
    block = {"strategy": "receding_horizon", "settings": settings, "forecasters": {"esn": {}}}
    costs = model(control__strategies=[block])

    def seconds(horizon, interval):
        strategy = f"receding_horizon-decision_interval{interval}-horizon{horizon}"
        return predicted("control", "control", costs, strategy=strategy).seconds

    assert seconds(2, 0.25) / seconds(2, 0.5) == pytest.approx(2, rel=0.1)
    assert seconds(4, 0.25) / seconds(2, 0.25) == pytest.approx(4.5 / 2.5, rel=0.1)
    reactive = {"strategy": "reactive", "settings": {"level": [1], "decision_interval_lt": [1]}}
    costs = model(control__strategies=[{**reactive, "span_lt": span} for span in (20, 200)])
    short, long = (
        predicted(
            "control",
            "control",
            costs,
            controller="none",
            strategy=f"reactive-decision_interval1-level1-span{span}",
        ).seconds
        for span in (20, 200)
    )
    assert 5 < long / short < 11


def test_committees_cost_the_forecasts_of_all_who_vote():
    settings = {"horizon_lt": [2], "decision_interval_lt": [0.25], "vote_share": [0.5]}
    block = {"strategy": "receding_horizon", "settings": settings, "committee": True}
    costs = model(
        campaign=[
            {
                "reynolds": [400],
                "forecasters": {
                    "esn": {"neurons": [2000], "validation": ["RV"], "seeds": 5},
                    "quadratic_filtered": {},
                },
            }
        ],
        control__strategies=[{**block, "forecasters": {"esn": {}, "quadratic_filtered": {}}}],
    )
    strategy = {"strategy": "receding_horizon-decision_interval0.25-horizon2-vote_share0.5"}

    def seconds(controller):
        return predicted("control", "control", costs, controller=controller, **strategy).seconds

    of_five = seconds("esn-N2000-RV-committee")
    assert of_five / seconds("esn-N2000-RV-seed0") == pytest.approx(5, rel=0.1)
    # the filter of 40 members runs once, over 30 steps; all of them look 122 steps ahead
    of_members = seconds("quadratic_filtered-committee")
    of_mean = seconds("quadratic_filtered")
    assert of_members / of_mean == pytest.approx(40 * (30 + 122) / (40 * 30 + 122), rel=0.1)


def test_memory_holds_the_arrays():
    series_mib = 2000 * 4000 * 9 * 8 / 2**20
    assert predicted("integration", "simulate").memory_mib > 2 * series_mib
    small, large = (
        predicted("search_grid", "scan", reservoir=f"esn-N{n}-seed0").memory_mib
        for n in (1000, 10_000)
    )
    gram_mib = (10_000**2 - 1000**2) * 8 / 2**20
    assert 3 * gram_mib < large - small < 8 * gram_mib


@pytest.mark.parametrize("cost_class", WILDCARDS)
def test_stage_that_is_not_known_is_guessed_from_its_class(cost_class):
    cost = predicted(cost_class)
    assert 0.5 < cost.seconds < 150
    assert 50 < cost.memory_mib < 2048


def test_class_that_is_not_known_is_a_mistake():
    with pytest.raises(KeyError, match="closed_lop"):
        model().predicted("closed_lop", "forecast", NETWORK)


def test_prediction_does_not_depend_on_what_was_asked_before():
    costs = model()
    names = [f"esn-N{n}-RV-seed{seed}" for n, seed in ((500, 0), (3000, 0), (500, 7))]
    first, larger, again = (predicted("training", "train", costs, forecaster=n) for n in names)
    assert first == again != larger
    assert predicted("training", "train", forecaster=names[0]) == first
    assert predicted("control", "control", costs, strategy=windows(1)) != predicted(
        "control", "control", costs, strategy=windows(2)
    )


def test_case_whose_lyapunov_time_is_not_known_yet():
    costs = model(case_defaults__lyapunov__time_unit="computed")
    assert predicted("closed_loop", "forecast", costs).seconds > 1


# -- what is asked for -----------------------------------------------------------------------------


@pytest.mark.parametrize("cost_class", ["search_grid", "integration", "bootstrap"])
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


# -- campaigns -------------------------------------------------------------------------------------


def test_totals_of_the_papers_campaign_are_those_of_the_documentation(paper, directory):
    text = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
    _, section = text.split("<!-- predicted: begin -->")
    units = re.findall(r"^\| ([a-z ]+) \| ([-+.e\d]+) \| ([-+.e\d]+) \|$", section, re.M)
    assert {unit: float(ours) for unit, _, ours in units}.items() <= SECONDS_PER.items()
    measured = {unit: float(rate) for unit, rate, _ in units}
    jobs = predicted_jobs(options(directory), {**SECONDS_PER, **measured})
    (documented,) = re.findall(r"in minutes on one core: ([\d.]+)$", section, re.M)
    assert report(rule_costs(job_table(jobs))).split()[-1] == documented
    equations = ("equations", "equations_noisy")
    probabilities = [job for job in jobs if job.rule in PROBABILITIES]
    of_equations = [
        job
        for job in jobs
        if job.wildcards.get("forecaster") in equations
        and job.rule not in ("control", *PROBABILITIES)
    ]
    calibrating, added = (
        sum(job.cost.seconds for job in some) / 60 for some in (probabilities, of_equations)
    )
    assert 0.1 < added < 1
    assert 35 < calibrating < 50
    # the rates of the model itself are of a similar machine
    assert sum(job.cost.seconds for job in paper) / 60 == pytest.approx(float(documented), rel=0.1)


def test_budget_of_memory_and_time_of_the_papers_campaign(paper):
    assert max(job.cost.memory_mib for job in paper) < 2048
    assert max(job.cost.seconds for job in paper) < 300
    bootstraps = ("classification_table", "statistics_table", *PROBABILITIES)
    small = [job for job in paper if job.rule.endswith("_table") or "case" not in job.wildcards]
    assert len({job.rule for job in small}) > 10
    for job in small:
        assert job.cost.seconds < (60 if job.rule in bootstraps else 5)
        assert job.cost.memory_mib < 400


def test_jobs_are_listed_rule_by_rule_each_once(paper):
    keys = [(job.rule, *sorted(job.wildcards.items())) for job in paper]
    assert len(set(keys)) == len(keys)
    blocks = [rule for rule, _ in itertools.groupby(job.rule for job in paper)]
    assert len(set(blocks)) == len(blocks)
    assert blocks[0] == "simulate"
    assert len({job.record for job in paper}) == len(paper)


@pytest.mark.long
def test_every_preset_and_every_job_has_a_prediction_and_small_campaigns_cost_less(
    paper, directory
):
    totals = {"paper": sum(job.cost.seconds for job in paper)}
    for preset in PRESETS:
        jobs = predicted_jobs(options(directory, preset))
        assert {job.rule for job in jobs} >= {"simulate", "scan", "search", "train", "forecast"}
        for job in jobs:
            assert 0 < job.cost.seconds < math.inf
            assert 0 < job.cost.memory_mib < math.inf
        totals[preset] = sum(job.cost.seconds for job in jobs)
        assert f"{totals[preset] / 60:.1f}" == report(rule_costs(job_table(jobs))).split()[-1]
    assert totals["tiny"] < totals["quick"] / 2 < totals["paper"] / 9


def test_rules_ask_for_what_is_predicted(directory):
    arguments = options(directory, "tiny")
    costs = {(job.rule, *job.wildcards.values()): job.cost for job in predicted_jobs(arguments)}
    asked = 0
    for job in planned([*arguments, "--forceall"]).dag.jobs:
        if job.output:
            cost = costs[job.rule.name, *job.wildcards_dict.values()]
            assert job.resources["mem_mb"] == cost.mib_for(1)
            assert job.resources["runtime"] == cost.minutes_for(1)
            asked += 1
    assert asked == len(costs)


# -- records ---------------------------------------------------------------------------------------


def write_record(path, seconds, memory):
    path.parent.mkdir(parents=True, exist_ok=True)
    columns = {"s": seconds, "h:m:s": "0:00:01", "max_rss": memory}
    path.write_text("\n".join("\t".join(map(str, row)) for row in (columns, columns.values())))


def test_records_are_compared_with_the_predictions_of_their_jobs(tmp_path, capsys):
    shutil.copy(ROOT / "config.yaml", tmp_path)
    arguments = options(tmp_path, "tiny")
    jobs = predicted_jobs(arguments)
    assert not any(job.record.exists() for job in jobs)
    of_rule = {rule: [job for job in jobs if job.rule == rule] for rule in {j.rule for j in jobs}}
    root = tmp_path / "results" / "tiny" / "benchmarks"
    for factor, job in zip((1, 3, 1), of_rule["search"], strict=False):
        write_record(job.record, factor * job.cost.seconds, job.cost.memory_mib)
    write_record(root / "train" / "Re400" / "esn-N30-RV-seed0.tsv", 1000, "-")
    write_record(root / "classification_table" / "Re400.tsv", 0.001, 500)
    write_record(root / "train" / "Re400" / "esn-N77-RV-seed0.tsv", 1, 1)  # of another campaign
    main(arguments)
    text = capsys.readouterr().out
    lines = {line.split()[0]: line.split() for line in text.splitlines()}
    _, count, _, _, _, records, _, ratio, _, ratio_of_memory = lines["search"]
    assert (count, records, ratio, ratio_of_memory) == ("4", "3", "1.00", "1.00")
    assert lines["train"][5] == "1"
    assert lines["train"][6] == "1000.0"
    assert lines["train"][7].endswith("!")
    assert lines["train"][-1] == "0.00!"
    assert lines["classification_table"][7] == "0.00!"
    assert lines["classification_table"][9].endswith("!")
    assert len(lines["scan"]) == 5
    # the same as a table, with sums and the size of what is there
    (output,) = of_rule["train"][0].outputs
    output.parent.mkdir(parents=True)
    output.write_bytes(bytes(3 * 2**20))
    write_costs(job_table(jobs), names_of_rules(planned(arguments))["campaign"], root)
    rows = read_table(root / "rule_costs.csv").set_index("rule")
    assert rows.index.tolist() == list(dict.fromkeys(job.rule for job in jobs))
    assert rows["jobs"].sum() == len(jobs)
    assert rows.loc["search", "minutes"] == pytest.approx(
        sum(f * job.cost.seconds for f, job in zip((1, 3, 1), of_rule["search"], strict=False)) / 60
    )
    assert rows.loc["train", ["records", "median_seconds", "disk_mib"]].tolist() == [1, 1000, 3]
    assert rows.loc["scan"].dropna().index.tolist() == [
        "jobs",
        "predicted_longest_seconds",
        "predicted_memory_mib",
        "predicted_minutes",
        "records",
    ]


def test_training_and_forecasting_are_told_by_kind_of_forecaster(tmp_path):
    config = copy.deepcopy(PAPER)
    networks = {"neurons": [30], "validation": ["RV"], "seeds": 4}
    forecasters = {"esn": networks, "quadratic": {}, "persistence": {}}
    config["campaign"] = [{"reynolds": [400], "forecasters": forecasters}]
    found = Campaign(config)
    write_costs(job_table([]), found, tmp_path)
    assert not any(tmp_path.iterdir())

    def job(stage, seconds, memory, case="Re400", **whose):
        """A job that has run; its rule is called otherwise, as by who has it as a module."""
        record = tmp_path / "records" / "-".join((stage, *whose.values()))
        write_record(record, seconds, memory)
        return PredictedJob(f"mine_{stage}", stage, {"case": case, **whose}, Cost(1, 1), record)

    jobs = []
    for seed, factor in enumerate((1, 2, 6)):
        reservoir = {"reservoir": f"esn-N30-seed{seed}", "strategies": "RV+SSV"}
        jobs.append(job("scan", factor * 10.0, 70, **reservoir))
        for stage, seconds in {"search": 5.0, "train": 1.0, "forecast": 4.0}.items():
            network = f"esn-N30-RV-seed{seed}"
            jobs.append(job(stage, factor * seconds, 90 + seed, forecaster=network))
    jobs += [
        job("forecast", 1000, 1000, forecaster="esn-N30-RV-seed3"),  # without a scan
        job("fit", 1000, 1000, forecaster="analogues"),  # of another campaign
        job("fit", 1000, 1000, forecaster="persistence"),  # without a forecast
        job("fit", 0.5, 60, forecaster="quadratic"),
        job("forecast", 3.0, "NA", forecaster="quadratic"),
        PredictedJob("latex", "latex", {"table": "horizon"}, Cost(1, 1), tmp_path / "not_yet"),
    ]
    table = job_table(jobs)
    _, network, quadratic = forecasters_report(forecaster_costs(table, found)).splitlines()
    assert network.split() == ["Re400", "esn-N30-RV", "3", "32.0", "92", "8.0", "92"]
    assert quadratic.split() == ["Re400", "quadratic", "1", "0.5", "60", "3.0", "0"]
    assert forecasters_report(forecaster_costs(job_table([]), found)) == ""
    # the same as a table
    write_costs(table, found, tmp_path)
    rows = read_table(tmp_path / "forecaster_costs.csv").set_index("forecaster")
    assert rows.index.tolist() == ["esn", "quadratic"]
    assert rows.loc["esn", ["neurons", "forecasters", "training_seconds"]].tolist() == [30, 3, 32]
    assert rows["forecast_seconds"].tolist() == [8, 3]
    assert rows["training_memory_mib"].tolist() == [92, 60]


def test_a_part_of_a_campaign_writes_no_costs_of_the_whole(finished):
    """It has no figures; test_miniature.py has what a whole one writes."""
    assert not (finished.project.results / "benchmarks" / "rule_costs.csv").exists()

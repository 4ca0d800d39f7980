import copy
import itertools
import math
from pathlib import Path

import pytest
import yaml

from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.cases import case_records
from burstcast_workflow.config.loading import load
from burstcast_workflow.cost_report import compare, forecast_lines, jobs, read_campaign, records
from burstcast_workflow.costs import SAFETY, SNAKEMAKE_MIB, CostModel

ROOT = Path(__file__).parents[2]
NETWORK = {"case": "Re400", "neurons": "2000", "validation": "RV", "seed": "0"}
PAPER = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))


def model(**changes) -> CostModel:
    """Costs of the paper's campaign, with single settings changed (case_defaults__...=...)."""
    config = copy.deepcopy(PAPER)
    for name, value in changes.items():
        *parents, last = name.split("__")
        place = config
        for parent in parents:
            place = place[parent]
        place[last] = value
    config = load(config)
    return CostModel(Campaign(config, case_records(config)))


def network(**changes):
    return {**NETWORK, **{name: str(value) for name, value in changes.items()}}


def test_gram_matrices_and_solves_make_the_scan_grow_between_the_square_and_the_cube_of_the_size():
    costs = model()
    seconds = [costs.predicted("scan", network(neurons=n)).seconds for n in (3000, 6000, 12000)]
    for smaller, larger in itertools.pairwise(seconds):
        assert 2**2 < larger / smaller < 2**3


def test_forecasts_grow_with_the_size_alone():
    costs = model()
    small, large = (costs.predicted("forecast", network(neurons=n)).seconds for n in (2000, 4000))
    assert large / small == pytest.approx(2, rel=0.1)


@pytest.mark.parametrize(
    ("rule", "changes"),
    [
        ("simulate", {"case_defaults__ensemble__series": 4000}),
        ("lyapunov", {"case_defaults__ensemble__duration": 8000}),
        ("forecast", {"cases__Re400__test_series": 300}),
        ("horizon", {"horizon__events": 1000}),
        ("climate", {"statistics__duration": 8000}),
    ],
)
def test_twice_the_work_takes_twice_the_time(rule, changes):
    wildcards = NETWORK if rule in ("forecast", "horizon", "climate") else {"case": "Re400"}
    seconds = model().predicted(rule, wildcards).seconds
    more = model(**changes).predicted(rule, wildcards).seconds
    assert more / seconds == pytest.approx(2, rel=0.2)


def test_scan_serves_both_strategies_at_every_point_of_the_grid():
    fine, coarse = model(search__grid=8), model(search__grid=4)
    ratio = fine.predicted("scan", NETWORK).seconds / coarse.predicted("scan", NETWORK).seconds
    assert ratio == pytest.approx(4, rel=0.05)


def test_search_pays_for_its_points():
    none = model(search__bayesian_points=0).predicted("tune", NETWORK).seconds
    nine = model(search__bayesian_points=9).predicted("tune", NETWORK).seconds
    eighteen = model(search__bayesian_points=18).predicted("tune", NETWORK).seconds
    assert eighteen - none == pytest.approx(2 * (nine - none))


def test_memory_holds_the_arrays():
    costs = model()
    series_mib = 2000 * 4000 * 9 * 8 / 2**20
    assert costs.predicted("simulate", {"case": "Re400"}).memory_mib > 2 * series_mib
    small, large = (costs.predicted("scan", network(neurons=n)).memory_mib for n in (1000, 10_000))
    gram_mib = (10_000**2 - 1000**2) * 8 / 2**20
    assert 3 * gram_mib < large - small < 8 * gram_mib


def test_budget_of_memory_at_3000_neurons():
    costs = model()
    for rule in ("scan", "tune", "train", "forecast", "horizon", "climate"):
        assert costs.predicted(rule, network(neurons=3000)).memory_mib < 2048


@pytest.mark.parametrize("rule", ["scan", "simulate", "classify"])
def test_requests_leave_a_margin_and_double_at_each_retry(rule):
    costs = model()
    wildcards = {} if rule == "classify" else NETWORK
    cost = costs.predicted(rule, wildcards)
    memory = [costs.memory_mib(rule, wildcards, attempt) for attempt in (1, 2, 3)]
    minutes = [costs.runtime_minutes(rule, wildcards, attempt) for attempt in (1, 2, 3)]
    assert memory[0] == math.ceil(SAFETY * cost.memory_mib + SNAKEMAKE_MIB)
    assert minutes[0] * 60 >= SAFETY * cost.seconds
    for requests in (memory, minutes):
        assert all(type(request) is int for request in requests)
        assert requests == [requests[0], 2 * requests[0], 4 * requests[0]]


def test_prediction_does_not_depend_on_what_was_asked_before():
    costs = model()
    first = costs.predicted("scan", network(neurons=500))
    costs.predicted("scan", network(neurons=3000))
    assert costs.predicted("scan", network(neurons=500, seed=7)) == first
    assert model().predicted("scan", network(neurons=500)) == first


@pytest.mark.parametrize(
    "wildcards", [{}, {"case": "Re400"}, NETWORK, {**NETWORK, "prediction_time_lt": "2"}]
)
def test_rule_that_is_not_known_is_guessed(wildcards):
    cost = model().predicted("something_new", wildcards)
    assert 0 < cost.seconds < 120
    assert 50 < cost.memory_mib < 2000


def test_case_whose_lyapunov_time_is_not_known_yet():
    costs = model(case_defaults__lyapunov__time_unit="computed")
    assert costs.predicted("forecast", NETWORK).seconds > 1


def test_every_preset_and_every_job_has_a_prediction():
    for preset in sorted((ROOT / "workflow" / "presets").glob("*.yaml")):
        campaign = read_campaign([ROOT / "config.yaml", preset])
        costs = CostModel(campaign)
        listed = list(jobs(campaign))
        assert len({(rule, *sorted(wildcards.items())) for rule, wildcards in listed}) == len(
            listed
        )
        for rule, wildcards in listed:
            cost = costs.predicted(rule, wildcards)
            assert 0 < cost.seconds < math.inf
            assert 0 < cost.memory_mib < math.inf


def test_tiny_campaign_costs_less_than_the_quick_and_that_less_than_the_papers():
    totals = []
    for preset in ("tiny", "quick", None):
        overlays = [ROOT / "workflow" / "presets" / f"{preset}.yaml"] if preset else []
        campaign = read_campaign([ROOT / "config.yaml", *overlays])
        costs = CostModel(campaign)
        totals.append(sum(costs.predicted(*job).seconds for job in jobs(campaign)))
        assert f"{totals[-1] / 60:.1f}" in forecast_lines(campaign, costs)[-1]
    assert totals[0] < totals[1] / 3 < totals[2] / 9


def write_record(path, seconds, memory):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"s\th:m:s\tmax_rss\n{seconds}\t0:00:01\t{memory}\n")


def test_records_are_compared_with_the_predictions_of_their_jobs(tmp_path):
    campaign = read_campaign([ROOT / "config.yaml"])
    costs = CostModel(campaign)
    root = tmp_path / "benchmarks"
    scan = costs.predicted("scan", NETWORK)
    write_record(root / "scan" / "Re400-N2000-seed0.tsv", scan.seconds, scan.memory_mib)
    write_record(root / "train" / "Re400-N2000-RV-seed3.tsv", 1000, "-")
    write_record(root / "control" / "Re400-N2000-RV-seed3-PT1.tsv", 20, 300)
    write_record(root / "percentiles" / "horizon.tsv", 1, 90)
    write_record(root / "classify.tsv", 5, 90)
    found = {record.rule: dict(record.wildcards) for record in records(tmp_path)}
    assert found["scan"] == {"case": "Re400", "neurons": "2000", "seed": "0"}
    assert found["train"] == network(seed=3)
    assert found["control"] == {**network(seed=3), "prediction_time_lt": "1"}
    assert found["classify"] == {}
    lines = {line.split()[0]: line for line in compare(campaign, records(tmp_path))}
    assert "1.00 " in lines["scan"]
    assert "!" not in lines["scan"]
    assert "!" in lines["train"]
    assert "percentiles" in lines

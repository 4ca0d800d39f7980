"""Which figures of long-term statistics, flow and control a campaign has, and what they show."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml
from snakemake.utils import update_config

from burstcast.statistics.densities import Histogram
from burstcast.statistics.measures import best_network
from burstcast.statistics.moments import StateMoments
from burstcast.statistics.reductions import LongTermStatistics
from burstcast_workflow.campaign import Campaign
from burstcast_workflow.config.cases import case_records
from burstcast_workflow.config.loading import load

ROOT = Path(__file__).parents[2]
FLOW = {"midplane_planes", "vorticity_isosurfaces"}
STATISTICS = {"energy_density", "profile_errors", "midplane_mean_square"}
CONTROL = {"control_schematic", "suppressed_event", "control_density", "control_tradeoff"}
LORENZ = {
    "system": "lorenz63",
    "parameters": {"rho": 28},
    "event_threshold": 40,
    "laminarisation_threshold": None,
    "ensemble": {
        "initial_state": [1, 1, 20],
        "perturbed_component": 1,
        "time_step": 0.01,
        "sampling_stride": 2,
        "transient": 20,
        "duration": 80,
    },
    "lyapunov": {"published_exponent": 0.9, "orthonormalisation_interval": 0.1},
    "density": {"range": [0, 50]},
    "actuation": {"parameters": {"rho": 10}},
    "recycle_validation": {"intervals_per_series": 10},
}


def block(neurons, validation=("RV",), seeds=2, **cases):
    return {**cases, "neurons": neurons, "validation": [*validation], "seeds": seeds}


def campaign(blocks=None, **overlay):
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    update_config(config, copy.deepcopy(overlay))
    if blocks:
        config["campaign"] = blocks
    config = load(config)
    return Campaign(config, case_records(config))


def stage_figures(of):
    figures = of.figures
    assert len(set(figures)) == len(figures)
    return {*of.statistics_figures, *of.control_figures} & set(figures)


ONE = [block([2000], reynolds=[400])]


def test_one_reynolds_number_has_every_figure_once():
    assert stage_figures(campaign(ONE)) == FLOW | STATISTICS | CONTROL


def test_other_cases_have_their_own_statistics_and_share_the_densities_under_control():
    found = stage_figures(campaign([block([2000], reynolds=[600, 400])]))
    more = {f"{name}_Re600" for name in (*STATISTICS, "control_tradeoff")}
    assert found == FLOW | STATISTICS | CONTROL | more


def test_stages_that_are_switched_off_have_no_figures():
    assert stage_figures(campaign(ONE, control={"validation": []})) == FLOW | STATISTICS
    assert stage_figures(campaign(ONE, statistics={"validation": []})) == FLOW | CONTROL
    uncontrolled = campaign(ONE, case_defaults={"actuation": None})
    assert stage_figures(uncontrolled) == FLOW | STATISTICS


def test_a_strategy_that_no_network_has_leaves_no_figures():
    found = campaign(ONE, statistics={"validation": ["SSV"]}, control={"validation": ["SSV"]})
    assert stage_figures(found) == FLOW
    assert "control" not in found.tables
    assert "statistics" not in found.tables


def test_a_case_without_networks_of_the_fixed_size_has_no_statistics():
    blocks = [block([2000], reynolds=[400]), block([500], reynolds=[600])]
    found = stage_figures(campaign(blocks))
    assert found == FLOW | STATISTICS | CONTROL


def lorenz(**overlay):
    return campaign(
        [block([2000], cases=["lorenz"])],
        cases={"lorenz": LORENZ},
        figures={"example_case": "lorenz", "flow_event": {"peak": 45}},
        **overlay,
    )


def test_a_system_that_is_no_flow_has_no_figures_of_the_flow():
    found = lorenz()
    assert not found.has_flow("lorenz")
    assert stage_figures(found) == {
        "energy_density",
        "control_schematic",
        "control_density",
        "control_tradeoff",
    }
    assert found.settings("figure_energy_density", {})["symbol"] == "z"


def test_densities_of_different_systems_are_not_in_one_figure():
    blocks = [block([2000], reynolds=[600, 400], cases=["lorenz"])]
    found = campaign(blocks, cases={"lorenz": LORENZ})
    assert {"control_density", "control_density_lorenz"} <= stage_figures(found)
    assert {run.case for run in found.density_runs({})} == {"Re400", "Re600"}
    assert {run.case for run in found.density_runs({"of_case": "_lorenz"})} == {"lorenz"}


def test_densities_leave_the_sweep_and_other_sizes_out():
    found = campaign(
        [block([500, 2000], reynolds=[400], seeds=3)],
        control={"neurons": [500, 2000], "sweep": {"cases": ["Re400"], "seeds": 2}},
    )
    runs = found.density_runs({})
    assert {run.prediction_time_lt for run in runs} == {1, 2}
    assert {run.network.neurons for run in runs} == {2000}
    assert len(runs) == 6
    assert all(run.forecaster == "esn" for run in runs)


def test_the_suppressed_event_is_the_example_networks_if_it_controls():
    seeds = [block([500, 2000], validation=("SSV", "RV"), reynolds=[600, 400], seeds=3)]
    assert campaign(seeds, figures={"example_seed": 2}).control_example.network.seed == 2
    other = campaign(seeds, figures={"example_neurons": 500, "example_seed": 2}).control_example
    assert (other.network.neurons, other.network.validation) == (2000, "RV")
    assert other.prediction_time_lt == 2


def test_the_best_network_is_of_the_examples_strategy():
    both = {"statistics": {"validation": ["SSV", "RV"]}}
    blocks = [block([500, 2000], validation=("SSV", "RV"), reynolds=[400])]
    for overlay, expected in (
        (both, "RV"),
        ({**both, "figures": {"example_validation": "SSV"}}, "SSV"),
        ({"statistics": {"validation": ["SSV"]}}, "SSV"),
    ):
        candidates = campaign(blocks, **overlay).statistics_candidates("Re400")
        assert {(network.neurons, network.validation) for network in candidates} == {
            (2000, expected)
        }
        assert len(candidates) == 2


def test_every_figure_has_a_rule_a_script_and_a_caption():
    rules = "".join(path.read_text() for path in (ROOT / "workflow" / "rules").glob("*.smk"))
    for figure in FLOW | STATISTICS | CONTROL:
        assert f"rule figure_{figure}:" in rules
        assert (ROOT / "workflow" / "scripts" / f"figure_{figure}.py").exists()
        assert (ROOT / "workflow" / "report" / f"{figure}.rst").read_text().strip()
        assert campaign(ONE).settings(f"figure_{figure}", {})


def test_the_suppressed_event_is_made_with_the_settings_of_control():
    wildcards = {"case": "Re400", "neurons": "2000", "validation": "RV", "seed": "0"}
    found = campaign()
    assert found.settings("suppressed_event", wildcards) == found.settings(
        "control", {**wildcards, "prediction_time_lt": "2"}
    )


def statistics(counts):
    edges = np.linspace(0.0, 1.0, len(counts) + 1)
    number = sum(counts)
    moments = StateMoments(number, np.zeros(2), np.eye(2))
    return LongTermStatistics(Histogram(edges, np.array(counts)), moments)


NOTHING, NEAR, NEAREST = statistics([0, 0, 0]), statistics([10, 6, 5]), statistics([10, 6, 4])


@pytest.mark.parametrize(
    ("networks", "label"),
    [
        ([NOTHING, NOTHING], None),
        ([NOTHING, NEAR], "ESN (500 neurons, best of 2: seed 7)"),
        ([NEAREST, NEAR], "ESN (500 neurons, best of 2: seed 4)"),
        ([NEAR], "ESN (500 neurons, seed 4)"),
    ],
)
def test_the_best_network_is_the_nearest_to_the_data(networks, label):
    best = best_network(NEAREST, dict(zip([(500, 4), (500, 7)], networks, strict=False)))
    assert (best.label if best else None) == label

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
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.cases import is_flow
from burstcast_workflow.config.loading import load
from burstcast_workflow.figures.registry import (
    FIGURES,
    control_example,
    figure_names,
    long_term_candidates,
    settings_of,
)
from burstcast_workflow.tables.registry import table_names

ROOT = Path(__file__).parents[2]
FLOW = {"midplane_planes", "vorticity_isosurfaces"}
STATISTICS = {
    *("long_term_density", "profile_errors", "midplane_mean_square"),
    "own_flow",
}
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
    networks = {"neurons": neurons, "validation": [*validation], "seeds": seeds}
    return {**cases, "forecasters": {"esn": networks, "equations": {}, "equations_noisy": {}}}


def campaign(blocks=None, **overlay):
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    update_config(config, copy.deepcopy(overlay))
    if blocks:
        config["campaign"] = blocks
    return Campaign(load(config))


def stage_figures(of):
    figures = figure_names(of)
    assert len(set(figures)) == len(figures)
    stages = FLOW | STATISTICS | CONTROL
    assert stages < set(FIGURES)
    return {
        figure
        for figure in figures
        if any(figure == name or figure.startswith(f"{name}_") for name in stages)
    }


def shown(of, figure, case):
    """Settings of a figure's job."""
    return settings_of(of, FIGURES[figure], case)


OFF = {"forecasters": {"esn": None, "equations": None}}
SSV = {"forecasters": {"esn": {"validation": ["SSV"]}}}
ONE = [block([2000], reynolds=[400])]


def test_one_reynolds_number_has_every_figure_once():
    assert stage_figures(campaign(ONE)) == FLOW | STATISTICS | CONTROL


def test_other_cases_have_their_own_statistics_and_share_the_densities_under_control():
    found = stage_figures(campaign([block([2000], reynolds=[600, 400])]))
    more = {f"{name}_Re600" for name in (*STATISTICS, "control_tradeoff")}
    assert found == FLOW | STATISTICS | CONTROL | more


def test_stages_that_are_switched_off_have_no_figures():
    assert stage_figures(campaign(ONE, control=OFF)) == FLOW | STATISTICS
    assert stage_figures(campaign(ONE, statistics=OFF)) == FLOW | CONTROL
    uncontrolled = campaign(ONE, case_defaults={"actuation": None})
    assert stage_figures(uncontrolled) == FLOW | STATISTICS


def test_a_strategy_that_no_network_has_leaves_no_figures():
    blocks = [*ONE, block([2000], validation=("SSV",), reynolds=[600])]
    wanted = {"cases": {"Re600": {"actuation": None}}, "statistics": SSV}
    control = {"forecasters": {**SSV["forecasters"], "equations": None}}
    found = campaign(blocks, **wanted, control=control)
    assert {one.case for one in found.long_term_forecasters} == {"Re600"}
    assert stage_figures(found) == FLOW | STATISTICS
    assert "control" not in table_names(found)


def test_forecasters_that_are_no_networks_have_tables_and_no_figures_of_their_own():
    choice = {"forecasters": {"esn": None, "equations": {}, "equations_noisy": {}}}
    found = campaign(ONE, statistics=choice, control=choice)
    assert stage_figures(found) == FLOW
    assert {"control_percentiles", "statistics_percentiles"} <= set(table_names(found))
    assert {run.controller.kind for run in found.control_runs} == {
        "equations",
        "equations_noisy",
    }


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
    assert not is_flow(found.cases["lorenz"])
    assert stage_figures(found) == {
        "long_term_density",
        "own_flow",
        "control_schematic",
        "control_density",
        "control_tradeoff",
    }
    assert shown(found, "long_term_density", "lorenz")["shown.symbol"] == "z"


def test_densities_of_different_systems_are_not_in_one_figure():
    blocks = [block([2000], reynolds=[600, 400], cases=["lorenz"])]
    found = campaign(blocks, cases={"lorenz": LORENZ}, figures={"example_case": "Re400"})
    assert {"control_density", "control_density_lorenz"} <= stage_figures(found)
    for case, cases in (("Re400", ["Re400", "Re600"]), ("lorenz", ["lorenz"])):
        panels = shown(found, "control_density", case)["shown.panels"]
        assert [panel["case"] for panel in panels] == cases


def test_densities_leave_the_sweep_and_other_sizes_out():
    found = campaign(
        [block([500, 2000], reynolds=[400], seeds=3)],
        control={
            "forecasters": {"esn": {"neurons": [500, 2000]}},
            "sweep": {"cases": ["Re400"], "seeds": 2},
        },
    )
    assert {run.prediction_time_lt for run in found.control_runs} == {1, 2, 3, 4, 5}
    assert shown(found, "control_density", "Re400")["shown.panels"] == [
        {"case": "Re400", "event_threshold": 0.1, "neurons": 2000, "validation": "RV"}
    ]
    assert found.config.control.prediction_times_lt == [1, 2]


def test_a_case_without_networks_of_the_fixed_size_shows_those_that_it_has():
    blocks = [block([2000], reynolds=[400]), block([500], reynolds=[600])]
    found = campaign(blocks, control={"forecasters": {"esn": {"neurons": []}}})
    networks = shown(found, "control_tradeoff", "Re600")["shown.control_networks"]
    assert networks == {"neurons": 500, "validation": "RV"}


def test_the_suppressed_event_is_the_example_networks_if_it_controls():
    seeds = [block([500, 2000], validation=("SSV", "RV"), reynolds=[600, 400], seeds=3)]
    own = campaign(seeds, figures={"example_forecaster": "esn-N2000-RV-seed2"})
    assert control_example(own).controller == own.example.name
    other = campaign(
        seeds,
        figures={"example_forecaster": "esn-N500-RV-seed2"},
        control={"forecasters": {"esn": {"neurons": [2000]}}},
    )
    run = control_example(other)
    assert (run.case, run.controller.identifier) == ("Re400", "esn-N2000-RV-seed0")
    assert run.prediction_time_lt == 2
    assert control_example(campaign(seeds, control={"forecasters": {"esn": None}})) is None


def test_the_best_network_is_of_the_examples_strategy():
    both = {"statistics": {"forecasters": {"esn": {"validation": ["SSV", "RV"]}}}}
    ssv = {"figures": {"example_forecaster": "esn-N2000-SSV-seed0"}}
    blocks = [block([500, 2000], validation=("SSV", "RV"), reynolds=[400])]
    for overlay, expected in (
        (both, "RV"),
        ({**both, **ssv}, "SSV"),
        ({"statistics": SSV}, "SSV"),
    ):
        candidates = long_term_candidates(campaign(blocks, **overlay), "Re400")
        assert {(one.name.neurons, one.name.validation) for one in candidates} == {(2000, expected)}
        assert len(candidates) == 2


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

"""What the report consists of, and which settings its figures read."""

import copy
from pathlib import Path

import pytest
import yaml
from snakemake.utils import update_config

from burstcast.figures.registry import caption
from burstcast.systems.registry import make_system, parameters_of
from burstcast.tables.parameters import described_parameters
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.figures.registry import (
    FIGURES,
    figure_case,
    figure_names,
    files_of,
    settings_of,
)
from burstcast_workflow.tables.declarations import TABLES
from burstcast_workflow.tables.registry import (
    cases_of_tables,
    latex_names,
    table_names,
    typeset,
)

ROOT = Path(__file__).parents[2]
WORKFLOW = ROOT / "workflow"
CAPTIONS_OF_FIGURES = {name: caption(name) for name in FIGURES}
EVERYWHERE = [
    "observable_and_density",
    "validation_strategies",
    "network_schematic",
    "prediction_schematic",
    "prediction_examples",
    "classification_scores",
    "horizon_schematic",
    "horizon_evaluations",
    "horizon_by_size",
]


def campaign(*overlays):
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    for overlay in overlays:
        update_config(config, copy.deepcopy(overlay))
    return Campaign(load(config))


PAPER = campaign()


def settings(of, name, case="Re400"):
    """Settings of a figure's job."""
    return settings_of(of, FIGURES[name], case)


def changed(overlay):
    """Figures whose settings an overlay changes."""
    other = campaign(overlay)
    return {name for name in FIGURES if settings(PAPER, name) != settings(other, name)}


def test_the_paper_has_all_figures_and_those_of_other_cases():
    names = figure_names(PAPER)
    # of other strategies than the paper's, of parts of a state, and of plane flows
    assert set(FIGURES) - set(names) == {
        "burst_forecast",
        "burst_vorticity",
        "control_frontier",
        "encoder_loss",
        "lost_skill",
        "skill_by_parameter",
    }
    for case in ("Re600", "Re800", "Re1000"):
        assert f"classification_scores_{case}" in names
        # one size only: nothing to draw against
        assert f"horizon_by_size_{case}" not in names
    assert "classification_scores_Re400" not in names  # the example's case has the plain name
    assert len(names) == len(set(names))


@pytest.mark.parametrize("preset", sorted((WORKFLOW / "presets").glob("*.yaml")), ids=str)
def test_every_campaign_of_networks_has_the_figures_of_the_method(preset):
    names = figure_names(campaign(yaml.safe_load(preset.read_text(encoding="utf-8"))))
    assert set(EVERYWHERE) <= set(names)


def test_no_figure_over_one_reynolds_number():
    overlay = yaml.safe_load((WORKFLOW / "presets" / "tiny.yaml").read_text())
    block = {**overlay["campaign"][0], "reynolds": [400]}
    tiny = campaign({**overlay, "campaign": [block]})
    assert figure_names(tiny)
    assert "by_reynolds" not in figure_names(tiny)


def test_the_frontier_is_made_where_other_strategies_control():
    overlay = yaml.safe_load((WORKFLOW / "presets" / "beyond_the_paper.yaml").read_text())
    frontier = campaign(overlay)
    assert figure_names(frontier)[-1] == "control_frontier"
    shown = settings(frontier, "control_frontier")["shown.frontier_network"]
    assert shown == {"forecaster": "esn", "neurons": 1000, "validation": "RV", "seed": 0}
    assert settings(PAPER, "control_frontier", "Re800")["shown.frontier_network"]["seed"] == 0


def test_figure_over_reynolds_numbers_takes_each_once():
    block = PAPER.config.dump()["campaign"][1]
    twin = {**block, "reynolds": [400], "cases": ["Twin"]}
    twins = campaign(
        {
            "campaign": [*PAPER.config.dump()["campaign"], twin],
            "cases": {"Twin": {"parameters": {"reynolds": 600}, "lyapunov": {}}},
        }
    )
    assert "Twin" in twins.case_names
    shown = files_of(twins, FIGURES["by_reynolds"], "Re400")["horizons"]
    assert shown == [
        f"Re{reynolds}/tables/horizon_percentiles.csv" for reynolds in (400, 600, 800, 1000)
    ]


@pytest.mark.parametrize("name", FIGURES)
def test_captions_are_sentences_that_the_report_shows(name):
    text = CAPTIONS_OF_FIGURES[name]
    assert text == text.strip()
    assert text.endswith(".")
    assert "  " not in text
    assert "captions" in (WORKFLOW / "report" / "figure.rst").read_text()


def test_no_caption_is_a_setting():
    texts = list(CAPTIONS_OF_FIGURES.values())
    assert len(set(texts)) == len(texts)
    for name in FIGURES:
        assert not set(texts) & {str(value) for value in settings(PAPER, name).values()}


@pytest.mark.parametrize(
    ("overlay", "names"),
    [
        # the published values are an input of these figures, and no setting of any
        ({"figures": {"published_overlay": True}}, set()),
        # the example event is chosen where the forecasts are made
        ({"figures": {"example_horizon_lt": 3}}, set()),
        ({"horizon": {"tolerance": 0.1}}, {"horizon_schematic"}),
        ({"horizon": {"events": 100}}, set()),
        ({"search": {"interval_lt": 1}}, {"validation_strategies"}),
        (
            {"forecasters": {"esn": {"connectivity": 10}}},
            {"network_schematic"},
        ),
        (
            {"washout_lt": 0.6},
            {"validation_strategies", "prediction_schematic", "horizon_evaluations"},
        ),
        (
            {"figures": {"flow_points": [9, 9, 9]}},
            {
                "midplane_mean_square",
                "midplane_planes",
                "vorticity_isosurfaces",
                "suppressed_event",
            },
        ),
    ],
)
def test_figures_read_what_they_need_and_nothing_else(overlay, names):
    assert changed(overlay) == names


def test_figures_show_the_case_in_their_name():
    assert figure_case(PAPER, "classification_scores", "_Re800") == "Re800"
    assert figure_case(PAPER, "classification_scores", "") == "Re400"
    assert files_of(PAPER, FIGURES["classification_scores"], "Re800") == {
        "percentiles": "Re800/tables/classification_percentiles.csv"
    }
    other = campaign(
        {"figures": {"example_case": "Re600"}, "control": {"sweep": {"cases": ["Re400"]}}}
    )
    assert figure_case(other, "classification_scores", "") == "Re600"


def test_files_of_figures_are_those_of_the_example():
    found = {name: files_of(PAPER, figure, "Re400") for name, figure in FIGURES.items()}
    assert found["network_schematic"] == {
        "hyperparameters": "Re400/esn-N2000-RV-seed0/hyperparameters.json"
    }
    assert found["prediction_examples"] == {"examples": "Re400/esn-N2000-RV-seed0/examples.nc"}
    assert found["observable_and_density"] == {"observable": "Re400/ensemble.nc", "exponents": []}
    computed = campaign({"case_defaults": {"lyapunov": {"time_unit": "computed"}}})
    assert files_of(computed, FIGURES["observable_and_density"], "Re400") == {
        "observable": "Re400/ensemble.nc",
        "exponents": "Re400/lyapunov.json",
    }
    assert found["suppressed_event"] == {
        "event": "Re400/control/esn-N2000-RV-seed0/"
        "prediction_triggered-prediction_time2-window1/suppressed_event.nc"
    }
    assert found["horizon_schematic"] == {}


def test_the_paper_has_all_tables_but_those_of_other_training_series():
    declared = {layout for table in TABLES.values() for layout in table.latex}
    assert set(latex_names(PAPER)) == declared - {"control_choices"}
    others = {"training_realisations", "control_choices", "ranking"}
    assert set(TABLES) - set(table_names(PAPER)) == others


def test_stages_that_are_switched_off_have_no_tables():
    off = {"forecasters": {"esn": None, "equations": None}}
    without = campaign({"control": off, "statistics": off})
    gone = {
        *("control", "control_percentiles", "control_density"),
        *("control_strategies", "control_differences"),
        *("statistics", "statistics_intervals", "statistics_percentiles"),
        *("survival", "survival_percentiles", "survival_curve", "survival_curve_percentiles"),
        *("lyapunov_spectrum", "lyapunov_spectrum_percentiles"),
        *("kaplan_yorke", "kaplan_yorke_percentiles"),
    }
    assert set(table_names(PAPER)) - set(table_names(without)) == gone
    assert not {typeset(TABLES)[name]["source"] for name in latex_names(without)} & gone


def test_tables_are_of_the_cases_that_have_them():
    one = campaign({"statistics": {"forecasters": {"esn": {"neurons": [500]}}}})
    cases = cases_of_tables(one)
    assert cases["statistics"] == cases["statistics_percentiles"] == ["Re400"]
    assert cases["horizon"] == ["Re400", "Re600", "Re800", "Re1000"]


def test_parameters_of_the_shear_flow_are_the_papers():
    system = make_system("mfe", {"reynolds": 600.0})
    rows = described_parameters("mfe", parameters_of(system))
    assert [row[0] for row in rows] == ["L_x", "L_y", "L_z", r"\mathrm{Re}"]
    assert [row[2] for row in rows][1::2] == [2.0, 600.0]


def test_parameters_of_another_system_have_their_own_names():
    rows = described_parameters("lorenz63", parameters_of(make_system("lorenz63", {"rho": 30.0})))
    assert [r"\mathrm{rho}", "Parameter of the equations", 30.0] in rows

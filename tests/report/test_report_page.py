"""What the page of the report is made of; test_miniature.py opens a whole one in a browser."""

import copy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import yaml
from snakemake.utils import update_config

from burstcast.figures.registry import available_figures
from burstcast_report.page import (
    Flagged,
    computed,
    other_settings,
    page,
    times_of_rules,
    title_of,
)
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.costs.model import CostModel
from burstcast_workflow.costs.records import rule_costs
from burstcast_workflow.figures.registry import FIGURES, is_of_several_cases
from burstcast_workflow.tables.declarations import SECTIONS

ROOT = Path(__file__).parents[2]
CONFIG = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))


def loaded(overlay=None):
    config = copy.deepcopy(CONFIG)
    update_config(config, overlay or {})
    return load(config)


def test_sections_keep_their_order_where_they_are_sorted_by_name():
    titles = list(SECTIONS.values())
    assert titles == sorted(titles)
    assert [*FIGURES] == sorted(FIGURES, key=lambda name: SECTIONS[FIGURES[name].section])
    assert sorted(FIGURES) == available_figures()


def test_figures_of_several_cases_belong_to_none():
    several = {name for name, figure in FIGURES.items() if is_of_several_cases(figure)}
    one = {"by_reynolds", "control_density", "lost_skill", "skill_by_parameter"}
    assert several == one


def test_names_are_spelt_for_people():
    assert title_of("long_term_density") == "Long-term density"
    assert title_of("kaplan_yorke_percentiles") == "Kaplan-Yorke percentiles"
    assert title_of("lyapunov_spectrum") == "Lyapunov spectrum"


def test_the_papers_settings_are_no_others():
    assert other_settings(loaded()) == []


def test_other_settings_are_told_beside_the_papers():
    config = loaded({"random_seed": 7, "cases": {"Re600": {"training": {"noise": 0.05}}}})
    assert other_settings(config) == [
        ("cases.Re600.training.noise", "0.05", ""),
        ("random_seed", "7", "2022"),
    ]


def test_what_was_computed_is_counted_by_case(tmp_path):
    (tmp_path / "dataset.csv").write_text(
        "case,series_kept,events_per_series\n"
        + "".join(f"Re{reynolds},1897,4.567\n" for reynolds in (400, 600, 800, 1000))
    )
    first, second, *_ = computed(Campaign(loaded()), tmp_path)
    assert first == {
        "case": "Re400",
        "series": "1897",
        "extreme events per series": "4.57",
        "networks": "120",
        "of neurons": "500, 1000, 1500, 2000, 2500, 3000",
        "validated by": "RV, SSV",
        "seeds": "10",
        "beside them": "equations, equations_noisy",
    }
    assert (second["case"], second["networks"], second["of neurons"]) == ("Re600", "20", "2000")


def test_times_are_told_rule_by_rule():
    costs = pd.DataFrame(
        {
            "rule": ["latex", "train", "figure"],
            "records": [1, 2, 0],
            "minutes": [1 / 60, 121.5, np.nan],
            "longest_seconds": [1, 7200, np.nan],
            "memory_mib": [0, 120.4, np.nan],
        }
    )
    names = ["rule", "jobs", "time", "longest", "most memory"]
    assert times_of_rules(costs) == [
        dict(zip(names, ["train", "2", "2.0 h", "2.0 h", "120 MiB"], strict=True)),
        dict(zip(names, ["latex", "1", "1.0 s", "1.0 s", "0 MiB"], strict=True)),
    ]


def test_nothing_in_a_table_ends_the_element_that_it_stands_in(tmp_path):
    tables = tmp_path / "results" / "mine" / "tables"
    tables.mkdir(parents=True)
    (tables / "dataset.csv").write_text(
        "case,series_kept,events_per_series\n"
        + "".join(f"Re{reynolds},9,1\n" for reynolds in (400, 600, 800, 1000))
    )
    (tables / "warnings.csv").write_text(
        "case,forecaster,neurons,validation,warning,finding,advice\n"
        "Re400,esn,500,RV,odd,</script><b>,a & b\n"
    )
    flagged = [
        Flagged(tables / f"{name}.csv", {"table": name}, "<p>caption</p>")
        for name in ("warnings", "dataset")
    ]
    campaign = Campaign(loaded())
    nothing = SimpleNamespace(rules=[], dag=SimpleNamespace(jobs=[]))
    costs = rule_costs(nothing, CostModel(campaign))
    text = page(flagged, campaign, tables.parent, "<p>introduction</p>", costs)
    assert text.count("</script>") == 3  # two tables, and the page's own
    assert "&lt;/script&gt;&lt;b&gt;. Try: a &amp; b." in text
    assert text.index("1 Flow and data") < text.index("8 Warning signs")
    assert "<p>introduction</p>" in text
    assert "random seed 2022. This page" in text  # nobody knows when
    assert "3 Forecasts" not in text  # no section of nothing
    assert "config.yaml</code>), all of which" in text

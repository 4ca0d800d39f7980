"""What the page of a campaign says, beside what test_miniature.py finds on a whole one."""

import copy

import pandas as pd
from helpers_configs import campaign, paper_with

from burstcast_workflow.campaign.loading import load
from burstcast_workflow.figures.report import other_settings, report_of
from burstcast_workflow.jobs.report import rows_of


def test_the_papers_settings_are_no_others():
    paper = load(paper_with())
    assert other_settings(paper) == []
    here = copy.deepcopy(paper)
    here["search"]["grid"] += 1
    here["cache_gb"], here["results"] = 1, "results/elsewhere"
    here["case_defaults"]["density"]["range"] = None
    settings = other_settings(here)
    assert ["search.grid", str(here["search"]["grid"]), str(paper["search"]["grid"])] in settings
    assert {path for path, *_ in settings} == {"search.grid", "case_defaults.density.range"}


def test_the_paper_in_a_row_for_each_case():
    row, *others = report_of(campaign())["cases"]
    assert row["case"] == "Re400"
    assert (row["networks"], row["of neurons"]) == ("120", "500, 1000, 1500, 2000, 2500, 3000")
    assert {(other["networks"], other["of neurons"]) for other in others} == {("20", "2000")}
    assert row["seeds"] == "10"
    assert row["validated by"] == "RV, SSV"
    assert row["forecasters"] == "equations, equations_noisy, esn"


def test_numbers_are_short_and_missing_ones_empty():
    table = pd.DataFrame({"case": ["a", None], "n": [1200, 3], "x": [0.123456, float("nan")]})
    assert rows_of(table) == [
        {"case": "a", "n": "1200", "x": "0.123"},
        {"case": "", "n": "3", "x": ""},
    ]
    assert rows_of(None) == []

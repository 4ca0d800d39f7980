"""What rules ask for each job, without Snakemake's planning."""

import re
from pathlib import Path

import pytest
import yaml
from helpers_rules import Wildcards
from snakemake.utils import update_config

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.costs.model import CostModel
from burstcast_workflow.figures.jobs import FigureJobs, captions
from burstcast_workflow.harness.settings import THRESHOLDS
from burstcast_workflow.project import code_of
from burstcast_workflow.stages.stages import Stages, of_job, one_of
from snaketrust.fingerprint import Sources

ROOT = Path(__file__).parents[2]
PUBLISHED = "resources/published_percentiles.csv"


def stages(*overlays):
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    for overlay in overlays:
        update_config(config, overlay)
    campaign = Campaign(load(config))
    return Stages(campaign, Sources(code_of(ROOT)), CostModel(campaign))


@pytest.fixture(scope="module")
def paper():
    return stages()


QUANTILE = {"case_defaults": {"event_threshold": {"quantile": 0.9}}}
JOB = Wildcards(case="Re600", forecaster="esn-N2000-RV-seed3")


def test_wildcards_of_some_names_and_of_none():
    assert re.fullmatch(one_of(["Re400", "a.b"]), "a.b")
    assert not re.fullmatch(one_of(["Re400", "a.b"]), "aXb")
    assert not re.fullmatch(one_of([]), "")


def test_files_of_cases_and_forecasters(paper):
    assert paper.of_cases("dataset.json", ["Re600"]) == ["results/paper/Re600/dataset.json"]
    assert len(paper.of_cases("dataset.json")) == 4
    assert len(paper.of_forecasters("forecast.nc")) == 180 + 2 * 4
    found = paper.files_in_case("horizon.nc")(JOB)
    assert len(found) == 2 * 10 + 2
    assert all(path.startswith("results/paper/Re600/") for path in found)
    assert paper.files_in_case("x.nc", lambda campaign, case: [])(JOB) == []
    (scan,) = [paper.scan_of_network("csv")(JOB)]
    assert scan == "results/paper/Re600/scan/esn-N2000-seed3-RV+SSV.csv"


def test_tables_of_a_case_that_has_none(paper):
    tables = paper.tables_of_case("dataset training_realisations")
    assert tables["dataset"](JOB) == "results/paper/Re600/tables/dataset.csv"
    assert tables["training_realisations"](JOB) == []


def test_thresholds_are_inputs_where_they_are_quantiles(paper):
    assert paper.unknowns_of("events") == {}
    other = stages(QUANTILE)
    other.settings_of("events", "case.event_threshold")
    other.settings_of("simulate", "case.ensemble")
    thresholds = other.unknowns_of("events")[THRESHOLDS]
    assert thresholds(JOB) == ["results/paper/Re600/event_threshold.json"]
    assert other.unknowns_of("simulate")[THRESHOLDS](JOB) == []


def test_values_of_a_stage_are_given_or_asked_for(paper):
    values = {"given": 3, "asked": of_job(lambda wildcards: wildcards["case"])}
    settings = paper.settings_of("events", "case.event_threshold", **values)(JOB)
    assert dict(settings) == {"case.event_threshold": 0.1, "given": 3, "asked": "Re600"}


def test_more_memory_for_each_attempt_and_what_the_cache_keeps(paper):
    needed = paper.needs("forecast", "forecast", cached=True)
    first, second = (needed["mem_mb"](JOB, attempt) for attempt in (1, 2))
    assert 0 < first < second
    assert needed["cached"] == 1


def test_a_figure_of_another_case_and_its_overlay():
    job = Wildcards(figure="long_term_density", of_case="_Re600")
    for overlay in (False, True):
        made = stages({"figures": {"published_overlay": overlay}})
        drawn = FigureJobs(made, Sources(code_of(ROOT)), PUBLISHED)
        assert drawn.case(job) == "Re600"
        assert ("published" in drawn.files(job)) == overlay
        assert drawn.labels(job) == {"figure": "long_term_density", "case": "Re600"}
        assert drawn.category(job).endswith("Long-term statistics")


def test_every_figure_and_table_has_a_caption(paper):
    found = captions(paper.campaign)
    assert all(text for texts in found.values() for text in texts.values())
    assert {"figures", "tables"} == set(found)

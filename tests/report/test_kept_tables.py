"""Kept tables: what is collected, what is refused, and how rows become cells."""

import re
import shutil
from pathlib import Path

import keep
import numpy as np
import pandas as pd
import pytest
import yaml
from kept_tables import Tables, part, table, text

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.tables.registry import table_names
from burstcast_workflow.tracking.results import Making, digest, note
from burstcast_workflow.tracking.run import VARIABLE, begin

ROOT = Path(__file__).parents[2]


@pytest.fixture
def results(tmp_path, monkeypatch):
    """Results of a finished campaign, and an empty directory where tables are kept."""
    monkeypatch.setattr(keep, "KEPT", tmp_path / "kept")
    keep.KEPT.mkdir()
    results = tmp_path / "results" / "small"
    preset = yaml.safe_load((ROOT / "workflow/presets/tiny.yaml").read_text(encoding="utf-8"))
    config = load(preset, defaults=ROOT / "config.yaml")
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.chdir(tmp_path)
    begin(str(results), config, [], [], "abc")
    (results / "tables").mkdir()
    for name in table_names(Campaign(config)):
        put_table(results, name, "case,seed,f_score\nRe400,0,0.5\nRe400,1,0.75\n")
    return results


def put_table(results, name, text):
    path = results / "tables" / f"{name}.csv"
    path.write_text(text)
    note(path, digest(path), path.name, Making("", {}))


def test_collected_tables_are_those_of_the_campaign(results, capsys):
    put_table(results, "survival", "")
    for _ in range(2):  # the second time over the first
        assert keep.main(["collect", f"{results}/"]) == 0
        kept = {path.name for path in (keep.KEPT / "small").iterdir()}
        assert {"classification.csv", "versions.json"} < kept < keep.COLLECTED
        assert "survival.csv" not in kept  # empty: of a campaign without long runs
        assert [path.name for path in keep.KEPT.iterdir()] == ["small"]
    assert keep.main(["same", "small", str(results)]) == 0
    # one network alone, its last digit another one
    put_table(results, "classification", "case,seed,f_score\nRe400,1,0.7500000001\n")
    assert keep.main(["same", "small", str(results)]) == 1
    assert "classification: Re400,1,0.7500000001" in capsys.readouterr().out
    # a later version has a further column
    put_table(results, "classification", "case,events,seed,f_score\nRe400,7,1,0.75\n")
    assert keep.main(["same", "small", str(results)]) == 0
    put_table(results, "survival", "case,seed\nRe400,0\n")  # it was empty, and not kept
    assert keep.main(["same", "small", str(results)]) == 1
    assert "survival: is not kept" in capsys.readouterr().out
    put_table(results, "classification", "case,f_score\nRe400,0.75\n")
    assert keep.main(["same", "small", str(results)]) == 1
    assert "classification: without seed" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("results/small/..", "holds no campaign"),
        (".", "holds no campaign"),
        ("", "holds no campaign"),
        ("/", "holds no campaign"),
        ("results/smal", "holds no campaign"),
        ("results/small/tables", "holds no campaign"),
        ("results/page.md.jinja", "cannot be the name of a campaign"),
        ("results/unfinished", "horizon.csv is missing; run the campaign first"),
        ("results/edited", "is not what its job wrote"),
        ("results//small/", r"small holds what was not collected \(notes.txt\)"),
    ],
)
def test_nothing_is_removed_that_was_not_collected(path, message, results, monkeypatch, capsys):
    """Neither all kept tables nor all of docs, whatever directory is named."""
    monkeypatch.chdir(results.parents[1])
    for name in ("page.md.jinja", "unfinished", "edited"):
        shutil.copytree(results, results.parent / name)
    (results.parent / "unfinished/tables/horizon.csv").unlink()
    (results.parent / "edited/tables/horizon.csv").write_text("case\n")
    (keep.KEPT / "page.md.jinja").write_text("of the page")
    assert keep.main(["collect", str(results)]) == 0
    (keep.KEPT / "small" / "notes.txt").write_text("a note")
    before = {path: path.is_file() and path.read_bytes() for path in keep.KEPT.rglob("*")}
    assert keep.main(["collect", path]) == 2
    assert re.search(message, capsys.readouterr().err)
    assert before == {path: path.is_file() and path.read_bytes() for path in before}


@pytest.mark.parametrize(
    ("campaign", "where", "message"),
    [("small", "resutls", "no tables to compare: "), ("smal", "results", "compare with: collect")],
)
def test_nothing_is_not_the_same(campaign, where, message, results, capsys):
    assert keep.main(["collect", str(results)]) == 0
    other = results.parents[1] / where / "small"
    assert keep.main(["same", campaign, str(other)]) == 2
    assert message in capsys.readouterr().err


# -- rows and cells --------------------------------------------------------------------------------


def test_mistakes_in_templates_and_conditions_are_told(tmp_path):
    assert text("{p50:.2f} ({low})||{p50:.2f}||none", {"p50": 1.0, "low": np.nan}) == "1.00"
    with pytest.raises(KeyError):  # a column that no table has is a mistake, not a gap
        text("{p5}||x", {"p50": 1.0})
    rows = pd.DataFrame({"size": [10, 10], "f": [0.5, 0.4]})
    with pytest.raises(ValueError, match=r"two cells for 10, f: 0\.5 and 0\.4"):
        table("n", part(rows, "{size}", {"f": "{f}"}))
    assert not Tables(tmp_path)
    (tmp_path / "scores_percentiles.csv").write_text("case,metric,p50\nA,f,0.5\n")
    with pytest.raises(LookupError, match=r"scores: 0 rows of f with \{'case': 'B'\}, not one"):
        Tables(tmp_path).row("scores", "f", case="B")


def test_further_networks_of_another_campaign_count_once(tmp_path):
    head = "case,forecaster,neurons,validation,seed,f_score\n"
    for name, rows in {
        "first": "A,esn,100,RV,0,0.25\nA,esn,200,RV,0,0.5\n",
        "more": "A,esn,100,RV,0,0.75\nA,esn,400,RV,0,1.0\n",
    }.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "classification.csv").write_text(head + rows)
    rows = Tables(tmp_path / "first", tmp_path / "more").rows("classification")
    assert dict(zip(rows["neurons"], rows["f_score"], strict=True)) == {100: 0.25, 200: 0.5, 400: 1}

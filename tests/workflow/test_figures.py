"""Figures found by name: what they declare, and the script that draws all of them."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from helpers_rebuilds import loaded_script

from burstcast.figures.registry import Declaration, available_figures, caption, declaration
from burstcast.files.netcdf import Variable, write_netcdf
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.figures import registry
from burstcast_workflow.figures.registry import cases_of, files_of, settings_of
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_json

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def script():
    return loaded_script("figures/figure.py")


def drawn(script, directory, name, settings, **files):
    figures = {"pdf": str(directory / "figure.pdf"), "png": str(directory / "figure.png")}
    settings = Settings(settings, {"rule": "figure", "figure": name})
    script.figure(**figures, settings=settings, **files)
    assert settings.unread() == []
    return {path.name: path.read_bytes() for path in sorted(directory.glob("figure.*"))}


SCHEMATIC = {
    "horizon.longest_lead_time_lt": 10,
    "horizon.lead_time_step_lt": 0.5,
    "horizon.tolerance": 0.2,
}


def test_a_figure_is_written_as_pdf_and_png(script, tmp_path):
    found = drawn(script, tmp_path, "horizon_schematic", {**SCHEMATIC, "shown.symbol": "k"})
    assert list(found) == ["figure.pdf", "figure.png"]
    assert found["figure.pdf"].startswith(b"%PDF")
    assert found["figure.png"].startswith(b"\x89PNG")


def test_nothing_is_written_of_a_figure_that_cannot_be_drawn(script, tmp_path):
    with pytest.raises(ValueError, match="nosuchcommand"):
        drawn(
            script, tmp_path, "horizon_schematic", {**SCHEMATIC, "shown.symbol": r"\nosuchcommand"}
        )
    assert list(tmp_path.iterdir()) == []


def test_inputs_that_a_figure_does_not_declare_are_an_error(script, tmp_path):
    write_json(tmp_path / "more.json", {})
    settings = {**SCHEMATIC, "shown.symbol": "k"}
    with pytest.raises(TypeError, match="unexpected keyword argument 'more'"):
        drawn(script, tmp_path, "horizon_schematic", settings, more=str(tmp_path / "more.json"))


def test_inputs_are_the_contents_of_files(script, tmp_path):
    table, record, arrays = (str(tmp_path / f"x.{end}") for end in ("csv", "json", "nc"))
    Path(table).write_text("case,value\nRe400,1.5\n")
    write_json(record, {"tikhonov": 1e-9})
    identity = '{"rule": "train", "forecaster": "esn-N40-RV-seed0"}'
    write_netcdf(
        arrays, {"time": Variable(("time",), np.arange(3.0), "1", "")}, {"identity": identity}
    )
    rows = [{"case": "Re400", "value": 1.5}]
    assert script._content(table, "").to_dict("records") == rows
    assert [one.to_dict("records") for one in script._content([table, table], "")] == [rows, rows]
    assert script._content(record, "") == {"tikhonov": 1e-9}
    found = script._content(arrays, "")
    assert found["forecaster"] == "esn-N40-RV-seed0"
    assert found["time"].tolist() == script._content(arrays, "time").tolist() == [0, 1, 2]
    assert script._content([], "") is None


def test_a_module_without_a_declaration_is_no_figure():
    with pytest.raises(
        ValueError, match=r"FIGURE = Declaration\(\.\.\.\) in burstcast/figures/reg"
    ):
        declaration("registry")


def test_captions_are_read_from_the_text():
    assert (
        caption("horizon_schematic") == "Measurement of the prediction horizon of an extreme event."
    )


def test_an_unknown_section_names_those_that_there_are(monkeypatch):
    new = {"new": Declaration("contrl", 10)}
    monkeypatch.setattr(registry, "available_figures", lambda: [*new])
    monkeypatch.setattr(registry, "declaration", new.__getitem__)
    with pytest.raises(ValueError, match=r"the section 'contrl'.*did you mean 'control'"):
        registry._declared()


def asked(campaign, figure):
    return (
        cases_of(campaign, figure),
        files_of(campaign, figure, "Re400"),
        settings_of(campaign, figure, "Re400"),
    )


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"inputs": {"x": "exampel/x.nc"}}, "place 'exampel' .did you mean 'example'"),
        ({"settings": "x=shown.symbols"}, "setting to show 'symbols' .did you mean 'symbol'"),
        ({"cases": "all"}, "choice of cases 'all'.*known are example, every"),
    ],
)
def test_an_unknown_name_in_a_declaration_is_told(said, message):
    config = yaml.safe_load((ROOT / "config.yaml").read_text(encoding="utf-8"))
    campaign, figure = Campaign(load(config)), Declaration("control", 10, **said)
    with pytest.raises(ValueError, match=message):
        asked(campaign, figure)


def test_figures_of_a_section_have_places_of_their_own():
    places = [(one.section, one.position) for one in map(declaration, available_figures())]
    assert len(set(places)) == len(places)

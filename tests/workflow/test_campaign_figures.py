"""Figures of a campaign: which there are, what they show, and the script that draws them."""

import inspect
import shutil
from pathlib import Path

import numpy as np
import pytest
from helpers_configs import TINY, campaign, networks, read
from helpers_rebuilds import ROOT, loaded_script
from matplotlib.figure import Figure

from burstcast.base.declared import File, at
from burstcast.base.declared import read as read_file
from burstcast.base.files.netcdf import Variable, write_netcdf
from burstcast.figures import registry as drawn_figures
from burstcast.figures.registry import caption, figure, figure_of
from burstcast.statistics.densities import Histogram
from burstcast.statistics.measures import best_network
from burstcast.statistics.reductions import LongTermStatistics, StateMoments
from burstcast.systems.registry import make_system, parameters_of
from burstcast.tables.parameters import described_parameters
from burstcast_workflow.campaign.shown import Choices, Shown
from burstcast_workflow.figures import declarations, registry
from burstcast_workflow.figures.registry import (
    FIGURES,
    figure_case,
    figure_names,
    files_of,
    settings_of,
)
from burstcast_workflow.harness.settings import JobSettings
from burstcast_workflow.harness.storage import write_json
from burstcast_workflow.jobs.inputs import content_of
from burstcast_workflow.tables.declarations import TABLES
from burstcast_workflow.tables.registry import cases_of_tables, latex_names, table_names, typeset

PAPER = campaign()


def test_a_figure_is_written_as_pdf_and_png_or_not_at_all(tmp_path, monkeypatch):
    script = loaded_script("figures/figure.py")
    figures = {end: str(tmp_path / f"figure.{end}") for end in ("pdf", "png")}
    values = {"longest_lead_time_lt": 10, "lead_time_step_lt": 0.5, "tolerance": 0.2}
    values = {f"horizon.{name}": value for name, value in values.items()}
    identity = {"rule": "figure", "figure": "horizon_schematic"}
    settings = JobSettings({**values, "case.space.observable_symbol": "k"}, identity)
    save = Figure.savefig

    def save_no_png(figure, file, **options):
        if options["format"] == "png":
            raise OSError("no space left")
        save(figure, file, **options)

    with monkeypatch.context() as broken:
        broken.setattr(Figure, "savefig", save_no_png)
        with pytest.raises(OSError, match="no space"):
            script.figure(**figures, settings=settings)
    assert list(tmp_path.iterdir()) == []
    script.figure(**figures, settings=settings)
    assert settings.unread() == []
    assert Path(figures["pdf"]).read_bytes().startswith(b"%PDF")
    assert Path(figures["png"]).read_bytes().startswith(b"\x89PNG")


def test_inputs_are_the_contents_of_files(tmp_path):
    table, record, arrays = (str(tmp_path / f"x.{end}") for end in ("csv", "json", "nc"))
    Path(table).write_text("case,value\nRe400,1.5\n")
    write_json(record, {"tikhonov": 1e-9})
    identity = {"identity": '{"rule": "train", "forecaster": "esn-N40-RV-seed0"}'}
    write_netcdf(arrays, {"time": Variable(("time",), np.arange(3.0), "1", "")}, identity)
    rows = [{"case": "Re400", "value": 1.5}]

    def content(path, place="case/x"):
        return content_of(path, File(place, ""))

    assert content(table).to_dict("records") == rows
    assert [both.to_dict("records") for both in content([table, table])] == [rows, rows]
    assert content(record) == {"tikhonov": 1e-9}
    stored = content(arrays)
    assert (stored["forecaster"], stored["neurons"], stored["seed"]) == ("esn-N40-RV-seed0", 40, 0)
    assert stored["time"].tolist() == content(arrays, "case/x.nc:time").tolist() == [0, 1, 2]
    assert content(arrays, "case/x.nc:path") == arrays
    assert content([]) is None


# -- declarations ----------------------------------------------------------------------------------


def shown(of, figure, case="Re400"):
    """Settings of a figure's job."""
    return settings_of(of, FIGURES[figure], case)


def test_captions_are_sentences_that_the_report_shows_and_no_settings():
    captions = {name: caption(name) for name in FIGURES}
    text = "Measurement of the prediction horizon of an extreme event."
    assert captions["horizon_schematic"] == text
    assert all(text == " ".join(text.split()) and text[-1] == "." for text in captions.values())
    values = {str(value) for name in FIGURES for value in shown(PAPER, name).values()}
    assert values.isdisjoint(captions.values())
    assert len({*captions.values()}) == len(FIGURES)
    assert len({(drawn.section, drawn.position) for drawn in FIGURES.values()}) == len(FIGURES)
    assert "captions" in (ROOT / "workflow/report/figure.rst").read_text()


def drawing(*, section="control", cases="example_case", **defaults):
    """A figure with arguments of these defaults."""

    def draw(**_):
        raise AssertionError

    kind = inspect.Parameter.KEYWORD_ONLY
    parameters = [inspect.Parameter(name, kind, default=defaults[name]) for name in defaults]
    draw.__signature__ = inspect.Signature(parameters)
    return figure(section=section, position=10, cases=cases)(draw)


def test_unknown_names_in_a_declaration_are_told(monkeypatch):
    with pytest.raises(TypeError, match=r"registry.py has no function draw with the decorator"):
        figure_of("registry")
    monkeypatch.setattr(drawn_figures, "available_figures", lambda: ["new"])
    monkeypatch.setattr(drawn_figures, "caption", str)
    for given, message in (
        ({"section": "contrl"}, r"figure new .*the section 'contrl' .did you mean 'control'"),
        ({"cases": "evry"}, r"figure new .*the choice of cases 'evry' .did you mean 'every'"),
    ):
        monkeypatch.setattr(drawn_figures, "figure_of", lambda _, given=given: drawing(**given))
        with pytest.raises(ValueError, match=message):
            registry._declared()
    with pytest.raises(AttributeError, match="no attribute 'exampel'"):
        files_of(PAPER, drawing(x=read_file("exampel/x.nc")), "Re400")
    for path in ("shown.symbols", "case.space.dimensions", "case.lyapunov.x", "figurs.x", "job.x"):
        with pytest.raises(LookupError, match=f"there is no setting {path}"):
            settings_of(PAPER, drawing(x=at(path)), "Re400")


EDITS = {
    "a caption": ("src/burstcast/figures/reliability.py", lambda text: f"{text}# an edit\n"),
    "a part": ("src/burstcast/figures/parts/looks.py", lambda text: f"{text}\nOTHER = 1\n"),
    "a module below": ("src/burstcast/base/names.py", lambda text: f"{text}\nOTHER = 1\n"),
    "the check": ("src/burstcast_workflow/campaign/shown.py", lambda text: f"{text}\n"),
    "sections": ("workflow/tables.yaml", lambda text: f"{text}\n# an edit\n"),
    "a new figure": ("src/burstcast/figures/other.py", lambda _: '"""A figure."""\n'),
}


def test_what_figures_declare_is_remembered_until_any_of_the_code_changes(tmp_path, monkeypatch):
    project = tmp_path / "project"
    shutil.copytree(ROOT / "src", project / "src", ignore=shutil.ignore_patterns("*.pyc"))
    (project / "workflow").mkdir()
    shutil.copy(ROOT / "workflow" / "tables.yaml", project / "workflow")
    monkeypatch.setattr(declarations, "project_root", lambda: project)
    monkeypatch.chdir(tmp_path)
    read_now = registry._declared()
    before = declarations.remembered()
    assert not before.figures
    declarations.keep(before.code, read_now)
    known = declarations.remembered()
    assert list(known.figures.items()) == list(read_now.items())
    assert known.code == before.code
    for edited, edit in EDITS.values():
        path = project / edited
        content = path.read_text() if path.exists() else None
        path.write_text(edit(content))
        assert not declarations.remembered().figures
        declarations.keep(known.code, {})  # declarations of neither state
        if content is None:
            path.unlink()
        else:
            path.write_text(content)
        assert declarations.remembered() == known
    (project / "src/burstcast/figures/own_flow.py").rename(project / "src/burstcast/figures/x.py")
    assert not declarations.remembered().figures
    Path(".snakemake/burstcast_figures.json").write_text("[]")
    assert not declarations.remembered().figures


# -- of long-term statistics, flow and control -----------------------------------------------------

FLOW = {"midplane_planes", "vorticity_isosurfaces"}
STATISTICS = {"long_term_density", "profile_errors", "midplane_mean_square", "own_flow"}
CONTROL = {"control_schematic", "suppressed_event", "control_density", "control_tradeoff"}
LORENZ = {"lorenz": {"system": "lorenz63", "actuation": {"parameters": {"rho": 10}}}}


def block(neurons, validation=("RV",), seeds=2, **cases):
    esn = networks(neurons, validation, seeds)
    return {**cases, "forecasters": {**esn, "equations": {}, "equations_noisy": {}}}


def of_blocks(*blocks, **overlay):
    return campaign(overlay, blocks=list(blocks))


def stage_figures(of):
    """Figures of these stages, of all cases."""
    figures = figure_names(of)
    assert len(set(figures)) == len(figures)
    heads = tuple(f"{name}_" for name in FLOW | STATISTICS | CONTROL)
    return {figure for figure in figures if f"{figure}_".startswith(heads)}


OFF = {"forecasters": {"esn": None, "equations": None}}
SSV = {"forecasters": {"esn": {"validation": ["SSV"]}, "equations": None}}
OTHERS = {"forecasters": {"esn": None, "equations": {}, "equations_noisy": {}}}
SMALL = block([2000], reynolds=[400])
MORE = {f"{name}_Re600" for name in (*STATISTICS, "control_tradeoff")}
SMALLER = SMALL, block([500], reynolds=[600])
UNCONTROLLED = {"cases": {"Re600": {"actuation": None}}, "statistics": SSV, "control": SSV}
OF_LORENZ = {"example_case": "lorenz", "flow_event": {"peak": 45}}


@pytest.mark.parametrize(
    ("blocks", "overlay", "figures"),
    [
        ([SMALL], {}, FLOW | STATISTICS | CONTROL),
        # other cases have their own statistics, and share the densities under control
        ([block([2000], reynolds=[600, 400])], {}, FLOW | STATISTICS | CONTROL | MORE),
        # nothing is drawn of a size that one case alone has
        (SMALLER, {}, FLOW | STATISTICS | CONTROL),
        # nor of stages that are switched off
        ([SMALL], {"control": OFF}, FLOW | STATISTICS),
        ([SMALL], {"statistics": OFF}, FLOW | CONTROL),
        ([SMALL], {"case_defaults": {"actuation": None}}, FLOW | STATISTICS),
        # nor of forecasters that are no networks, which have tables
        ([SMALL], {"statistics": OTHERS, "control": OTHERS}, FLOW),
        # a strategy that no network has leaves none
        ([SMALL, block([2000], ["SSV"], reynolds=[600])], UNCONTROLLED, FLOW | STATISTICS),
        # nor has a system that is no flow
        (
            [block([2000], cases=["lorenz"])],
            {"cases": LORENZ, "figures": OF_LORENZ},
            {"long_term_density", "own_flow", *CONTROL} - {"suppressed_event"},
        ),
    ],
)
def test_figure_names_are_those_of_the_stages_and_cases_that_there_are(blocks, overlay, figures):
    made = of_blocks(*blocks, **overlay)
    assert stage_figures(made) == figures
    by_control = overlay.get("control") not in (OFF, SSV) and "case_defaults" not in overlay
    assert ("control_percentiles" in table_names(made)) == by_control


def test_densities_of_control_are_of_one_system_one_size_and_not_of_the_sweep():
    swept = of_blocks(
        block([500, 2000], seeds=3, reynolds=[600, 400], cases=["lorenz"]),
        cases=LORENZ,
        figures={"example_case": "Re400"},
        control={
            "forecasters": {"esn": {"neurons": [500, 2000]}},
            "sweep": {"cases": ["Re400"], "seeds": 2},
        },
    )
    assert {run.prediction_time_lt for run in swept.control_runs} == {1, 2, 3, 4, 5}
    assert {"control_density", "control_density_lorenz"} <= stage_figures(swept)
    network = {"neurons": 2000, "validation": "RV"}
    of_re = [{"case": case, **network} for case in ("Re400", "Re600")]
    assert shown(swept, "control_density")["shown.panels"] == of_re
    (of_lorenz,) = shown(swept, "control_density", "lorenz")["shown.panels"]
    assert of_lorenz["case"] == "lorenz"
    assert shown(swept, "long_term_density", "lorenz")["case.space.observable_symbol"] == "z"


def test_a_case_without_networks_of_the_fixed_size_shows_those_that_it_has():
    two_sizes = of_blocks(*SMALLER, control={"forecasters": {"esn": {"neurons": []}}})
    of_control = shown(two_sizes, "control_tradeoff", "Re600")["shown.control_networks"]
    assert of_control == {"neurons": 500, "validation": "RV"}


@pytest.mark.parametrize(
    ("network", "control", "controller"),
    [
        ("esn-N2000-RV-seed2", {}, "esn-N2000-RV-seed2"),
        ("esn-N500-RV-seed2", {"esn": {"neurons": [2000]}}, "esn-N2000-RV-seed0"),
        ("esn-N500-RV-seed2", {"esn": None}, None),
    ],
)
def test_the_suppressed_event_is_the_example_networks_if_it_controls(network, control, controller):
    chosen = of_blocks(
        block([500, 2000], ["SSV", "RV"], reynolds=[600, 400], seeds=3),
        figures={"example_forecaster": network},
        control={"forecasters": control},
    )
    run = Choices(chosen).example_run
    expected = controller and ("Re400", controller, 2)
    assert (run and (run.case, run.controller.identifier, run.prediction_time_lt)) == expected


def test_the_best_network_is_of_the_examples_strategy():
    both = {"statistics": {"forecasters": {"esn": {"validation": ["SSV", "RV"]}}}}
    ssv = {"figures": {"example_forecaster": "esn-N2000-SSV-seed0"}}
    for overlay, expected in ((both, "RV"), (both | ssv, "SSV"), ({"statistics": SSV}, "SSV")):
        made = of_blocks(block([500, 2000], ["SSV", "RV"], reynolds=[400]), **overlay)
        names = [network.name for network in Shown(made, "Re400").long_term_networks]
        assert [(name.neurons, name.validation) for name in names] == [(2000, expected)] * 2


def statistics(*counts):
    moments = StateMoments(sum(counts), np.zeros(2), np.eye(2))
    return LongTermStatistics(Histogram(np.linspace(0, 1, 4), np.array(counts)), moments)


NOTHING, NEAR, NEAREST = statistics(0, 0, 0), statistics(10, 6, 5), statistics(10, 6, 4)


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


# -- what the report consists of -------------------------------------------------------------------


def test_the_paper_has_all_figures_tables_and_those_of_other_cases():
    names = figure_names(PAPER)
    # of other strategies than the paper's, of parts of a state, and of plane flows
    assert set(FIGURES) - set(names) == {
        *("burst_forecast", "burst_vorticity", "control_frontier"),
        *("encoder_loss", "lost_skill", "skill_by_parameter", "return_levels"),
    }
    for case in ("Re600", "Re800", "Re1000"):
        assert f"classification_scores_{case}" in names
        # one size only: nothing to draw against
        assert f"horizon_by_size_{case}" not in names
    assert "classification_scores_Re400" not in names  # the example's case has the plain name
    declared = {layout for table in TABLES.values() for layout in table.latex}
    assert set(latex_names(PAPER)) == declared - {"control_choices"}
    others = {"training_realisations", "control_choices", "ranking", "return_times", "consistency"}
    assert set(TABLES) - set(table_names(PAPER)) == others


def test_no_figure_over_one_reynolds_number_and_each_once():
    overlay = read(TINY)
    block = {**overlay["campaign"][0], "reynolds": [400]}
    assert "by_reynolds" not in figure_names(campaign({**overlay, "campaign": [block]}))
    blocks = PAPER.config.dump()["campaign"]
    twins = {"Twin": {"parameters": {"reynolds": 600}, "lyapunov": {}}}
    twin = {**blocks[1], "reynolds": [400], "cases": ["Twin"]}
    with_twin = campaign({"cases": twins}, blocks=[*blocks, twin])
    assert "Twin" in with_twin.case_names
    assert files_of(with_twin, FIGURES["by_reynolds"], "Re400")["horizons"] == [
        f"Re{reynolds}/tables/horizon_percentiles.csv" for reynolds in (400, 600, 800, 1000)
    ]


def test_the_frontier_is_made_where_other_strategies_control():
    frontier = campaign(read(ROOT / "workflow/presets/beyond_the_paper.yaml"))
    assert figure_names(frontier)[-1] == "control_frontier"
    network = shown(frontier, "control_frontier")["shown.frontier_network"]
    assert network == {"forecaster": "esn", "neurons": 1000, "validation": "RV", "seed": 0}
    assert shown(PAPER, "control_frontier", "Re800")["shown.frontier_network"]["seed"] == 0


def test_figures_show_the_case_in_their_name_or_the_examples():
    assert figure_case(PAPER, "classification_scores", "_Re800") == "Re800"
    assert figure_case(PAPER, "classification_scores", "") == "Re400"
    swept = {"control": {"sweep": {"cases": ["Re400"]}}}
    other = campaign({"figures": {"example_case": "Re600"}, **swept})
    assert figure_case(other, "classification_scores", "") == "Re600"
    drawn = FIGURES["observable_and_density"]
    assert files_of(PAPER, drawn, "Re600")["unit"] == "Re600/time_unit.json"


def test_stages_that_are_switched_off_have_no_tables():
    without = campaign({"control": OFF, "statistics": OFF})
    with_percentiles = ("control", "statistics", "survival", "survival_curve", "kaplan_yorke")
    gone = {f"{name}{end}" for name in with_percentiles for end in ("", "_percentiles")}
    gone |= {"control_density", "control_strategies", "statistics_intervals"}
    gone |= {"lyapunov_spectrum", "lyapunov_spectrum_percentiles"}
    assert set(table_names(PAPER)) - set(table_names(without)) == gone
    assert not {typeset(TABLES)[name]["source"] for name in latex_names(without)} & gone
    cases = cases_of_tables(campaign({"statistics": {"forecasters": {"esn": {"neurons": [500]}}}}))
    assert cases["statistics"] == cases["statistics_percentiles"] == ["Re400"]
    assert cases["horizon"] == ["Re400", "Re600", "Re800", "Re1000"]


def test_parameters_of_other_systems_have_their_own_names():
    rows = described_parameters("lorenz63", parameters_of(make_system("lorenz63", {"rho": 30.0})))
    assert [r"\mathrm{rho}", "Parameter of the equations", 30.0] in rows

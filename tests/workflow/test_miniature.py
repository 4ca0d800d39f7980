"""The paper's campaign in miniature, from end to end, and its tables computed anew by name."""

import json
import re
import shutil
from contextlib import contextmanager

import pytest
import yaml
from helpers_configs import ROOT, paper_with, read
from helpers_rebuilds import digests
from recomputation import TABLES, Recomputation, assert_same_rows, percentiles

from burstcast.files.tables import read_table
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.tables.declarations import SECTIONS
from burstcast_workflow.tables.declarations import TABLES as DECLARED
from burstcast_workflow.tables.registry import table_of, with_percentiles

PRESET = "workflow/presets/miniature.yaml"
METRICS = {
    "hyperparameters": (["spectral_radius", "input_scaling", "tikhonov", "objective"], []),
    "classification": (["precision", "recall", "f_score"], ["prediction_time_lt"]),
    "horizon": (["mean_horizon_lt", "median_horizon_lt"], []),
    "statistics": (["discarded_fraction", "kantorovich", "mean_log_error", "nrmse_uv"], []),
    "survival": (["survived_fraction", "escape_rate"], []),
    "lyapunov_spectrum": (["lyapunov_exponent"], ["number"]),
    "kaplan_yorke": (["kaplan_yorke_dimension"], []),
    "control": (["exceedance_controlled", "reduction", "alarms"], ["prediction_time_lt"]),
}


def recomputation(results, *overlays):
    config = paper_with(read(ROOT / PRESET), *overlays)
    cases = Campaign(config).cases
    records = {name: case.dump() for name, case in cases.items()}
    return Recomputation(results, config, records)


@pytest.fixture(scope="module")
def results(miniature):
    return miniature.project.directory / "results/miniature"


@pytest.fixture(scope="module")
def anew(results):
    return recomputation(results)


def assert_table(results, name, expected):
    assert_same_rows(read_table(results / "tables" / f"{name}.csv"), expected)


def test_it_has_the_shape_of_the_paper():
    paper, small = (yaml.safe_load((ROOT / name).read_text()) for name in ("config.yaml", PRESET))
    for block, miniature_block in zip(paper["campaign"], small["campaign"], strict=True):
        assert block["reynolds"] == miniature_block["reynolds"]
        networks, small_networks = (one["forecasters"]["esn"] for one in (block, miniature_block))
        assert networks["validation"] == small_networks["validation"]
        assert small_networks["seeds"] >= 2
        assert block["forecasters"].keys() == miniature_block["forecasters"].keys()
    assert len(small["campaign"][0]["forecasters"]["esn"]["neurons"]) == 3


def test_it_runs_to_its_end_and_makes_all_that_the_paper_has(miniature, results):
    figures = {path.stem for path in (results / "figures").glob("*.png")}
    cases = ("", "_Re600", "_Re800", "_Re1000")
    for name in ("observable_and_density", "classification_scores", "long_term_density"):
        assert {f"{name}{case}" for case in cases} <= figures
    assert {"by_reynolds", "horizon_by_size", "control_density", "suppressed_event"} <= figures
    assert {path.name for path in (results / "figures").iterdir()} == {
        f"{stem}.{suffix}" for stem in figures for suffix in ("pdf", "png")
    }
    assert "Nothing to be done" in miniature.project.snakemake().text


def test_it_tells_what_its_jobs_took(results):
    rows = read_table(results / "benchmarks/rule_costs.csv")
    assert {"simulate", "scan", "joined_horizon", "figure"} <= set(rows["rule"])
    assert rows["jobs"].equals(rows["records"])
    assert (rows["minutes"] > 0).all()


def test_it_meets_what_a_small_campaign_meets(results):
    """Otherwise the tests below would not see how it is dealt with."""
    tables = results / "tables"
    assert (read_table(tables / "horizon.csv")["events"] == 0).any()
    scores = read_table(tables / "classification.csv")
    assert scores["precision"].isna().any()
    assert scores["recall"].isna().any()
    assert read_table(tables / "control.csv")["reduction"].isna().any()


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_what_the_files_of_the_networks_say(anew, name):
    expected = getattr(anew, name)()
    assert len(expected) > 3
    assert_table(anew.results, name, expected)


@pytest.mark.parametrize("name", METRICS)
def test_percentiles_are_quartiles_over_the_seeds(anew, name):
    table = read_table(anew.results / "tables" / f"{name}.csv")
    metrics, extra = METRICS[name]
    found = read_table(anew.results / "tables" / f"{name}_percentiles.csv")
    assert_same_rows(found[found["metric"].isin(metrics)], percentiles(table, metrics, extra))


def test_parameters_belong_to_their_cases(anew):
    rows = read_table(anew.results / "tables/data_generation_parameters.csv")
    rows, kept = rows.set_index("Explanation"), anew.dataset().set_index("case")["series_kept"]
    for case, record in anew.records.items():
        (column,) = (name for name in rows.columns if case in str(name))
        assert f"{record['parameters']['reynolds']}" in rows.loc["Reynolds number", column]
        assert f"{kept[case]}" in rows.loc["Number of time series", column]


# -- in whatever order, by whatever name -----------------------------------------------------------


def forecasters(neurons, validation, seeds=2, **others):
    networks = {"neurons": neurons, "validation": validation, "seeds": seeds}
    return {**others, "esn": networks, "equations": {}}


NOISY = {"equations_noisy": {}}


PERMUTED = {
    "campaign": [
        {"reynolds": [1000, 600], "forecasters": forecasters([40], ["RV", "SSV"], **NOISY)},
        {"reynolds": [400], "forecasters": forecasters([50, 30], ["RV", "SSV"], **NOISY)},
        {"reynolds": [800, 400], "forecasters": forecasters([40], ["SSV", "RV"], **NOISY)},
    ],
    "classification": {"prediction_times_lt": [3, 1, 2]},
    "control": {"prediction_times_lt": [2, 1]},
    "search": {"tikhonov": [1e-9, 1e-12, 1e-6]},
}


def test_the_order_of_the_config_means_nothing(miniature, tmp_path):
    project = miniature.project.copy(tmp_path / "project")
    assert project.dry_run(overlay=PERMUTED) == {}


# a case that sorts before another by one rule and after it by another, and parameters that are not
# in the order of the names; unequal numbers of series, so that another case's data do not fit
RENAMED = {
    "results": "results/renamed",
    "campaign": [
        {"cases": ["alpha"], "forecasters": forecasters([30], ["RV"], 1)},
        {"cases": ["Zeta"], "forecasters": forecasters([40], ["SSV", "RV"], 1)},
        {"reynolds": [400], "forecasters": forecasters([40], ["RV"], 1)},
    ],
    "cases": {
        "alpha": {
            **{"parameters": {"reynolds": 500}, "lyapunov": {"published_exponent": 0.0145}},
            **{"test_series": 9, "event_threshold": 0.08},
        },
        "Zeta": {
            **{"parameters": {"reynolds": 450}, "lyapunov": {"published_exponent": 0.015}},
            "event_threshold": 0.06,
        },
    },
    "figures": {"example_case": "Zeta"},
}


def test_names_that_sort_otherwise(miniature, tmp_path):
    project = miniature.project.without_results(tmp_path / "project")
    project.made(*(f"results/renamed/tables/{name}.csv" for name in TABLES), overlay=RENAMED)
    again = recomputation(project.directory / "results/renamed", RENAMED)
    again.records = {name: again.records[name] for name in ("alpha", "Zeta", "Re400")}
    for name, expected in again.tables().items():
        assert_table(again.results, name, expected)


@pytest.mark.long
def test_a_permuted_campaign_from_scratch_gives_the_same_tables(miniature, results, tmp_path):
    project = miniature.project.without_results(tmp_path / "project")
    project.made("tables", overlay=PERMUTED)
    again = project.directory / "results/miniature/tables"
    assert digests(again) == digests(results / "tables")


# -- the report ------------------------------------------------------------------------------------

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


@contextmanager
def opened(path):
    """Yield a page in a real browser, what it asks for, and what it says."""
    programs = [found for name in BROWSERS if (found := shutil.which(name))]
    if not programs:
        pytest.skip(f"no browser to open the report in: none of {', '.join(BROWSERS)}")
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(
            # the sandbox needs rights that a container does not have; the page is our own
            executable_path=programs[0],
            args=["--no-sandbox", "--disable-dev-shm-usage"],
        )
        try:
            page = browser.new_page(viewport={"width": 1400, "height": 900})
            asked: list[str] = []
            said: list[str] = []
            page.on("request", lambda request: asked.append(request.url))
            page.on("pageerror", lambda error: said.append(str(error)))
            page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
            page.goto(path.resolve().as_uri())
            yield page, asked, said
        finally:
            browser.close()


@pytest.fixture(scope="module")
def report(miniature, tmp_path_factory):
    """The report, where nothing else of the campaign is."""
    path = tmp_path_factory.mktemp("report") / "handed_on.html"
    made = miniature.project.snakemake(
        "--reporter", "burstcast", "--report-burstcast-path", str(path)
    )
    assert made.status == 0, made.text[-3000:]
    assert [one.name for one in path.parent.iterdir()] == [path.name]
    return path


@pytest.fixture(scope="module")
def browser(report):
    with opened(report) as opened_page:
        yield opened_page


@pytest.fixture
def browser_page(browser):
    return browser[0]


def test_the_report_opens_with_the_campaign(browser_page):
    text = browser_page.locator("#campaign").inner_text()
    assert "miniature" in browser_page.title()
    for word in ("Racca & Magri", "Re1000", "esn", "F-score", "Look at these first"):
        assert word in text
    # what is said to be looked at first is there
    links = browser_page.locator("#campaign a[href^='#']").all()
    assert len(links) > 4
    for link in links:
        assert browser_page.locator(link.get_attribute("href")).count() == 1


def test_the_figures_of_the_report_load(browser_page, results):
    sizes = browser_page.evaluate(
        """async () => {
            const pictures = [...document.images];
            await Promise.all(pictures.map((picture) => picture.decode()));
            return pictures.map((picture) => [picture.alt, picture.naturalWidth]);
        }"""
    )
    made = list((results / "figures").glob("*.png"))
    assert len(sizes) == len(made) > 30
    assert all(width > 500 for _, width in sizes)
    # each has its PDF, whole
    contents = browser_page.evaluate(
        "[...document.querySelectorAll('a[download$=\".pdf\"]')].map((link) => ["
        "link.download, atob(link.href.split(',')[1]).length,"
        "atob(link.href.split(',')[1]).slice(0, 5)])"
    )
    assert {name: (size, start) for name, size, start in contents} == {
        path.with_suffix(".pdf").name: (path.with_suffix(".pdf").stat().st_size, "%PDF-")
        for path in made
    }


def test_a_switch_shows_another_case(browser_page):
    scores = browser_page.locator("#figure-classification_scores")
    other = browser_page.locator("#figure-observable_and_density")
    for figure in (scores, other):
        assert figure.locator("img:visible").get_attribute("alt").endswith("Re400")
    assert scores.locator("button").all_inner_texts() == ["Re400", "Re600", "Re800", "Re1000"]
    scores.get_by_role("button", name="Re800").click()
    for figure in (scores, other):
        assert figure.locator("img:visible").count() == 1
        assert figure.locator("img:visible").get_attribute("alt").endswith("Re800")
        assert figure.locator("button.on").inner_text() == "Re800"


def test_the_tables_of_the_report_have_rows(browser_page, results):
    tables = results / "tables"
    browser_page.locator("nav a[href='#table-horizon']").click()
    assert browser_page.locator("#table-horizon tbody tr:visible").count() > 4
    browser_page.evaluate(
        "document.querySelectorAll('details.data').forEach((it) => it.open = true)"
    )
    browser_page.wait_for_function(
        "[...document.querySelectorAll('details.data')].every((it) => it.querySelector('.note'))"
    )
    found = browser_page.evaluate(
        """[...document.querySelectorAll('details.data')].map((it) => [
            it.id, it.querySelector('.note').textContent,
            it.querySelector('tbody').rows.length, it.querySelector('tbody').textContent,
        ])"""
    )
    assert [name for name, *_ in found] == [
        f"table-{name}"
        for section in SECTIONS
        for name in with_percentiles(DECLARED)
        if table_of(name).section == section and (tables / f"{name}.csv").exists()
    ]
    assert len(found) == len(list(tables.glob("*.csv")))
    for name, said, rows, text in found:
        expected = len(read_table(tables / f"{name.removeprefix('table-')}.csv"))
        assert expected or name == "table-warnings"
        assert rows == min(expected, 100), name
        assert said.startswith(f"{expected} of {expected} rows")
        assert "\\" not in text  # formulas are typeset
        assert "$" not in text


def test_rows_of_a_table_are_chosen_and_sorted(browser_page, results):
    browser_page.locator("nav a[href='#table-classification']").click()
    table = browser_page.locator("#table-classification")
    expected = read_table(results / "tables/classification.csv")
    chosen = expected[(expected["case"] == "Re600") & (expected["validation"] == "SSV")]
    table.get_by_role("button", name="Re600").click()
    table.get_by_role("button", name="SSV").click()
    assert table.locator(".note").inner_text() == f"{len(chosen)} of {len(expected)} rows"
    column = list(expected.columns).index("true_negative")
    table.locator("th").nth(column).click()
    table.locator("th").nth(column).click()
    shown = table.locator("tbody").first.locator(f"td:nth-child({column + 1})").all_inner_texts()
    assert [int(text) for text in shown] == sorted(chosen["true_negative"], reverse=True)
    assert int(shown[0]) > int(shown[-1])


def test_the_report_says_what_it_was_made_by(browser_page, results):
    claim = json.loads((results / ".run.json").read_bytes())
    provenance = browser_page.locator("#provenance")
    for summary in provenance.locator("summary").all():
        summary.click()
    text = provenance.inner_text()
    assert claim["revision"] in text
    assert f"random seed {claim['config']['random_seed']}" in text
    config = yaml.safe_load(provenance.locator("pre").inner_text())
    assert config == claim["config"]
    assert "scikit-optimize" in text
    assert re.search(r"^train\t\d+\t", text, re.MULTILINE)


def test_the_report_needs_nothing_but_itself_and_no_script_fails(browser, report):
    page, asked, said = browser
    assert page.locator("img").count() > 30  # all was loaded
    inside = (report.resolve().as_uri(), "data:", "blob:")
    assert [one for one in asked if not one.startswith(inside)] == []
    assert [one for one in said if not one.startswith(("log:", "info:", "warning:"))] == []

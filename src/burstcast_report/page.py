"""The report of a campaign: one page, in one file that needs nothing else.

It opens with the campaign and its main numbers; sections of figures and tables follow in the order
of `workflow/tables.yaml`, and provenance last. Figures are embedded as PNG and PDF, tables as CSV,
which the page's script shows with switches, sorted by any column. The text and style of the page
are `page.*` beside this module.
"""

import base64
import inspect
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pandas as pd
import yaml
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from burstcast.forecasters._names import KEYS
from burstcast.forecasters.registry import kind_class
from burstcast.natural_order import natural_order
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.summary import found_warnings, summary_table
from burstcast_workflow.commands.archive import versions
from burstcast_workflow.config.loading import load
from burstcast_workflow.figures.registry import FIGURES
from burstcast_workflow.harness.settings import leaves
from burstcast_workflow.project import project_root
from burstcast_workflow.tables.declarations import SECTIONS, TABLES
from burstcast_workflow.tables.registry import column_of, table_of, with_percentiles

SWITCHES = ("case", "validation")
"""Key columns of tables that buttons choose from, as far as there are few values."""

_FIRST = {
    "forecast_skill": "how well each forecaster predicts extreme events, and how far ahead",
    "classification_scores": "precision and recall of the networks, by prediction time and size",
    "horizon_by_size": "how early an event is predicted, by the size of the networks",
    "by_reynolds": "how both change with the Reynolds number",
    "long_term_density": "whether a network left to itself has the statistics of the flow",
    "control_tradeoff": "how much of the extreme events control removes, and at what cost",
}
_SPELT = {
    "kaplan yorke": "Kaplan-Yorke",
    "long term": "long-term",
    "lyapunov": "Lyapunov",
    "reynolds": "Reynolds number",
}
# What differs from config.yaml in every campaign, and is shown elsewhere on the page.
_SHOWN_ELSEWHERE = ("campaign", "results", "figures", "captions")


@dataclass(frozen=True)
class Flagged:
    """A file that a rule flags for the report."""

    path: Path
    labels: Mapping[str, str]  #: ``figure`` and ``case``, or ``table``
    caption: str  #: what it shows, in HTML


@dataclass(frozen=True)
class View:
    """A figure of one case: name and content of its picture, and of its PDF if there is one."""

    case: str
    name: str
    picture: str
    width: int
    pdf: str | None


@dataclass(frozen=True)
class Shown:
    """Content under one title: a figure, with its views by case, or a table."""

    name: str  #: name of the figure or table
    caption: Markup  #: what it shows, in HTML
    views: list[View] = field(default_factory=list)  #: views of a figure
    #: data of a table: its CSV and its columns, as the page's script reads them (JSON)
    data: Markup | None = None


@dataclass(frozen=True)
class ShownSection:
    """A section of the page."""

    title: str
    figures: list[Shown]
    tables: list[Shown]


def page(
    flagged: Iterable[Flagged],
    campaign: Campaign,
    results: Path,
    introduction: str,
    costs: pd.DataFrame,
    days: tuple[float, float] | None = None,
) -> str:
    """Text of the page.

    ``costs``: Costs of jobs (`burstcast_workflow.costs.records.rule_costs`). ``days``: Start of the
    first job and end of the last one, in seconds since the epoch; None: not known.
    """
    sections = list(_sections(flagged))
    there = {figure.name for section in sections for figure in section.figures}
    tables = results / "tables"
    config = campaign.config.dump()
    directory = Path(__file__).parent
    environment = Environment(
        loader=FileSystemLoader(directory),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["title_of"] = title_of
    return environment.get_template("page.html").render(
        name=results.name,
        introduction=Markup(introduction),
        computed=computed(campaign, tables),
        kinds=_kinds(campaign),
        numbers=_rows(summary_table(tables)),
        first={name: says for name, says in _FIRST.items() if name in there},
        warnings=found_warnings(tables),
        other_settings=other_settings(config),
        sections=sections,
        versions=versions(results),
        seed=config["random_seed"],
        config=yaml.safe_dump(config, sort_keys=False, allow_unicode=True),
        times=times_of_rules(costs),
        days=[f"{datetime.fromtimestamp(day, UTC):%Y-%m-%d %H:%M} UTC" for day in days or ()],
        style=Markup((directory / "page.css").read_text(encoding="utf-8")),
        script=Markup((directory / "page.js").read_text(encoding="utf-8")),
    )


def title_of(name: str) -> str:
    """Title of a figure or table, from its name: "Long-term density"."""
    words = name.replace("_", " ")
    for plain, spelt in _SPELT.items():
        words = words.replace(plain, spelt)
    return words[:1].upper() + words[1:]


# -- what the campaign is --------------------------------------------------------------------------


def computed(campaign: Campaign, tables: Path) -> list[dict[str, str]]:
    """Contents of a campaign, a row for each case: data, networks, other forecasters.

    ``tables``: Directory of the campaign's tables.
    """
    data = {row["case"]: row for row in pd.read_csv(tables / "dataset.csv").to_dict("records")}
    rows = []
    for case in campaign.case_names:
        networks = [one.name for one in campaign.networks if one.case == case]
        others = dict.fromkeys(
            one.name.kind for one in campaign.select(case=case) if one.name.kind != "esn"
        )
        sizes = sorted({one.neurons or 0 for one in networks})
        validations = sorted({str(one.validation) for one in networks})
        rows.append(
            {
                "case": case,
                "series": f"{data[case]['series_kept']:g}",
                "extreme events per series": f"{data[case]['events_per_series']:.3g}",
                "networks": f"{len(networks)}",
                "of neurons": ", ".join(map(str, sizes)),
                "validated by": ", ".join(validations),
                "seeds": f"{len({one.seed for one in networks})}",
                "beside them": ", ".join(others),
            }
        )
    return rows


def _kinds(campaign: Campaign) -> dict[str, str]:
    """Description of each kind of forecaster: the first sentence of its module."""
    kinds = dict.fromkeys(one.name.kind for one in campaign.forecasters)
    modules = {kind: inspect.getmodule(kind_class(kind)) for kind in kinds}
    found = {
        kind: (inspect.getdoc(module) or "").split("\n")[0] for kind, module in modules.items()
    }
    if any(run.controller.role == "random" for run in campaign.control_runs):
        found["random"] = "Control by alarms at random, as often as the network's."
    return found


def other_settings(config: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """Settings that differ from the paper's config.yaml: name, value here, value there.

    The blocks of the campaign, the results directory and settings of figures are left out.
    """
    path = project_root() / "config.yaml"
    paper = load(yaml.safe_load(path.read_text(encoding="utf-8")))
    here, there = (dict(leaves(one)) for one in (config, paper))

    def cell(settings: Mapping[str, Any], name: str) -> str:
        return json.dumps(settings[name]) if name in settings else ""

    return [
        (name, cell(here, name), cell(there, name))
        for name in dict.fromkeys([*here, *there])
        if name.partition(".")[0] not in _SHOWN_ELSEWHERE
        and (name not in here or name not in there or here[name] != there[name])
    ]


def _rows(table: pd.DataFrame | None) -> list[dict[str, str]]:
    """Rows of text, with numbers in three digits; missing ones are empty."""
    if table is None:
        return []
    return [
        {
            str(name): value
            if isinstance(value, str)
            else ("" if pd.isna(value) else f"{value:#.3g}")
            for name, value in row.items()
        }
        for row in table.to_dict("records")
    ]


def times_of_rules(costs: pd.DataFrame) -> list[dict[str, str]]:
    """Times of jobs by rule, the longest first: in all, and of the longest job.

    ``costs``: See `burstcast_workflow.costs.records.rule_costs`.
    """
    ran = costs[costs["records"] > 0].sort_values("minutes", ascending=False)
    return [
        {
            "rule": cost["rule"],
            "jobs": f"{cost['records']}",
            "time": _duration(60 * cost["minutes"]),
            "longest": _duration(cost["longest_seconds"]),
            "most memory": f"{cost['memory_mib']:.0f} MiB",
        }
        for cost in ran.to_dict("records")
    ]


def _duration(seconds: float) -> str:
    if seconds < 60:
        return f"{seconds:.1f} s"
    return f"{seconds / 60:.1f} min" if seconds < 3600 else f"{seconds / 3600:.1f} h"


# -- figures and tables ----------------------------------------------------------------------------


def _sections(flagged: Iterable[Flagged]) -> Iterator[ShownSection]:
    """Sections, their figures and their tables, each in declared order; empty ones are left out."""
    found: dict[tuple[str, str], list[Flagged]] = {}
    for one in flagged:
        kind = "figure" if "figure" in one.labels else "table"
        found.setdefault((kind, one.labels[kind]), []).append(one)
    for section, title in SECTIONS.items():
        figures = [
            _shown_figure(name, found["figure", name])
            for name, figure in FIGURES.items()
            if figure.section == section and ("figure", name) in found
        ]
        tables = [
            _shown_table(name, *found["table", name])
            for name in with_percentiles(TABLES)
            if table_of(name).section == section and ("table", name) in found
        ]
        if figures or tables:
            yield ShownSection(title, figures, tables)


def _shown_figure(name: str, files: Sequence[Flagged]) -> Shown:
    # the example's case has the plain name: it is shown first
    views = sorted(
        files, key=lambda one: (one.path.stem != name, natural_order(one.labels["case"]))
    )
    return Shown(name, Markup(views[0].caption), [_view(one) for one in views])


def _view(one: Flagged) -> View:
    picture, pdf = one.path.read_bytes(), one.path.with_suffix(".pdf")
    return View(
        one.labels["case"],
        one.path.stem,
        _data_uri(picture, "image/png"),
        int.from_bytes(picture[16:20]) // 2,  # its header tells the width; 300 dots an inch
        _data_uri(pdf.read_bytes(), "application/pdf") if pdf.exists() else None,
    )


def _data_uri(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _shown_table(name: str, one: Flagged) -> Shown:
    text = one.path.read_text(encoding="utf-8")
    header = pd.read_csv(one.path, nrows=0).columns
    columns = [
        {
            "name": column,
            "unit": column_of(column, name).unit,
            "meaning": column_of(column, name).meaning,
            "key": column in KEYS or column in ("metric", "prediction_time_lt"),
            "switch": column in SWITCHES,
        }
        for column in header
    ]
    data = json.dumps({"name": name, "csv": text, "columns": columns})
    # no text of a table can end the script element around it
    return Shown(name, Markup(one.caption), data=Markup(data.replace("<", "\\u003c")))

"""docs/results.md, made of the tables of campaigns that were run.

::

    make results                                # the page, from docs/results
    make results ARGS="collect RESULTS"         # a campaign's tables into docs/results
    make results ARGS="same paper RESULTS"      # whether another run's rows are in it

The page is docs/results/page.md.jinja rendered with tables and numbers; no number is typed. A
campaign without kept tables is left out.
"""

import argparse
import json
import os
import re
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import jinja2
import pandas as pd

from burstcast.files.tables import read_table
from burstcast.tables.published import compare
from burstcast_report import (
    authors_tables,
    aware_tables,
    control_tables,
    ranking_tables,
    readout_tables,
    results_tables,
)
from burstcast_report.claims import NOT_KEPT, findings
from burstcast_report.results_tables import (
    OF_SINGLE_NETWORKS,
    PUBLISHED,
    PUBLISHED_TABLES,
    Tables,
    markdown,
    significant,
)
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.opened import open_campaign
from burstcast_workflow.commands.archive import versions
from burstcast_workflow.costs.records import RULE_COSTS
from burstcast_workflow.project import project_root
from burstcast_workflow.tables.registry import table_names
from snaketrust.records import Records
from snaketrust.run import OvertakenError, Run

DOCS = project_root() / "docs"
KEPT = DOCS / "results"
TEMPLATE = "page.md.jinja"

# Probabilities of single networks fill large tables: only committees are kept, in campaigns about
# probabilities.
WITH_PROBABILITIES = ("beyond_the_paper", "learnt_precursor")


VERSIONS = "versions.json"
COLLECTED = {f"{name}.csv" for name in (*PUBLISHED_TABLES, "probability_scores")}
COLLECTED |= {RULE_COSTS, VERSIONS}


class RefusedError(ValueError):
    """A campaign's tables cannot be collected or compared."""


def collect(results: Path) -> None:
    """Copy a finished campaign's tables to docs/results, with what made them.

    The copy is made beside the tables that were kept before and replaces them when it is complete.

    ``results``: Results directory of the campaign; its last name is the campaign's.
    """
    results = Path(os.path.abspath(results))
    target = KEPT / results.name
    tables = _finished_tables(results)
    if not re.fullmatch(r"[a-z][a-z0-9_]*", results.name):
        raise RefusedError(
            f"{results.name!r} cannot be the name of a campaign in {KEPT}: name the results "
            f"directory by a letter, then letters, digits and _, all of them small"
        )
    others = {path.name for path in target.iterdir()} - COLLECTED if target.is_dir() else set()
    if others or target.is_symlink() or target.is_file():
        what = ", ".join(sorted(others)) or "no directory"
        raise RefusedError(f"{target} holds what was not collected ({what}): move it first")
    with TemporaryDirectory(dir=KEPT, prefix=f".{results.name}.") as building:
        new, former = Path(building) / "new", Path(building) / "former"
        new.mkdir()
        for path in tables:
            if path.stat().st_size:
                shutil.copyfile(path, new / path.name)
        costs = results / "benchmarks" / RULE_COSTS
        if costs.exists():
            shutil.copyfile(costs, new / costs.name)
        made_by = versions(results)
        del made_by["revision"]  # the collecting revision, not the computing one
        text = json.dumps(made_by, indent=2, sort_keys=True)
        (new / VERSIONS).write_text(f"{text}\n", encoding="utf-8")
        if target.exists():
            target.rename(former)
        try:
            new.rename(target)
        except OSError:
            if former.exists():
                former.rename(target)
            raise


def _finished_tables(results: Path) -> list[Path]:
    """Files of the tables to collect, each of which is as its job wrote it."""
    try:
        made = table_names(Campaign(open_campaign(results).config))
        Run("", str(results)).check_idle()
    except (ValueError, OvertakenError) as error:
        raise RefusedError(str(error)) from error
    more = ["probability_scores"] if results.name in WITH_PROBABILITIES else []
    records, found = Records(str(results)), []
    for name in (*PUBLISHED_TABLES, *more):
        if name not in made:
            continue
        path = results / "tables" / f"{name}.csv"
        problem = records.found(str(path))[1] if path.exists() else f"{path} is missing"
        if problem:
            raise RefusedError(f"{results} is not finished: {problem}; run the campaign first")
        found.append(path)
    return found


def differences(campaign: str, results: Path) -> list[str]:
    """Rows of another run's tables that a campaign's kept ones do not have.

    ``results``: Results directory of a campaign that is part of the kept one: the same cases, fewer
    networks. Tables with rows for each network are compared, as text, to the last digit, in the
    columns that are kept.
    """
    kept = KEPT / campaign
    if not any((results / "tables" / f"{name}.csv").exists() for name in OF_SINGLE_NETWORKS):
        raise RefusedError(f"{results} has no tables to compare: give a campaign's results")
    if not (kept / VERSIONS).exists():
        raise RefusedError(f"{kept} has no tables to compare with: collect them first")
    found = []
    for name in OF_SINGLE_NETWORKS:
        theirs = results / "tables" / f"{name}.csv"
        if not theirs.exists() or not theirs.stat().st_size:
            continue
        ours, others = (
            pd.read_csv(path, dtype=str, keep_default_na=False)
            for path in (kept / f"{name}.csv", theirs)
        )
        if missing := [str(column) for column in ours if column not in others]:
            found.append(f"{name}: without {', '.join(missing)}")
            continue
        rows, known = (
            [",".join(row) for row in table[list(ours)].to_numpy().tolist()]
            for table in (others, ours)
        )
        found += [f"{name}: {row}" for row in rows if row not in set(known)]
        print(f"{name}: {len(rows)} rows looked up", file=sys.stderr)
    return found


def claims_table(tables: Tables) -> str:
    """The paper's claims, its numbers, ours, and whether they agree."""
    return markdown(
        ["claim", "section", "paper", "ours", "agrees", "why not, or what to know", "agrees if"],
        findings(tables).astype(str).to_numpy().tolist(),
    )


def unjudged_table() -> str:
    """Claims of the paper that the kept tables cannot judge, and what that would take."""
    rows = [[one.text, one.section, one.missing] for one in NOT_KEPT]
    return markdown(["claim", "section", "what would judge it"], rows)


def comparison(tables: Tables) -> pd.DataFrame:
    """Values of a campaign beside published ones: `burstcast.tables.published.compare`."""
    names = ("classification", "horizon", "hyperparameters", "statistics", "control")

    def parts(ending: str) -> dict[str, pd.DataFrame]:
        found = {name: tables.rows(f"{name}_{ending}") for name in names}
        return {name: rows for name, rows in found.items() if len(rows)}

    return compare(read_table(PUBLISHED), parts("percentiles"), parts("intervals"))


def outside_table(compared: pd.DataFrame) -> str:
    """Every published value that lies outside our interval."""
    rows = []
    for row in compared[compared["inside"].eq(False).fillna(False)].to_dict("records"):
        network = (
            f"{row['neurons']:g} {row['validation']}"
            if row["forecaster"] == "esn"
            else row["forecaster"]
        )
        time = row["prediction_time_lt"]
        ends, quartiles = (
            " to ".join(filter(None, (significant(row[end]) for end in both)))
            for both in (("low", "high"), ("p25", "p75"))
        )
        rows.append(
            [
                f"{row['reynolds']:g}",
                network,
                str(row["metric"]).replace("_", " "),
                "" if pd.isna(time) else f"{time:g}",
                significant(row["published_p50"]),
                f"{significant(row['p50'])} ({quartiles})",
                ends,
            ]
        )
    head = ["Re", "network", "metric", "LT ahead", "paper", "ours (quartiles)"]
    return markdown([*head, "95 % of one network"], rows)


def agreement_table(compared: pd.DataFrame) -> str:
    """Number of published values inside our intervals, by kind."""
    known = compared[compared["inside"].notna()]
    rows = [
        [str(kind), str(len(part)), str(int(part["inside"].sum()))]
        for kind, part in known.groupby("kind", sort=False)
    ]
    rows.append(["all", str(len(known)), str(int(known["inside"].sum()))])
    return markdown(["", "published values", "inside our interval"], rows)


_HIGHER_IS_BETTER = ("precision", "recall", "f_score", "mean_horizon_lt")
_NO_SCORES = ("spectral_radius", "input_scaling", "tikhonov")


def sides_table(compared: pd.DataFrame) -> str:
    """Number of our values below and above published ones, by groups.

    Objectives, errors and the exceedance under control are better where they are smaller.
    """
    known = compared[compared["inside"].notna() & ~compared["metric"].isin(_NO_SCORES)]
    scores, time = known["kind"] == "classification", known["prediction_time_lt"]
    small, edge = known["neurons"] < 1000, time.isin([time.min(), time.max()])
    groups = {
        "scores of fewer than 1000 neurons": scores & small,
        f"scores of 1000 or more, {time.min():g} LT ahead": scores & ~small & (time == time.min()),
        "scores of 1000 or more, in between": scores & ~small & ~edge,
        f"scores of 1000 or more, {time.max():g} LT ahead": scores & ~small & (time == time.max()),
        "prediction horizons": known["kind"] == "horizon",
        "objectives": known["metric"] == "objective",
        "long-term statistics": known["kind"] == "statistics",
        "exceedance under control": known["kind"] == "control",
    }
    rows = []
    for name, chosen in groups.items():
        part = known[chosen]
        higher = part["p50"] > part["published_p50"]
        better = higher == part["metric"].isin(_HIGHER_IS_BETTER)
        outside = part["inside"].eq(False)
        counts = (len(part), better.sum(), (outside & better).sum(), (outside & ~better).sum())
        if len(part):
            rows.append([name, *map(str, counts)])
    head = ["", "published values", "ours better", "better, outside", "worse, outside"]
    return markdown(head, rows)


def page(kept: Path = KEPT) -> str:
    """The text of docs/results.md.

    ``kept``: Directory with the template, and a directory of tables for each campaign.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(kept),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template(TEMPLATE).render(
        vars(results_tables),
        authors_tables=authors_tables,
        aware_tables=aware_tables,
        control_tables=control_tables,
        ranking_tables=ranking_tables,
        readout_tables=readout_tables,
        claims_table=claims_table,
        unjudged_table=unjudged_table,
        sides_table=sides_table,
        outside_table=outside_table,
        agreement_table=agreement_table,
        comparison=comparison,
        tables=lambda name: Tables(kept / name),
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Make the page, collect tables, or compare another run's with them."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    commands = parser.add_subparsers(dest="command")
    collecting, comparing = (commands.add_parser(name) for name in ("collect", "same"))
    comparing.add_argument("campaign")
    for command in (collecting, comparing):
        command.add_argument("results", type=Path)
    chosen = parser.parse_args(arguments)
    try:
        if not KEPT.is_dir():
            raise RefusedError(f"{KEPT} is missing: kept tables are in the repository")
        if chosen.command == "collect":
            collect(chosen.results)
        elif chosen.command == "same":
            found = differences(chosen.campaign, chosen.results)
            print("\n".join(found) or "the same")
            return 1 if found else 0
        else:
            (DOCS / "results.md").write_text(page(), encoding="utf-8")
            if (KEPT / "readout").is_dir():
                image = DOCS / "images" / "readout.png"
                readout_tables.draw(Tables(KEPT / "readout"), image)
    except RefusedError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())

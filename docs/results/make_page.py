"""Pages with results, from tables that were kept: ``make results``.

They are docs/results.md, a page for each campaign, and pages of docs that quote results. Each is a
template in ``pages``, rendered with tables and numbers; no number is typed. Beside them are nine
figures and published_values.csv.
"""

import re
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from textwrap import TextWrapper
from typing import Any

import claims
import comparisons
import drawings
import experiments
import jinja2
import kept_tables
import pandas as pd
import yaml
from kept_tables import KEPT, Part, Tables, text

from burstcast.figures.parts.style import render

DOCS = KEPT.parent
TEMPLATES = KEPT / "pages"
IN_DOCS = ("results.md", "related_work.md", "real_records.md", "return_times.md")
"""Pages that lie in docs; all others lie in docs/results."""
_CODE = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)
BENCHMARKS = DOCS.parent / "benchmarks"
PUBLISHED_VALUES = KEPT / "published_values.csv"


class UnsupportedError(ValueError):
    """The tables do not support a sentence of the page."""


def supported(*holds: bool, caller: Callable[[], str]) -> str:
    """A sentence that compares, if all of its comparisons hold."""
    sentence = caller()
    if not all(holds):
        verdicts = ", ".join(str(bool(comparison)) for comparison in holds)
        raise UnsupportedError(f"the tables do not support ({verdicts}): {sentence}")
    return sentence


def wrapped(page: str) -> str:
    """A page whose paragraphs and points have lines of 100 columns at most; code stays as it is.

    None begins with a per cent sign, which Sphinx would take for a comment.
    """
    parts = [_wrapped(part) if part[:3] != "```" else part for part in _CODE.split(page)]
    return "\n\n".join(filter(None, parts)) + "\n"


def _wrapped(page: str) -> str:
    """Text between blocks of code, wrapped."""
    lines = TextWrapper(100, break_on_hyphens=False, break_long_words=False)
    points = TextWrapper(100, "", "  ", break_on_hyphens=False, break_long_words=False)
    blocks = []
    for block in re.split(r"\n{2,}", re.sub(r"\s%", "\0%", page.strip())):
        if block.startswith("* "):
            block = re.sub(r"\n +", "\n", block)
            block = "\n".join(map(points.fill, re.split(r"\n(?=\* )", block)))
        elif not block.startswith(("|", "#", "!", "<")):
            block = lines.fill(block)
        blocks.append(block)
    return "\n\n".join(blocks).replace("\0", " ")


def trio(tables: Tables, times: tuple[float, ...] = (1.0, 3.0, 5.0)) -> Part:
    """F-scores at some prediction times in a cell, a row for each case."""
    scores = tables.medians("classification", "f_score", prediction_time_lt=list(times))
    wide = scores.pivot_table("p50", ["case", "name"], "prediction_time_lt", sort=False)
    return [
        (
            str(case).replace("_", " "),
            str(name),
            " ".join(f"{value:.2f}".removeprefix("0") for value in values),
        )
        for (case, name), values in zip(wide.index, wide.to_numpy(), strict=True)
    ]


def in_units(rows: pd.DataFrame, factor: float) -> pd.DataFrame:
    """Rows with all rates, or their quartiles, multiplied by a factor."""
    names = [f"escape_rate{end}" for end in ("", "_low", "_high")]
    names = [name for name in (*names, "p25", "p50", "p75") if name in rows]
    return rows.assign(**{name: factor * rows[name] for name in names})


def range_text(row: Any) -> str:
    """Least and largest value of a row with two digits; one if they are equal."""
    least, largest = f"{row['min']:.2f}", f"{row['max']:.2f}"
    return least if least == largest else f"{least} to {largest}"


def readout_of(tables: Tables, score: comparisons.Score, forecaster: str) -> dict[float, float]:
    """Means over training sets of the networks of one readout, by size."""
    rows = comparisons.over_sets(tables, score)
    rows = rows[rows["forecaster"] == forecaster]
    return dict(zip(rows["neurons"], rows["mean"], strict=True))


def authors_share() -> float:
    """Share of time above the event threshold in the authors' training set, which a preset has."""
    preset = yaml.safe_load((DOCS.parent / "workflow/presets/authors.yaml").read_text("utf-8"))
    return float(preset["campaign"][1]["event_shares"][0])


@cache
def compared() -> pd.DataFrame:
    """Our values beside the published ones."""
    return comparisons.beside_published(Tables(KEPT / "paper"))


def pages() -> dict[Path, str]:
    """Texts of docs/results.md and of the pages of campaigns, by file."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["share"] = lambda value: text("{value:share}", {"value": value})
    environment.filters["signed"] = lambda value: f"{value:+.3f}"
    environment.globals |= {
        **vars(kept_tables),
        **vars(comparisons),
        **vars(experiments),
        "kept": cache(lambda *names: Tables(*(KEPT / name for name in names))),
        "measured": Tables(BENCHMARKS),
        "supported": supported,
        "trio": trio,
        "in_units": in_units,
        "readout_of": readout_of,
        "range_text": range_text,
        "compared": compared(),
        "authors_share": authors_share(),
        "verdicts_of": claims.verdicts_of,
        "claims_table": claims.claims_table,
        "verdicts_by_margin": claims.verdicts_by_margin,
        "margins_table": claims.margins_table,
        "sources_table": claims.sources_table,
        "not_kept": claims.NOT_KEPT,
        "concat": partial(pd.concat, ignore_index=True),
    }
    names = (TEMPLATES / "names.jinja").read_text(encoding="utf-8")
    texts = {}
    for template in sorted(TEMPLATES.glob("*.md.jinja")):
        name = template.name.removesuffix(".jinja")
        body = environment.from_string(names + template.read_text(encoding="utf-8"))
        texts[(DOCS if name in IN_DOCS else KEPT) / name] = wrapped(body.render())
    return texts


def published_values() -> str:
    """The text of published_values.csv."""
    return str(compared().to_csv(index=False, float_format="%.6g", lineterminator="\n"))


if __name__ == "__main__":
    for path, page in pages().items():
        path.write_text(page, encoding="utf-8")
    PUBLISHED_VALUES.write_text(published_values(), encoding="utf-8")
    for name, figure in (
        ("readout", drawings.draw_readouts(Tables(KEPT / "readout", KEPT / "readout_2000"))),
        ("smoothing", experiments.draw_smoothing(Tables(BENCHMARKS))),
        ("hidden_modes", experiments.draw_hidden_modes(Tables(BENCHMARKS))),
        ("late_actuator", drawings.draw_late_actuator(Tables(KEPT / "aware"))),
        ("learning_curves", drawings.draw_learning_curves(Tables(KEPT / "training_series_sweep"))),
        ("which_method", drawings.draw_which_method(Tables(KEPT / "which_method"))),
        ("spread_and_error", drawings.draw_spread_and_error(Tables(BENCHMARKS))),
        ("published_scores", drawings.draw_published_scores(Tables(KEPT / "paper"))),
        (
            "forecasters",
            drawings.draw_forecasters(
                *(Tables(KEPT / name) for name in ("paper", "readout", "beyond_the_paper"))
            ),
        ),
    ):
        (DOCS / "images" / f"{name}.png").write_bytes(render(figure, "png"))

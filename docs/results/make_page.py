"""docs/results.md, made of the tables of campaigns that were run: ``make results``.

The page is page.md.jinja rendered with tables and numbers; no number is typed. Beside it are the
figure of the readouts and published_values.csv.
"""

import re
from collections.abc import Callable
from functools import cache, partial
from textwrap import TextWrapper

import claims
import comparisons
import jinja2
import kept_tables
import pandas as pd
from kept_tables import KEPT, Part, Tables, text

PAGE = KEPT.parent / "results.md"
TEMPLATE = "page.md.jinja"
PUBLISHED_VALUES = KEPT / "published_values.csv"


class UnsupportedError(ValueError):
    """The tables do not support a sentence of the page."""


def said(*holds: bool, caller: Callable[[], str]) -> str:
    """A sentence that compares, if all of its comparisons hold."""
    sentence = caller()
    if not all(holds):
        told = ", ".join(str(bool(one)) for one in holds)
        raise UnsupportedError(f"the tables do not support ({told}): {sentence}")
    return sentence


def wrapped(page: str) -> str:
    """A page whose paragraphs and points have lines of 100 columns at most."""
    lines = TextWrapper(100, break_on_hyphens=False, break_long_words=False)
    points = TextWrapper(100, "", "  ", break_on_hyphens=False, break_long_words=False)
    blocks = []
    for block in re.split(r"\n{2,}", page.strip()):
        if block.startswith("* "):
            block = "\n".join(map(points.fill, re.split(r"\n(?=\* )", block)))
        elif not block.startswith(("|", "#", "!", "<")):
            block = lines.fill(block)
        blocks.append(block)
    return "\n\n".join(blocks) + "\n"


def trio(tables: Tables, times: tuple[float, ...] = (1.0, 3.0, 5.0)) -> Part:
    """F-scores at some prediction times in a cell, a row for each case."""
    found = tables.medians("classification", "f_score", prediction_time_lt=list(times))
    wide = found.pivot_table("p50", ["case", "name"], "prediction_time_lt", sort=False)
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


def trusted(tables: Tables, case: str, time: float, forecaster: str) -> pd.Series:
    """F-score of a forecaster so many Lyapunov times ahead, with its interval."""
    where = {"case": case, "prediction_time_lt": time, "forecaster": forecaster}
    row: pd.Series = tables.one("classification", "f_score", **where)
    return row


def readout_of(tables: Tables, score: comparisons.Score, forecaster: str) -> dict[float, float]:
    """Means over training sets of the networks of one readout, by size."""
    rows = comparisons.over_sets(tables, score)
    rows = rows[rows["forecaster"] == forecaster]
    return dict(zip(rows["neurons"], rows["mean"], strict=True))


@cache
def compared() -> pd.DataFrame:
    """Our values beside the published ones."""
    return comparisons.beside_published(Tables(KEPT / "paper"))


def page() -> str:
    """The text of docs/results.md."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(KEPT),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["share"] = lambda value: text("{value:share}", {"value": value})
    environment.filters["signed"] = lambda value: f"{value:+.3f}"
    text_of_page = environment.get_template(TEMPLATE).render(
        {**vars(kept_tables), **vars(comparisons)},
        kept=cache(lambda name: Tables(KEPT / name)),
        said=said,
        trio=trio,
        in_units=in_units,
        readout_of=readout_of,
        trusted=trusted,
        compared=compared(),
        claims_table=claims.claims_table,
        margins_table=claims.margins_table,
        not_kept=claims.NOT_KEPT,
        concat=partial(pd.concat, ignore_index=True),
    )
    return wrapped(text_of_page)


def published_values() -> str:
    """The text of published_values.csv."""
    return str(compared().to_csv(index=False, float_format="%.6g", lineterminator="\n"))


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    PUBLISHED_VALUES.write_text(published_values(), encoding="utf-8")
    comparisons.draw_readouts(Tables(KEPT / "readout"), KEPT.parent / "images" / "readout.png")

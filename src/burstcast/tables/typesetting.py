r"""Tables for papers: "0.818 (0.815 to 0.824)" in each cell, and as wide as a page.

`burstcast.tables.latex` holds the numbers; here is how they stand on paper.
"""

import re
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pandas as pd

from burstcast.tables.latex import escape, latex_number

PAGE_WIDTH = 345.0
"""In points: the text of LaTeX's class article at 10 pt, the narrowest of the usual pages."""

COLUMN_GAP = 8.0
r"""Between two columns, in points: twice ``\tabcolsep`` as `to_latex` sets it."""

# Widths of Computer Modern at 8 pt (\footnotesize), in points, from above.
_WIDTHS = {
    **dict.fromkeys(" .,:;'|!()[]fijlrt-", 3.35),
    **dict.fromkeys("0123456789acegosz", 4.3),
    **dict.fromkeys("bdhknpquvxy_/", 4.75),
}
_WIDEST = 8.8


def text_width(latex: str) -> float:
    r"""Width of a line of text in points at ``\footnotesize``, from above.

    A command counts as one of the widest letters, unless it only changes how its argument looks;
    exponents and indices count in full.
    """
    plain = re.sub(r"\\(mathrm|text|mathcal|overline|langle|rangle|,|left|right)\b", "", latex)
    plain = re.sub(r"\\[a-zA-Z]+", "M", plain)
    plain = re.sub(r"\\(.)", r"\1", re.sub(r"[{}$^]", "", plain))
    return sum(_WIDTHS.get(letter, _WIDEST) for letter in plain)


def with_interval(value: float, low: float, high: float, write: Callable[[float], str]) -> str:
    """A value with its interval: "0.818 (0.815 to 0.824)".

    A value without an interval, or with one of no width, stands alone; no value is a dash.
    """
    if not np.isfinite(value):
        return "--"
    if not (np.isfinite(low) and np.isfinite(high)) or low == high:
        return write(value)
    return f"{write(value)} ({write(low)} to {write(high)})"


def number_writer(spec: str | None) -> Callable[[float], str]:
    """Function that writes numbers in LaTeX by a format; three significant digits if None."""
    if spec is None:
        return lambda value: latex_number(value, digits=3)
    return lambda value: f"${value:{spec}}$"


def wide_table(
    table: pd.DataFrame,
    rows: Sequence[str],
    columns: str,
    *,
    interval: tuple[str, str, str] = ("value", "low", "high"),
    specs: Mapping[str, str] | None = None,
) -> pd.DataFrame:
    """One row for each of several keys, one column for each value of another one.

    ``rows``: Columns that tell rows apart, in their order of appearance. ``columns``: Column whose
    values become columns, in their order of appearance. ``interval``: Columns of the value and the
    ends of its interval. ``specs``: Format specifications by the name in the column ``metric``,
    where there is one. Returns columns ``rows``, then the values of ``columns``; cells are LaTeX, a
    dash where nothing is.
    """
    specs = specs or {}
    if table.duplicated([*rows, columns]).any():
        raise ValueError(f"two rows have the same {', '.join([*rows, columns])}")
    found: dict[tuple[object, ...], dict[str, object]] = {}
    names = list(dict.fromkeys(table[columns]))
    for record in table.to_dict("records"):
        write = number_writer(specs.get(str(record.get("metric"))))
        value, low, high = (float(record[name]) for name in interval)
        key = tuple(record[name] for name in rows)
        row = found.setdefault(key, dict(zip(rows, key, strict=True)))
        row[record[columns]] = with_interval(value, low, high, write)
    result = pd.DataFrame(list(found.values()), columns=[*rows, *names])
    return result.fillna(dict.fromkeys(names, "--"))


def panels(
    cells: pd.DataFrame, heads: Mapping[str, str], keys: int, width: float = PAGE_WIDTH
) -> list[list[str]]:
    """Columns of a table, taken apart so that each part is as wide as the page at most.

    ``heads``: Heads of its columns; columns without one have their names. ``keys``: How many
    columns, the first ones, every part begins with. Returns names of the columns of each part; a
    column that does not fit beside the keys is alone.
    """
    widths = {
        name: max(
            text_width(str(text)) for text in [heads.get(name, str(name)), *map(str, cells[name])]
        )
        + COLUMN_GAP
        for name in cells.columns
    }
    first, others = list(cells.columns[:keys]), list(cells.columns[keys:])
    parts, room = [first.copy()], width - sum(widths[name] for name in first)
    left = room
    for name in others:
        if widths[name] > left and len(parts[-1]) > len(first):
            parts.append(first.copy())
            left = room
        parts[-1].append(name)
        left -= widths[name]
    return parts


def to_latex(
    cells: pd.DataFrame,
    caption: str,
    label: str,
    *,
    heads: Mapping[str, str] | None = None,
    keys: int = 1,
    width: float = PAGE_WIDTH,
) -> str:
    r"""Write a table as a LaTeX ``table`` environment with booktabs rules, as wide as a page.

    ``heads``: LaTeX heads of columns; a column without one shows its escaped name. ``keys``: How
    many columns, the first ones, tell rows apart. The others stand below one another where they do
    not fit side by side.
    """
    shown = {name: (heads or {}).get(name, escape(str(name))) for name in cells.columns}
    lines = [
        r"\begin{table}",
        r"  \centering",
        rf"  \caption{{{caption}}}",
        rf"  \label{{{label}}}",
        r"  \footnotesize",
        rf"  \setlength{{\tabcolsep}}{{{COLUMN_GAP / 2:g}pt}}",
    ]
    for number, names in enumerate(panels(cells, shown, keys, width)):
        lines += ["", r"  \medskip"] if number else []
        lines += [
            rf"  \begin{{tabular}}{{@{{}}{'l' * keys}{'r' * (len(names) - keys)}@{{}}}}",
            r"    \toprule",
            _line([shown[name] for name in names]),
            r"    \midrule",
            *(_line(row) for row in cells[names].astype(str).itertuples(index=False, name=None)),
            r"    \bottomrule",
            r"  \end{tabular}",
        ]
    return "\n".join([*lines, r"\end{table}", ""])


def _line(cells: Sequence[str]) -> str:
    return "    " + " & ".join(cells) + r" \\"

r"""LaTeX: numbers, text, and booktabs tables that are shrunk where the page is narrower."""

import math
from collections.abc import Mapping, Sequence

import pandas as pd

_ESCAPES = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        **{letter: rf"\{letter}" for letter in "&%$#_{}"},
    }
)
_COLUMNS = 4
"""Columns of values side by side."""
_SHRINK = r"\resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}"


def escape(text: str) -> str:
    """Text with the characters that are special to LaTeX made literal."""
    return text.translate(_ESCAPES)


def latex_number(value: float, digits: int = 4) -> str:
    r"""Write a number as LaTeX in math mode: ``$400$``, ``$4\pi$``, ``$1.6\times10^{-3}$``.

    Whole multiples of pi up to 20 are written as such (lengths of periodic domains), powers of
    ten without a mantissa, other numbers with ``digits`` significant digits; whole numbers in full.
    """
    if not math.isfinite(value):
        raise ValueError(f"a table cannot show {value}")
    if value == int(value) and abs(value) < 1e6:
        return f"${int(value)}$"
    multiple = round(value / math.pi)
    if 1 <= abs(multiple) <= 20 and math.isclose(value, multiple * math.pi, rel_tol=1e-9):
        return rf"${multiple if multiple != 1 else ''}\pi$"
    plain = f"{value:.{digits}g}"
    if "e" not in plain:
        return f"${plain}$"
    mantissa, exponent = plain.split("e")
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if mantissa == "1" else rf"${mantissa}\times{power}$"


def to_latex(
    cells: pd.DataFrame,
    caption: str,
    label: str,
    *,
    heads: Mapping[str, str] | None = None,
    keys: int = 1,
) -> str:
    """Write a table as a LaTeX ``table`` environment (packages ``booktabs`` and ``graphicx``).

    ``heads``: LaTeX heads of columns; a column without one shows its escaped name. ``keys``: How
    many columns, the first ones, tell rows apart; four of the others stand side by side.
    """
    heads = {name: escape(str(name)) for name in cells.columns} | dict(heads or {})
    first, others = list(cells.columns[:keys]), list(cells.columns[keys:])
    lines = [r"\begin{table}", r"  \centering", rf"  \caption{{{caption}}}"]
    lines += [rf"  \label{{{label}}}", r"  \footnotesize"]
    for start in range(0, max(len(others), 1), _COLUMNS):
        names = [*first, *others[start : start + _COLUMNS]]
        alignment = "l" * keys + "r" * (len(names) - keys)
        lines += ["", r"  \medskip"] if start else []
        lines += [
            rf"  {_SHRINK}{{\begin{{tabular}}{{@{{}}{alignment}@{{}}}}",
            r"    \toprule",
            _line([heads[name] for name in names]),
            r"    \midrule",
            *(_line(row) for row in cells[names].astype(str).itertuples(index=False, name=None)),
            r"    \bottomrule",
            r"  \end{tabular}}",
        ]
    return "\n".join([*lines, r"\end{table}", ""])


def _line(cells: Sequence[str]) -> str:
    return "    " + " & ".join(cells) + r" \\"

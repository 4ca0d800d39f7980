"""The style of all figures: sizes, fonts, colours, panel letters, legends, reproducible files.

Figures are built from :class:`matplotlib.figure.Figure` without pyplot: no global state, and a
quick start. Colours are of the Okabe-Ito palette, safe for colour-blind readers; what a colour
tells, a line style or a marker tells too, for print in greyscale. The fonts ship with Matplotlib,
so that a figure looks the same on every machine.
"""

import functools
import io
import logging
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import Any, Literal, ParamSpec

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.mathtext import MathTextParser
from matplotlib.patches import Patch

P = ParamSpec("P")

SINGLE_COLUMN = 3.4
"""Width of a journal's column, inches."""
DOUBLE_COLUMN = 7.0
"""Width of a journal's page, inches."""

BLACK = "#000000"
BLUE = "#0072B2"
ORANGE = "#E69F00"
GREEN = "#009E73"
VERMILLION = "#D55E00"
PURPLE = "#CC79A7"
GREY = "#6E6E6E"
LIGHT_GREY = "#DADADA"

BARS: Any = {"capsize": 2.0, "elinewidth": 0.8, "capthick": 0.8}
"""Keywords of error bars."""

_LABEL_LINE = 9.0
"""Height of a line of text of a label at the end of a curve, points."""

# A user's own matplotlibrc must not change a figure: every setting starts from Matplotlib's
# defaults, except settings of interactive windows, which a figure does not have.
_INTERACTIVE = ("backend", "interactive", "toolbar", "timezone", "tk.", "webagg.", "macosx.")
_STYLE: Any = {
    name: value
    for name, value in matplotlib.rcParamsDefault.items()
    if not name.startswith(_INTERACTIVE)
} | {
    "font.family": "serif",
    "font.serif": ["STIXGeneral"],
    "mathtext.fontset": "stix",
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.0,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "axes.linewidth": 0.6,
    "axes.labelpad": 2.5,
    "axes.titlepad": 4.0,
    "lines.linewidth": 1.1,
    "lines.markersize": 3.2,
    "patch.linewidth": 0.6,
    "hatch.linewidth": 0.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.45,
    "ytick.minor.width": 0.45,
    "xtick.major.size": 2.8,
    "ytick.major.size": 2.8,
    "xtick.minor.size": 1.6,
    "ytick.minor.size": 1.6,
    # Labels at the corner of a panel stay clear of each other.
    "xtick.major.pad": 5.0,
    "ytick.major.pad": 4.0,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "legend.handletextpad": 0.5,
    "legend.labelspacing": 0.3,
    "legend.borderaxespad": 0.3,
    "legend.columnspacing": 1.2,
    "figure.constrained_layout.w_pad": 0.03,
    "figure.constrained_layout.h_pad": 0.03,
    "figure.dpi": 100.0,
    "savefig.dpi": 300.0,
    "pdf.fonttype": 42,
    "pdf.compression": 6,
    "svg.hashsalt": "burstcast",
}


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Decorate a function that returns a figure: it draws in the shared style.

    An argument ``symbol`` is one that formulas can have.
    """

    @functools.wraps(draw)
    def wrapper(*arguments: P.args, **keywords: P.kwargs) -> Figure:
        with matplotlib.rc_context(_STYLE):
            if isinstance(symbol := keywords.get("symbol"), str):
                keywords["symbol"] = drawable_symbol(symbol)
            return draw(*arguments, **keywords)

    return wrapper


def drawable_symbol(symbol: str) -> str:
    """A symbol in TeX that can have a subscript, or "observable" for what is no formula.

    Examples
    --------
    >>> drawable_symbol("k"), drawable_symbol("k_1")
    ('k', '{k_1}')
    """
    for written in (symbol, f"{{{symbol}}}"):
        with suppress(ValueError):
            MathTextParser("path").parse(f"${written}_e$")
            return written
    warnings.warn(
        f"the symbol {symbol!r} is no formula that Matplotlib draws: figures say observable",
        stacklevel=3,
    )
    return r"\mathrm{observable}"


def new_figure(
    width: float, height: float, *, layout: Literal["constrained"] | None = "constrained"
) -> Figure:
    """Empty figure of the given size in inches, with a canvas that needs no display."""
    figure = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def grid_of(figure: Figure, count: int, columns: int, **shared: Any) -> list[Axes]:
    """Panels row by row, in rows of so many; the last row may have fewer."""
    panels = list(figure.subplots(-(-count // columns), columns, squeeze=False, **shared).flat)
    for unused in panels[count:]:
        unused.remove()
    return panels[:count]


def render(figure: Figure, file_format: Literal["pdf", "png", "svg"]) -> bytes:
    """Content of the figure's file: equal figures give equal bytes on any day.

    Matplotlib would write the time of creation and its version into the file; both are left out.
    """
    without: dict[str, Mapping[str, str | None]] = {
        "pdf": {"CreationDate": None, "ModDate": None, "Producer": None, "Creator": None},
        "png": {"Software": None},
        "svg": {"Date": None, "Creator": None},
    }
    if file_format not in without:
        raise ValueError(f"no figure is written as {file_format}; known: {', '.join(without)}")
    buffer = io.BytesIO()
    with matplotlib.rc_context(_STYLE), _missing_glyphs() as missing:
        figure.savefig(buffer, format=file_format, metadata=dict(without[file_format]))
    if missing:
        signs = sorted(missing)
        warnings.warn(
            f"the font of figures has no {', '.join(signs)}, and draws boxes: name columns by "
            f"other characters, as in components: [temperature = {signs[0]}]",
            stacklevel=2,
        )
    return buffer.getvalue()


_GLYPH = re.compile(r"does not have a glyph for .*\[U\+([0-9a-f]+)\]")
"""What Matplotlib logs of a character that the font of a formula lacks."""


@contextmanager
def _missing_glyphs() -> Iterator[set[str]]:
    """Collect characters that the font lacks, of which Matplotlib logs one line each."""
    missing, logger = set[str](), logging.getLogger("matplotlib.mathtext")

    def collect(record: logging.LogRecord) -> bool:
        found = _GLYPH.search(record.getMessage())
        missing.update(chr(int(found[1], 16)) for found in (found,) if found)
        return found is None

    logger.addFilter(collect)
    try:
        yield missing
    finally:
        logger.removeFilter(collect)


@styled
def nothing_to_show(reason: str) -> Figure:
    """Draw a placeholder that states why a figure has no content."""
    figure = new_figure(SINGLE_COLUMN, 0.8, layout=None)
    figure.text(0.5, 0.5, reason, ha="center", va="center", color=GREY)
    return figure


def letter_panels(axes: Sequence[Axes], *, inside: bool = False) -> None:
    """Write (a), (b), ... at the upper left of the panels: above the frame, or inside it."""
    for index, panel in enumerate(axes):
        letter = f"({chr(ord('a') + index)})"
        if inside:
            panel.annotate(
                letter, (0, 1), (4, -4), "axes fraction", "offset points", ha="left", va="top"
            )
        else:
            panel.set_title(letter, loc="left")


def band_handle(label: str, color: str = GREY) -> Patch:
    """Entry of a legend that says what bands are."""
    return Patch(facecolor=color, alpha=0.3, linewidth=0, label=label)


def bar_handle(label: str, *, caps: bool = True) -> Line2D:
    """Entry of a legend that says what bars are, with caps or without."""
    marker = r"$\mathrm{I}$" if caps else "|"
    return Line2D(
        [],
        [],
        linestyle="none",
        color=GREY,
        marker=marker,
        markersize=7.0,
        markeredgewidth=0.6,
        label=label,
    )


def label_ends(figure: Figure, panels: Iterable[Axes]) -> None:
    """Write the labels of curves to the right of their panels, at the heights of the curves' ends.

    For panels with their final limits. Labels that would lie on each other are moved apart.
    """
    figure.draw_without_rendering()  # places the panels
    for panel in panels:
        curves = []
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            line: Any = handle[0] if isinstance(handle, ErrorbarContainer) else handle
            defined = line.get_xydata()[np.isfinite(line.get_xydata()).all(axis=1)]
            if len(defined):
                height = panel.transData.transform(defined[-1])[1] - panel.bbox.y0
                curves.append((np.clip(height, 0.0, panel.bbox.height), label, line.get_color()))
        curves.sort(key=lambda curve: curve[0])
        lines_of_text = np.array([1 + label.count("\n") for _, label, _ in curves])
        # distances of the middles of the labels from the lowest one, pixels
        room = _LABEL_LINE * figure.dpi / 72 * (np.cumsum(lines_of_text) - 0.5 * lines_of_text)
        free = np.array([height for height, *_ in curves]) - room
        upwards = np.maximum.accumulate(free)
        downwards = np.minimum.accumulate(free[::-1])[::-1]
        heights = (np.maximum(0.5 * (upwards + downwards), -room[:1]) + room) / panel.bbox.height
        for height, (_, label, colour) in zip(heights, curves, strict=True):
            place: Any = {"xycoords": "axes fraction", "textcoords": "offset points"}
            place |= {"xytext": (4, 0), "va": "center", "linespacing": 1.0}
            panel.annotate(label, (1, height), color=colour, fontsize=7.5, **place)


def legend_above(
    figure: Figure, axes: Iterable[Axes], more: Sequence[Artist] = (), columns: int | None = None
) -> None:
    """Draw a legend above the panels: what they label, each label once, then ``more``.

    In one row unless it has at most some columns.
    """
    entries: dict[str, Artist] = {}
    for panel in axes:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    for handle in more:
        entries.setdefault(str(handle.get_label()), handle)
    figure.legend(
        list(entries.values()),
        list(entries),
        loc="outside upper center",
        ncols=max(1, min(len(entries), columns or len(entries))),
    )

"""Settings of Sphinx; ``docs/site/build.py`` assembles the pages and calls it."""

from importlib import metadata
from typing import Any

project = "burstcast"
release = metadata.version("burstcast")
author = "The burstcast developers"
copyright = author  # noqa: A001
html_title = f"burstcast {release}"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
exclude_patterns = ["_build"]
default_role = "py:obj"  # `burstcast.networks.dynamics` in a docstring is a link
suppress_warnings = ["ref.python"]  # one word in backticks may fit several methods

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["extra.css"]
html_show_sourcelink = False
html_copy_source = False
pygments_style = "friendly"
pygments_dark_style = "native"

myst_heading_anchors = 4
myst_enable_extensions = ["attrs_inline"]

autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "show-inheritance": True}
autodoc_preserve_defaults = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True
python_display_short_literal_types = True
python_maximum_signature_line_length = 88

# Types of arrays are shown by their names in burstcast.base.arrays.
_ARRAYS = {
    "numpy.float64": "FloatArray",
    "numpy.int64": "IntArray",
    "numpy.int32": "Int32Array",
    "numpy.bool": "BoolArray",
    "numpy.complex128": "ComplexArray",
    "Any": "AnyArray",
}


def _short(text: str | None) -> str | None:
    for scalar, name in _ARRAYS.items():
        for rest in ("", "~"):
            long = (
                f"{rest}numpy.ndarray[tuple[{rest.replace('~', '~typing.')}Any, ...], "
                f"{rest}numpy.dtype[{rest}{scalar}]]"
            )
            text = text.replace(long, name) if text else text
    return text


def _signature(app: Any, what: str, name: str, thing: Any, options: Any, *texts: Any) -> Any:
    arguments, returned = texts
    return _short(arguments), _short(returned)


def _docstring(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """A bar is the modulus of a number, not a substitution of reStructuredText."""
    lines[:] = [line.replace("|", "\\|") for line in lines]


def setup(app: Any) -> None:
    """Connect the events of signatures and docstrings."""
    app.connect("autodoc-process-signature", _signature)
    app.connect("autodoc-process-docstring", _docstring)

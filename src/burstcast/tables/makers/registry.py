"""Tables of a case by name: the module ``burstcast.tables.makers.<name>`` makes one, or several.

The function ``make`` gives their rows by the name of the table, of what its arguments declare
(`burstcast.base.declared`). Key columns of the case need not be among them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from burstcast.base.discovery import imported
from burstcast.base.names import ForecasterName

Rows = list[dict[str, Any]]
"""Rows of a table: values by column."""


@dataclass(frozen=True)
class Gathered:
    """A file of each forecaster, or of each run of control, of a case."""

    name: ForecasterName  #: forecaster, or controller, of the file
    content: Mapping[str, Any]  #: content of the file (`burstcast.base.declared.gathered`)
    #: settings of a run of control; empty for other files
    plan: Mapping[str, Any] = field(default_factory=dict)


def maker(name: str) -> Callable[..., dict[str, Rows]]:
    """Function that makes the tables of a module."""
    make: Callable[..., dict[str, Rows]] = imported(f"burstcast.tables.makers.{name}").make
    return make

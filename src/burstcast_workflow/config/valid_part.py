"""The sound part of a configuration in which pydantic finds mistakes.

Relations between settings are checked in it, so that they are reported together with the mistakes.
"""

import copy
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from pydantic import ValidationError
from snakemake.utils import update_config

from burstcast_workflow.config.case import WHOLE
from burstcast_workflow.config.model import Configuration

_ROUNDS = 10
"""Most rounds of repairs, each of the mistakes that pydantic finds after the one before."""

Path = tuple[str | int, ...]


def valid_part(
    config: Mapping[str, Any], shipped: Mapping[str, Any]
) -> tuple[Configuration | None, list[str]]:
    """A configuration without its mistakes, and the names of what has been set aside.

    An invalid setting gets its value in config.yaml, or else its default, or else what it belongs
    to is left out. None if nothing sound is left. What is said of a name that has been set aside
    need not hold for the configuration itself.
    """
    config, names, tried = copy.deepcopy(dict(config)), dict[str, None](), set[Path]()
    for _ in range(_ROUNDS):
        repaired = copy.deepcopy(dict(shipped))
        update_config(repaired, config)
        try:
            return Configuration.model_validate(repaired), list(names)
        except ValidationError as error:
            mistakes = error.errors(include_url=False)
        for mistake in mistakes:
            path = mistake["loc"]
            while path and (path in tried or path[-1] == "[key]" or isinstance(path[-1], int)):
                path = path[:-1]
            if path == ("campaign",):  # what would be checked is no campaign of theirs
                return None, [*names, "campaign"]
            tried.add(path)
            _leave_out(config, path)
            # nothing follows from a setting that is unknown, but in what says what a case is
            if mistake["type"] != "extra_forbidden" or path != mistake["loc"] or _is_whole(path):
                names[_name_of(path)] = None
    return None, []


def _leave_out(config: Any, path: Path) -> None:
    """Delete the setting at a path, if there is one."""
    with suppress(LookupError, TypeError):
        for part in path[:-1]:
            config = config[part]
        del config[path[-1]]


def _name_of(path: Path) -> str:
    """Name of a setting in messages of relations: in a case, from the root of the case."""
    if path[:1] == ("campaign",):
        return "campaign"  # whatever is said of its members
    if path[:2] == ("control", "strategies") and path[2:]:
        return f"control.strategies[{path[2]}]"  # whatever is said of the block
    if _is_whole(path):
        return str(path[1])  # whatever is said of the case
    parts = path[1:] if path[:1] == ("case_defaults",) else path[2:] or path[1:]
    names = parts if path[:1] in (("case_defaults",), ("cases",)) else path
    return ".".join(str(part) for part in names if not isinstance(part, int))


def _is_whole(path: Path) -> bool:
    """Whether a setting is in a section that says what a case is."""
    return path[:1] == ("cases",) and path[2:3] != () and path[2] in WHOLE

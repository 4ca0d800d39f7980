"""The configuration: checked, completed and in canonical form.

Everything that can be wrong is told at once, before any job, in messages that name the setting. The
schema (``workflow/schemas/config.schema.yaml``) says what each setting may be;
`burstcast_workflow.config_checks` what must hold between them.
"""

import math
import posixpath
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from burstcast_workflow.canonical import canonical
from burstcast_workflow.cases import Config, case_records
from burstcast_workflow.config_checks import problems_between_settings
from burstcast_workflow.config_messages import dotted, schema_problems

__all__ = ["SCHEMA", "ConfigError", "case_records", "load"]

SCHEMA = Path(__file__).resolve().parents[2] / "workflow" / "schemas" / "config.schema.yaml"

# libyaml's loader where there is one: ten times as fast
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class ConfigError(ValueError):
    """A configuration with mistakes.

    Attributes
    ----------
    problems
        One message for each.
    """

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        if len(problems) == 1:
            text = f"The configuration has a mistake: {problems[0]}"
        else:
            listed = "\n".join(f"  {number}. {text}" for number, text in enumerate(problems, 1))
            text = f"The configuration has {len(problems)} mistakes:\n{listed}"
        super().__init__(text)


def load(config: Mapping[str, Any], schema: Path = SCHEMA) -> Config:
    """Check a configuration as Snakemake merged it, and put it in canonical form.

    Parameters
    ----------
    config
        The content of config.yaml with everything laid over it.
    schema
        The schema's file.

    Raises
    ------
    ConfigError
        If anything is wrong with it.
    """
    problems = list(_not_json(config, ()))
    if not problems:
        with schema.open(encoding="utf-8") as file:
            problems = schema_problems(config, yaml.load(file, _LOADER))
    if not problems:
        problems = problems_between_settings(config)
    if problems:
        raise ConfigError(problems)
    loaded: Config = canonical(dict(config), "config")
    loaded["results"] = posixpath.normpath(loaded["results"])
    return loaded


def _not_json(value: Any, path: tuple[str | int, ...]) -> Iterator[str]:
    """Find what YAML can say and JSON cannot: keys not of text, numbers that are not finite."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            if isinstance(key, str):
                yield from _not_json(item, (*path, key))
            else:
                yield f"{dotted((*path, str(key)))}: the key {key!r} must be text"
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _not_json(item, (*path, index))
    elif isinstance(value, float) and not math.isfinite(value):
        yield f"{dotted(path)} is {value}; it must be a finite number"

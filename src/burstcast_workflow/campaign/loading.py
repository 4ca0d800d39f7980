"""Loading a configuration: checked, and in canonical form.

All mistakes are reported at once, before any job, in messages that name the setting.
"""

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError
from snakemake.utils import update_config

from burstcast_workflow.campaign.lengths import misfits
from burstcast_workflow.config.checks import contradictions
from burstcast_workflow.config.derived import completed
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.config.problems import problems_of
from burstcast_workflow.config.valid_part import valid_part
from burstcast_workflow.project import project_root
from snakemake_logger_plugin_burstcast.config_files import unwieldy

# libyaml's loader where there is one: ten times as fast
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


# numbers that mean in YAML 1.1 what they mean to a person: 0400 is 256 there, and 6:40 is 400
_NUMBERS = {
    "int": re.compile(r"[-+]?(0|[1-9][0-9]*)"),
    "float": re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)(e[-+][0-9]+)?|[-+]?\.(inf|nan)", re.I),
}


# as text, since within a mapping Snakemake reads no values of --config
_WORDS = {"true": True, "false": False, "null": None}


class ConfigError(ValueError):
    """A configuration with mistakes: a message for each.

    ``aside``: Names of settings that are so wrong that what depends on them was not checked.
    """

    def __init__(self, problems: list[str], aside: Sequence[str] = ()) -> None:
        self.problems = problems
        if len(problems) == 1:
            text = f"The configuration has a mistake: {problems[0]}"
        else:
            listed = "\n".join(f"  {number}. {text}" for number, text in enumerate(problems, 1))
            text = f"The configuration has {len(problems)} mistakes:\n{listed}"
        if aside:
            text += f"\nNot yet checked: what depends on {', '.join(aside)}"
        super().__init__(text)


def load(
    config: Mapping[str, Any],
    files: Iterable[str | Path] = (),
    *,
    defaults: str | Path | None = None,
) -> dict[str, Any]:
    """Check a configuration as Snakemake merged it, and put it in canonical form.

    The result has all defaults; `burstcast_workflow.config.model.Configuration` reads it.

    ``config``: The content of config.yaml with everything laid over it. ``files``: The files that
    it was read from, to be searched for `misread`. ``defaults``: A configuration file for what is
    not said: the workflow's own, which another workflow that takes it as a module has not read.
    """
    if problems := unreadable(files := [*files]):
        raise ConfigError(problems)
    config = _with_words(config)
    if defaults is not None:
        whole = yaml.load(Path(defaults).read_text(encoding="utf-8"), _LOADER)
        update_config(whole, config)
        config = whole
    problems, sound, aside = misread(files), None, list[str]()
    try:
        sound = Configuration.model_validate(config)
    except ValidationError as error:
        problems += problems_of(error, Configuration)
        shipped = (project_root() / "config.yaml").read_text(encoding="utf-8")
        sound, aside = valid_part(config, yaml.load(shipped, _LOADER))
    if sound is not None:
        sound = completed(sound)
        relations = [*contradictions(sound), *misfits(sound)]
        problems += [text for text in relations if not any(name in text for name in aside)]
    if problems or sound is None:
        raise ConfigError(problems, aside)
    return sound.dump()


def _with_words(value: Any) -> Any:
    """A value of a config, and all in it, with what the texts true, false and null mean."""
    if isinstance(value, Mapping):
        return {key: _with_words(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_with_words(inner) for inner in value]
    return _WORDS.get(value, value) if isinstance(value, str) else value


def unreadable(paths: Iterable[str | Path]) -> list[str]:
    """Find files that are none, or that would take for ever to check."""
    problems = []
    for path in dict.fromkeys(map(os.path.relpath, paths)):
        if not os.path.isfile(path):
            problems.append(f"{path}: not a file, which jobs can read again")
        # what is no YAML is JSON, without anchors: Snakemake has read it already
        else:
            with suppress(yaml.YAMLError):
                if problem := unwieldy(Path(path).read_text(encoding="utf-8")):
                    problems.append(f"{path}, {problem}")
    return problems


def misread(paths: Iterable[str | Path]) -> list[str]:
    """Find pitfalls of YAML: duplicate keys, octal (0400) and sexagesimal (6:40) numbers, dates."""
    problems: list[str] = []
    for path in dict.fromkeys(map(os.path.relpath, paths)):
        with Path(path).open(encoding="utf-8") as file, suppress(yaml.YAMLError):
            tree = yaml.compose(file, _LOADER)
            problems += [f"{path}, {text}" for text in _misread(tree, "", set())]
    return problems


def _misread(node: yaml.Node | None, name: str, visited: set[int]) -> Iterator[str]:
    if id(node) in visited:  # an alias, which may name what has aliases itself
        return
    visited.add(id(node))
    if isinstance(node, yaml.ScalarNode):
        kind, line = node.tag.rpartition(":")[2], node.start_mark.line + 1
        if kind == "timestamp":
            yield f"line {line}: {name} is {node.value}, which YAML reads as a date: quote it"
        if kind in _NUMBERS and not _NUMBERS[kind].fullmatch(node.value):
            value = yaml.load(node.value, _LOADER)
            yield (
                f"line {line}: {name} is {node.value}, which YAML reads as {value}: write it in "
                f"decimal digits, without zeros before it, : and _; or quote it if it is text"
            )
    if isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            yield from _misread(item, f"{name}[{index}]", visited)
    if isinstance(node, yaml.MappingNode):
        lines: dict[tuple[str, str], int] = {}
        for key, value in node.value:
            line, below = key.start_mark.line + 1, f"{name}.{key.value}".removeprefix(".")
            name_of_key = key.tag, str(key.value)
            if name_of_key in lines:
                first = lines[name_of_key]
                yield f"line {line}: the key {below} is there already, in line {first}"
            lines.setdefault(name_of_key, line)
            yield from _misread(key, f"the key {below}", visited)
            yield from _misread(value, below, visited)

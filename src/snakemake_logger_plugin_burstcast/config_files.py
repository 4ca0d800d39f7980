"""Config files that Snakemake cannot read, told in one line before it tries to.

Of a missing file it prints a traceback, of a mistake in YAML neither the file nor the line.
"""

import argparse
import re
from collections.abc import Sequence
from pathlib import Path

import yaml

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

DEEPEST = 50
"""Most levels of a config."""

MOST_REPEATED = 100_000
"""Most values that anchors repeat."""

_DIGITS = re.compile(r"[-+]?[0-9_]{1000,}")  # Python refuses some, after Snakemake has read others


def unwieldy(text: str) -> str | None:
    """Describe what makes a config endless to read or to check; None if nothing does.

    Snakemake, and checks of settings, visit a value at each place where it stands: an anchor within
    itself never ends, and anchors of anchors make billions of values of a few lines.
    """
    sizes: dict[str | None, int] = {}  # values under each anchor that is complete
    inside: list[tuple[str | None, int]] = []  # the anchors of the levels, and the values before
    values = repeated = 0
    for event in yaml.parse(text, _LOADER):
        assert event.start_mark is not None
        line = f"line {event.start_mark.line + 1}"
        if isinstance(event, yaml.CollectionStartEvent):
            inside.append((event.anchor, values))
            values += 1
            if len(inside) > DEEPEST:
                return f"{line}: more than {DEEPEST} levels of settings"
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = inside.pop()
            if anchor:
                sizes[anchor] = values - before
        elif isinstance(event, yaml.AliasEvent):
            if any(event.anchor == anchor for anchor, _ in inside):
                return f"{line}: *{event.anchor} lies within &{event.anchor}, which never ends"
            size = sizes.get(event.anchor, 1)
            values, repeated = values + size, repeated + size
            if repeated > MOST_REPEATED:
                return f"{line}: with *{event.anchor}, anchors repeat over {MOST_REPEATED} values"
        elif isinstance(event, yaml.ScalarEvent):
            values += 1
            if event.implicit[0] and _DIGITS.fullmatch(event.value):
                return f"{line}: a number of {len(event.value)} digits"
    return None


def unreadable_config(
    arguments: Sequence[str], workflow_config: Path = Path("config.yaml")
) -> str | None:
    """Describe the first config file that cannot be read; None if all can be read.

    ``arguments`` are snakemake's; the workflow's own config need not be there.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--configfile", "--configfiles", nargs="+", default=[], type=Path)
    files = parser.parse_known_args(list(arguments))[0].configfile
    for number, file in enumerate(files):
        if not file.is_file():
            what = "a directory" if file.is_dir() else "no file"
            if file.exists() and not file.is_dir():
                return f"--configfile {file}: a pipe or a device; jobs read it, too: write a file"
            hint = (
                "; --configfile takes all words after it: put targets before it" if number else ""
            )
            return f"--configfile {file}: there is {what} of this name{hint}"
    if workflow_config.is_file():
        files = [workflow_config, *files]
    for file in files:
        text = ""
        try:
            text = file.read_text(encoding="utf-8")
            if problem := unwieldy(text):
                return f"{file}, {problem}"
            if not isinstance(yaml.load(text, _LOADER), dict):
                return f"{file}: holds no settings: a config is lines such as random_seed: 1"
        except yaml.MarkedYAMLError as error:
            mark, problem = error.problem_mark or error.context_mark, error.problem or error.context
            place = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
            if mark and text[mark.index : mark.index + 1] == "\t":
                problem = "there is a tab: indent by spaces"
            return f"{file}{place}: no valid YAML: {problem}"
        except (yaml.YAMLError, OSError, ValueError) as error:
            return f"{file}: cannot be read: {error}".replace("\n", " ")
    return None

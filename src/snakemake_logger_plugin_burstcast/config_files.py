"""Config files that Snakemake cannot read, told in one line before it tries to.

Of a missing file it prints a traceback, of a mistake in YAML neither the file nor the line.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import yaml

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


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
            if not isinstance(yaml.load(text, _LOADER), dict):
                return f"{file}: holds no settings: a config is lines such as random_seed: 1"
        except yaml.MarkedYAMLError as error:
            mark, problem = error.problem_mark or error.context_mark, error.problem or error.context
            place = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
            if mark and text[mark.index : mark.index + 1] == "\t":
                problem = "there is a tab: indent by spaces"
            return f"{file}{place}: no valid YAML: {problem}"
        except (yaml.YAMLError, OSError, UnicodeDecodeError) as error:
            return f"{file}: cannot be read: {error}".replace("\n", " ")
    return None

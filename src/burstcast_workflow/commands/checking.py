"""What the commands share that check a class of one's own before a campaign."""

import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from burstcast.base.discovery import UnsoundError
from burstcast_workflow.tracking.code import make_importable


def checked(
    name: str,
    part: str,
    arguments: Sequence[str],
    parse: Callable[[str], tuple[str, Any]],
    check: Callable[[dict[str, Any]], str],
) -> int:
    """Print the report of a check, or what is wrong; 0 if the class keeps to its interface.

    ``part``: What the arguments ``NAME=VALUE`` are called. ``parse``: Name and value of one of
    them. ``check``: Makes the report from all values by name.
    """
    make_importable([os.fspath(Path.cwd())])
    try:
        pairs = [*map(parse, arguments)]
        values = dict(pairs)
        if len(values) < len(pairs):
            raise ValueError(f"{part} is given twice: {' '.join(arguments)}")
        print(check(values), end="")
    except UnsoundError as error:
        listed = "\n".join(f"  {problem}" for problem in error.problems)
        print(f"{name} has mistakes:\n{listed}", file=sys.stderr)
        return 1
    except SystemExit as error:  # of a script that is written to be run, not imported
        print(f"{name} ends the program: SystemExit({error.code!r})", file=sys.stderr)
        return 1
    except (ValueError, TypeError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0

"""Where modules of one's own are found: in the working directory, and beside the configs.

What is installed comes first: a file of the user's that is called like a library does no harm.
Jobs take the directories from the claim of their run, wherever they are started.
"""

import sys
from collections.abc import Iterable
from pathlib import Path


def search_directories(configs: Iterable[str | Path], project: Path) -> list[str]:
    """Directories of one's own modules: the working directory, then those of the configs.

    Parameters
    ----------
    configs
        Files of the configuration.
    project
        The workflow's own directory, which is none of them.
    """
    places = [Path.cwd(), *(Path(config).absolute().parent for config in configs)]
    outside = [place for place in places if place.resolve() != project.resolve()]
    return list(dict.fromkeys(map(str, outside)))


def make_importable(directories: Iterable[str]) -> None:
    """Let Python look for modules in these directories, too, after all others."""
    sys.path += [directory for directory in directories if directory not in sys.path]

"""A study of one's own: a directory with a Snakefile, a config and four commands to begin with."""

import shutil
import sys
from pathlib import Path

from burstcast_workflow.project import project_root

_SNAKEFILE = '''\
"""{name}: the workflow of burstcast, taken as a module; rules of your own may follow."""

from burstcast_workflow.project import snakefile


configfile: "config.yaml"


module burstcast:
    snakefile:
        snakefile()
    config:
        config


use rule * from burstcast


# how far it is, what was found, and what failed


onstart:
    burstcast.onstart()


onsuccess:
    burstcast.onsuccess()


onerror:
    burstcast.onerror()
'''

_README = """\
# {name}

A study with burstcast, the forecasting and control of extreme events after
[Racca & Magri](https://arxiv.org/abs/2204.11682). `config.yaml` says what is computed, and
`Snakefile` takes the workflow of the installed package as a module.

    snakemake            # runs all that is not there yet; after Ctrl-C it goes on from there
    burstcast why        # what would run again after an edit, and why
    snakemake --reporter burstcast    # tables and figures on one page to hand on, report.html
    burstcast archive    # tables, figures, config and versions in one zip

Results are in `{results}`: `tables/`, `figures/`. `burstcast settings` lists all settings with
their units and defaults; config.yaml is laid over these. In a notebook:
`burstcast_workflow.open_campaign("{results}")`.
"""


class StudyExistsError(ValueError):
    """There is something already where a study was to be laid out."""


def presets() -> dict[str, Path]:
    """Configs that a study can begin with, by name."""
    found = (project_root() / "workflow" / "presets").glob("*.yaml")
    return {path.stem: path for path in sorted(found)}


def lay_out(directory: Path, preset: str) -> list[Path]:
    """Lay out a study in a new or an empty directory; return its files."""
    if directory.exists() and (not directory.is_dir() or any(directory.iterdir())):
        raise StudyExistsError(f"{directory} is there already and not empty: nothing is laid out")
    text = presets()[preset].read_text(encoding="utf-8")
    # comments of a preset say how it runs beside the workflow; a study has its own results
    body = text[text.index("results:") :].split("\n", 1)[1]
    name = directory.resolve().name
    results = f"results/{preset}"
    head = "# Everything that is not here is as burstcast has it: burstcast settings"
    config = f"{head}\n\nresults: {results}\n{body}"
    files = {
        "Snakefile": _SNAKEFILE.format(name=name),
        "config.yaml": config,
        "README.md": _README.format(name=name, results=results),
    }
    directory.mkdir(parents=True, exist_ok=True)
    for file, content in files.items():
        (directory / file).write_text(content, encoding="utf-8")
    # Snakemake finds it by itself: what makes a job run again, and one line of progress
    profile = directory / "profiles" / "default" / "config.yaml"
    profile.parent.mkdir(parents=True)
    shutil.copy(project_root() / "profiles" / "default" / "config.yaml", profile)
    return [*(directory / file for file in files), profile]


def main(directory: Path, preset: str) -> int:
    """Lay out a study that a person asks for; 2 if that cannot be done."""
    try:
        files = lay_out(directory, preset)
    except (StudyExistsError, OSError) as error:
        print(f"burstcast init: {error}", file=sys.stderr)
        return 2
    for path in files:
        print(path)
    print(f"\ncd {directory}; snakemake")
    return 0

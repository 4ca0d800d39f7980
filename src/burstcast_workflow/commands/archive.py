"""Results of a campaign in one zip file that can be cited.

::

    burstcast archive [RESULTS] [--output FILE] [options of snakemake]

It is of a directory of results, with the config of its last run, or of the config that options
name. It holds the tables and figures that the config makes, the page of the report, the config,
``versions.json`` (libraries, and the git revision of the last run), ``why.txt`` (whether anything
would run again, and why),
``CITATION.cff``, and a README. Files are in a fixed order and without times: equal results make
equal archives. Series and forecasters, which are large and follow from the config, are left out.
"""

import json
import os
import platform
import sys
import zipfile
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import yaml

from burstcast_workflow.commands.planned import options_of, planned, reasons
from burstcast_workflow.harness.storage import atomic
from burstcast_workflow.project import project_root
from burstcast_workflow.start import rules_of_burstcast
from burstcast_workflow.tracking import environment
from burstcast_workflow.tracking.code import make_importable
from burstcast_workflow.tracking.environment import library_version
from burstcast_workflow.tracking.run import CLAIM

LIBRARIES = [
    "burstcast",
    "matplotlib",
    "netCDF4",
    "pandas",
    "pydantic",
    "scikit-image",
    "snakemake",
]
"""Libraries whose versions are recorded, with the libraries that change results."""

_KINDS = {"tables": (".csv", ".tex"), "figures": (".pdf", ".png")}
_MOST_NAMES = 5
_TIME = (1980, 1, 1, 0, 0, 0)  # the earliest time of a zip file
_README = """\
# {name}

Results of a campaign of burstcast, {revision}.

* `tables/`: CSV and LaTeX. `figures/`: PDF and PNG.
* `config.yaml`: the whole configuration; `snakemake --configfile config.yaml` makes it all again.
* `report.html`: all of them on one page.
* `versions.json`: Python, the libraries, the kernels of linear algebra, and the revision of
  burstcast that the last run was of.
* `why.txt`: what would run again when this was packed, and why.
* `CITATION.cff`: how to cite burstcast, and the paper whose method it is.
"""


class NothingToArchiveError(ValueError):
    """A campaign has neither tables nor figures, or the archive would replace another file."""


def versions(claim: Mapping[str, Any]) -> dict[str, Any]:
    """Versions of Python and of the libraries here, and of what the last run was of (``claim``)."""
    return {
        "python": platform.python_version(),
        "libraries": {
            name: library_version(name) for name in sorted([*LIBRARIES, *environment.LIBRARIES])
        },
        "revision": claim["revision"],
        "linear algebra": claim["linear algebra"],
    }


def write_archive(target: Path, files: Mapping[str, bytes]) -> None:
    """Write files by their names into a zip, whole or not at all: equal files, equal bits."""
    if target.exists() and not _is_archive(target):
        raise NothingToArchiveError(
            f"{target} is there and no archive of a campaign: give another name (--output)"
        )
    with atomic(target) as partial, zipfile.ZipFile(partial, "w") as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, _TIME)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, files[name])


def _is_archive(path: Path) -> bool:
    if not zipfile.is_zipfile(path):
        return False
    with zipfile.ZipFile(path) as archive:
        return any(name.endswith("/versions.json") for name in archive.namelist())


def tables_and_figures(results: Path) -> list[str]:
    """Names of the tables and figures that are there, whichever config made them."""
    return [
        f"{directory}/{path.name}"
        for directory, suffixes in _KINDS.items()
        for path in sorted((results / directory).glob("*"))
        if path.suffix in suffixes and not path.name.startswith(".")
    ]


def contents(
    results: Path, listed: Collection[str], claim: Mapping[str, Any], why: str
) -> dict[str, bytes]:
    """Files of the archive of a campaign, by their names in it.

    ``listed``: Names of the tables and figures that the config makes.
    """
    present = [name for name in tables_and_figures(results) if name in listed]
    files = {name: (results / name).read_bytes() for name in present}
    if not files:
        raise NothingToArchiveError(
            f"{results} has neither tables nor figures yet: run the campaign first"
        )
    if (page := results / "report.html").exists():
        files["report.html"] = page.read_bytes()
    made_by = versions(claim)
    # a path that exists wherever the campaign is run again
    portable = {**claim["config"], "results": f"results/{results.name}"}
    files["config.yaml"] = yaml.safe_dump(portable, sort_keys=True).encode()
    files["versions.json"] = f"{json.dumps(made_by, indent=2)}\n".encode()
    files["why.txt"] = f"{why}\n".encode()
    readme = _README.format(name=results.name, revision=f"revision {made_by['revision']}")
    files["README.md"] = readme.encode()
    files["CITATION.cff"] = (project_root() / "CITATION.cff").read_bytes()
    return {f"{results.name}/{name}": content for name, content in files.items()}


def _claim_of(results: Path) -> dict[str, Any]:
    path, names = results / CLAIM, ("config", "revision", "linear algebra", "directories")
    try:
        claim = json.loads(path.read_bytes())
        return {name: claim[name] for name in names}
    except FileNotFoundError:
        raise NothingToArchiveError(
            f"{results} holds no results of a campaign: it has no {CLAIM}"
        ) from None
    except (ValueError, KeyError, TypeError):
        raise NothingToArchiveError(f"{path} is damaged: run the campaign again") from None


def _config_of_run(directory: str, temporary: Path) -> list[str]:
    """Options of snakemake for the config of the last run in a directory of results."""
    claim, config = _claim_of(Path(directory)), temporary / "config.yaml"
    config.write_text(yaml.safe_dump(claim["config"]), encoding="utf-8")
    make_importable(claim["directories"])
    return ["--configfile", str(config)]


def main(arguments: Sequence[str], output: Path | None = None) -> int:
    """Pack a campaign's results."""
    try:
        return _pack([*arguments], output)
    except (NothingToArchiveError, OSError) as error:
        print(f"nothing is archived: {error}", file=sys.stderr)
        return 2


def _pack(arguments: list[str], output: Path | None) -> int:
    options = options_of(arguments)
    directories = [target for target in options.targets if Path(target).is_dir()]
    if len(directories) > 1:
        raise NothingToArchiveError(f"one directory at a time, not {', '.join(directories)}")
    for directory in directories:
        arguments.remove(directory)
    with TemporaryDirectory() as temporary:
        if directories and not (options.configfile or options.config):
            arguments += _config_of_run(directories[0], Path(temporary))
        workflow = planned(arguments)
        names = rules_of_burstcast(workflow)
        why = reasons(workflow)
    made = names["started"].results
    for directory in directories:
        if os.path.realpath(directory) != os.path.realpath(made):
            raise NothingToArchiveError(
                f"the config makes {made}, seen from {os.getcwd()}, and not {directory}"
            )
    results, rules = Path(os.path.abspath(made)), names["rules"]
    listed = {
        os.path.relpath(os.path.abspath(path), results)
        for path in (*rules.tables.input, *rules.figures.input)
    }
    target = output or Path(f"{results.name}.zip")
    files = contents(results, listed, _claim_of(results), why)
    write_archive(target, files)
    size = target.stat().st_size / 1e6
    print(f"{target}: {len(files)} files, {size:.1f} MB")
    if others := [name for name in tables_and_figures(results) if name not in listed]:
        more = f" and {len(others) - _MOST_NAMES} more" if len(others) > _MOST_NAMES else ""
        print(
            f"left out, as the config does not make them: {', '.join(others[:_MOST_NAMES])}{more}"
        )
    return 0

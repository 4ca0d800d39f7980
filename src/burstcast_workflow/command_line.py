"""The command ``burstcast``: all that is asked of a campaign beside running it.

``python -m burstcast_workflow`` is the same command. Running is Snakemake's: ``snakemake``.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from burstcast_workflow.project import project_root
from burstcast_workflow.study import StudyExistsError, lay_out, presets

_OF_SNAKEMAKE = "options of snakemake follow, such as --configfile"
_FOR_SNAKEMAKE = ("why", "prune", "costs", "archive")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="burstcast",
        description="Campaigns of burstcast. They are run by snakemake.",
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    def command(name: str, does: str, epilog: str | None = None) -> argparse.ArgumentParser:
        return commands.add_parser(
            name, help=does, description=does, epilog=epilog, allow_abbrev=False
        )

    init = command("init", "lay out a study of one's own: Snakefile, config, README")
    init.add_argument("directory", type=Path, help="where; it is made")
    init.add_argument(
        "--preset",
        choices=list(presets()),
        default="quick",
        help="config to begin with (%(default)s)",
    )
    command("settings", "list all settings with their units, defaults and bounds")
    command("why", "what would run again, and why, in words", _OF_SNAKEMAKE)
    prune = command("prune", "list results that the campaign does not make", _OF_SNAKEMAKE)
    prune.add_argument("--remove", action="store_true", help="remove them with their records")
    command("costs", "predicted time and memory, compared with what jobs took", _OF_SNAKEMAKE)
    archive = command(
        "archive", "tables, figures, config, versions and why in one zip", _OF_SNAKEMAKE
    )
    archive.add_argument("--output", type=Path, help="the zip; <results>.zip if left out")
    # these read their arguments themselves
    for name, does in (
        ("check-system", "look at a dynamical system, and propose a case of it"),
        ("cache", "the cache that campaigns share: size, verify, prune"),
    ):
        commands.add_parser(name, help=does, add_help=False)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return its exit status: 2 where the command makes no sense."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    if given[:1] == ["cache"]:
        from burstcast_workflow.harness import cache

        return cache.main(given[1:])
    if given[:1] == ["check-system"]:
        from burstcast_workflow import check_system

        return check_system.main(given[1:])
    parser = _parser()
    chosen, others = parser.parse_known_args(given)
    if others and chosen.command not in _FOR_SNAKEMAKE:
        parser.error(f"{chosen.command} does not know {' '.join(others)}")
    if chosen.command == "init":
        return _init(chosen.directory, chosen.preset)
    # what follows loads Snakemake, which takes a second
    if chosen.command == "settings":
        import yaml

        from burstcast_workflow.config import reference

        config = yaml.safe_load((project_root() / "config.yaml").read_text(encoding="utf-8"))
        print(reference.text(config), end="")
        return 0
    if chosen.command == "why":
        from burstcast_workflow import why

        return why.main(others)
    if chosen.command == "prune":
        from burstcast_workflow import prune

        return prune.main(others, remove_them=chosen.remove)
    if chosen.command == "costs":
        from burstcast_workflow import cost_report

        return cost_report.main(others)
    from burstcast_workflow import archive

    return archive.main(others, chosen.output)


def _init(directory: Path, preset: str) -> int:
    try:
        files = lay_out(directory, preset)
    except (StudyExistsError, OSError) as error:
        print(f"burstcast init: {error}", file=sys.stderr)
        return 2
    for path in files:
        print(path)
    print(f"\ncd {directory}; snakemake")
    return 0

"""The command ``burstcast``: all that is asked of a campaign beside running it.

``python -m burstcast_workflow`` is the same command. Running is Snakemake's: ``snakemake``.
"""

import argparse
import re
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path

from burstcast_workflow.study import presets

_OF_SNAKEMAKE = "options of snakemake follow, such as --configfile"


_SECONDS = {"s": 1, "min": 60, "h": 3600, "d": 86400, "w": 7 * 86400}
_BYTES = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}


def _quantity(text: str, units: Mapping[str, int]) -> float:
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([A-Za-z]*)", text)
    if match is None or match[2] not in units:
        names = ", ".join(name for name in units if name)
        raise argparse.ArgumentTypeError(f"{text!r}: a number and one of {names}")
    return float(match[1]) * units[match[2]]


def _age(text: str) -> float:
    """Seconds of a time as a person writes it, with its unit: 12h, 30d."""
    return _quantity(text, _SECONDS)


def _size(text: str) -> int:
    """Bytes of a size as a person writes it: 500M, 20G."""
    return int(_quantity(text, _BYTES))


def _parser() -> argparse.ArgumentParser:
    """Commands: each is ``main`` of a module, which gets its arguments by their names."""
    parser = argparse.ArgumentParser(
        prog="burstcast",
        description="Campaigns of burstcast. They are run by snakemake.",
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    def command(
        name: str, module: str, does: str, *, of_snakemake: bool = False
    ) -> argparse.ArgumentParser:
        epilog = _OF_SNAKEMAKE if of_snakemake else None
        added = commands.add_parser(
            name, help=does, description=does, epilog=epilog, allow_abbrev=False
        )
        added.set_defaults(module=module, of_snakemake=of_snakemake)
        return added

    init = command("init", "study", "lay out a study of one's own: Snakefile, config, README")
    init.add_argument("directory", type=Path, help="where; it is made")
    init.add_argument(
        "--preset",
        choices=list(presets()),
        default="quick",
        help="config to begin with (%(default)s)",
    )
    command(
        "settings", "config.reference", "list all settings with their units, defaults and bounds"
    )
    check = command(
        "check-system", "check_system", "look at a dynamical system, and propose a case of it"
    )
    check.add_argument("system", help="lorenz63, ..., or <module>:<class> of your own")
    check.add_argument("parameters", nargs="*", metavar="NAME=VALUE", help="of its equations")
    command("why", "why", "what would run again, and why, in words", of_snakemake=True)
    stale = command(
        "prune", "prune", "list results that the campaign does not make", of_snakemake=True
    )
    stale.add_argument("--remove", action="store_true", help="remove them with their records")
    command(
        "costs",
        "cost_report",
        "predicted time and memory, compared with what jobs took",
        of_snakemake=True,
    )
    archive = command(
        "archive",
        "archive",
        "tables, figures, config, versions and why in one zip",
        of_snakemake=True,
    )
    archive.add_argument("--output", type=Path, help="the zip; <results>.zip if left out")
    cache = command("cache", "cache_command", "the cache that campaigns share: size, verify, prune")
    cache.add_argument(
        "--cache", type=Path, dest="directory", help="its directory (default: $BURSTCAST_CACHE)"
    )
    actions = cache.add_subparsers(dest="action", required=True)
    actions.add_parser("size", help="entries and bytes of each rule")
    actions.add_parser("verify", help="read all entries, remove damaged ones")
    pruning = actions.add_parser("prune", help="remove entries, least recently used first")
    pruning.add_argument("--older-than", type=_age, help="unused for: 12h, 30d, 4w")
    pruning.add_argument("--to-size", type=_size, help="until at most: 500M, 20G")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return its exit status: 2 where the command makes no sense."""
    parser = _parser()
    chosen, others = parser.parse_known_args(arguments)
    own = vars(chosen)
    command, module, of_snakemake = (
        own.pop(name) for name in ("command", "module", "of_snakemake")
    )
    if others and not of_snakemake:
        parser.error(f"{command} does not know {' '.join(others)}")
    # only now: most of them load Snakemake, which takes a second
    run = import_module(f"burstcast_workflow.{module}").main
    status: int = run(others, **own) if of_snakemake else run(**own)
    return status

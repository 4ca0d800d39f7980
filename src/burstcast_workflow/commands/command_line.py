"""The command ``burstcast``: everything about a campaign beside running it.

``python -m burstcast_workflow`` is the same command. Running is Snakemake's: ``snakemake``.
"""

import argparse
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

_OF_SNAKEMAKE = """the directory of the results may follow, such as results/tiny, whose last run had
the config; or options of snakemake, such as --configfile"""


def _parser() -> argparse.ArgumentParser:
    """Commands: each is ``main`` of a module, which gets its arguments by their names."""
    parser = argparse.ArgumentParser(
        prog="burstcast",
        description="Campaigns of burstcast. They are run by snakemake.",
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    def command(
        name: str, module: str, does: str, epilog: str | None = None
    ) -> argparse.ArgumentParser:
        added = commands.add_parser(
            name, help=does, description=does, epilog=epilog, allow_abbrev=False
        )
        added.set_defaults(module=module, of_snakemake=epilog is not None)
        return added

    does = "list all settings with their units, defaults and bounds"
    command("settings", "config.reference", does)
    for kind, example, values in (
        ("system", "lorenz63", "parameters of its equations"),
        ("forecaster", "nvar", "options of its class"),
        ("controller", "burstcast.control.rules:WhileHigh", "options of its class"),
    ):
        check = command(f"check-{kind}", "commands.check", f"check a {kind}")
        check.set_defaults(kind=kind)
        check.add_argument(
            "name", metavar=kind, help=f"{example}, ..., or <module>:<class> of your own"
        )
        check.add_argument("values", nargs="*", metavar="NAME=VALUE", help=values)
    choose = command("choose", "commands.choose", "try kinds of forecasters on a case")
    choose.add_argument("results", type=Path, help="directory of the campaign's results")
    choose.add_argument("case", help="a case whose series are made (ensemble.nc)")
    choose.add_argument("--kinds", help="names with commas between them; all if left out")
    does = "what rules make, from what, with which settings and code"
    names = "names of rules may follow, and options of snakemake, such as --configfile"
    command("explain", "commands.explain", does, names)
    does = "tables, figures, report, config, versions and reasons in one zip"
    archive = command("archive", "commands.archive", does, _OF_SNAKEMAKE)
    archive.add_argument("--output", type=Path, help="the zip; <results>.zip if left out")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return its exit status: 2 where the command makes no sense."""
    parser = _parser()
    chosen, others = parser.parse_known_args(arguments)
    values = vars(chosen)
    command, module = values.pop("command"), values.pop("module")
    of_snakemake = values.pop("of_snakemake")
    if others and not of_snakemake:
        parser.error(f"{command} does not know {' '.join(others)}")
    # only now: most of them load Snakemake, which takes a second
    if of_snakemake:
        from snakemake_logger_plugin_burstcast.config_files import unreadable_config

        if problem := unreadable_config(others):
            parser.error(problem)
    run = import_module(f"burstcast_workflow.{module}").main
    status: int = run(others, **values) if of_snakemake else run(**values)
    return status

"""The cache that campaigns share, on the command line.

::

    burstcast cache size
    burstcast cache verify
    burstcast cache prune --older-than 30d
    burstcast cache prune --to-size 20G
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from burstcast_workflow.harness.cache import VARIABLE, Entry, entries, location, prune, verify


def readable_size(size: float) -> str:
    """Size in bytes as a person reads it: 1.5 GiB."""
    for unit in ("B", "KiB", "MiB", "GiB"):
        if size < 1024:
            return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"
        size /= 1024
    return f"{size:.1f} TiB"


def main(
    action: str,
    directory: Path | None = None,
    *,
    older_than: float | None = None,
    to_size: int | None = None,
) -> int:
    """Show the size of the cache, verify or prune it.

    Parameters
    ----------
    action
        "size", "verify" or "prune".
    directory
        The cache's; that of the environment if left out.
    older_than, to_size
        Of pruning: seconds without use, bytes that may be left. One of them at least.
    """
    directory = directory or location()
    if directory is None:
        print(f"which cache? Set {VARIABLE} or give --cache", file=sys.stderr)
        return 2
    if not directory.is_dir():
        print(f"{directory} does not exist: the cache is empty")
        return 0
    if action == "size":
        _print_sizes(list(entries(directory)))
        return 0
    if action == "verify":
        damaged = verify(directory)
        for path in damaged:
            print(f"damaged, removed: {path}")
        print(f"{sum(1 for _ in entries(directory))} entries are sound")
        return 1 if damaged else 0
    if older_than is None and to_size is None:
        print("prune needs --older-than or --to-size", file=sys.stderr)
        return 2
    removed = prune(directory, older_than=older_than, to_size=to_size)
    print(f"removed {len(removed)} entries, {readable_size(sum(entry.size for entry in removed))}")
    return 0


def _print_sizes(found: Sequence[Entry]) -> None:
    for rule in sorted({entry.rule for entry in found}):
        sizes = [entry.size for entry in found if entry.rule == rule]
        print(f"{rule:20} {len(sizes):6} {readable_size(sum(sizes)):>12}")
    print(f"{'all':20} {len(found):6} {readable_size(sum(entry.size for entry in found)):>12}")

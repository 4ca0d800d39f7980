"""The cache that campaigns share, on the command line.

::

burstcast cache size
burstcast cache verify
burstcast cache prune --older-than 30d
burstcast cache prune --to-size 20G
"""

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from burstcast_workflow.harness.cache import VARIABLE, Entry, entries, location, prune, verify

_SECONDS = {"s": 1, "min": 60, "h": 3600, "d": 86400, "w": 7 * 86400}
_BYTES = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}


def _quantity(text: str, units: Mapping[str, int]) -> float:
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([A-Za-z]*)", text)
    if match is None or match[2] not in units:
        names = ", ".join(name for name in units if name)
        raise argparse.ArgumentTypeError(f"{text!r}: a number and one of {names}")
    return float(match[1]) * units[match[2]]


def age(text: str) -> float:
    """Seconds of a time as a person writes it, with its unit: 12h, 30d."""
    return _quantity(text, _SECONDS)


def size(text: str) -> int:
    """Bytes of a size as a person writes it: 500M, 20G."""
    return int(_quantity(text, _BYTES))


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

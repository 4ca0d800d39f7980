"""Planning by the records of results.

Snakemake keeps metadata by the paths of files, in the directory that it runs in. They say nothing
about files that were exchanged, restored, made by another copy of the project, or that outlived
that directory. Planning therefore reads the records of the results instead
(`snaketrust.records`, `snaketrust.hooks`).

By itself, Snakemake does not check a deleted intermediate file. Here its record counts like the
record of any other file: its job runs again if settings, code or inputs have changed; otherwise it
waits until a job needs the file.
"""

import os
from typing import NamedTuple

from snaketrust.files import digest
from snaketrust.records import Record, Records


class Known(NamedTuple):
    """Knowledge of a result.

    Attributes
    ----------
    record
        Its record, if it is what its job wrote, or was deleted.
    problem
        What is wrong otherwise; empty for a file that was never made.
    changed
        Time of its last change, in nanoseconds; None if it is missing.
    """

    record: Record | None
    problem: str
    changed: int | None


class KnownResults:
    """Knowledge of the files in a results directory, as the rules spell it."""

    def __init__(self, results: str) -> None:
        self.results, self.records = results, Records(results)
        self._known: dict[str, Known] = {}
        self._others: dict[tuple[str, int], str] = {}

    def __contains__(self, path: str) -> bool:
        return path.startswith(f"{self.results}/")

    def of(self, path: str) -> Known:
        """Knowledge of a result; its record is read anew when the file has changed."""
        changed = _time_of_change(path)
        known = self._known.get(path)
        if known is None or known.changed != changed:
            read = self.records.read if changed is None else self.records.found
            record, problem = read(path)
            if changed is None and record is None:
                problem = ""  # never made; what was made from it nevertheless, does not fit
            known = self._known[path] = Known(record, problem, changed)
        return known

    def inputs(self, record: Record) -> dict[str, bool]:
        """Files that a result was made from, and whether they are still those.

        A damaged one is: it is made again anyway.
        """
        paths = {self.records.path(name): value for name, value in record.inputs.items()}
        return {path: self._fits(path, value) for path, value in paths.items()}

    def _fits(self, path: str, value: str) -> bool:
        if path in self:
            known = self.of(path)
            return bool(known.problem) if known.record is None else known.record.digest == value
        changed = _time_of_change(path)
        if changed is None:
            return True  # a source that is missing: Snakemake says so
        if (path, changed) not in self._others:
            self._others[path, changed] = digest(path)
        return self._others[path, changed] == value


def _time_of_change(path: str) -> int | None:
    try:
        return os.stat(path).st_mtime_ns
    except FileNotFoundError:
        return None

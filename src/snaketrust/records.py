"""Records: what made each result, and what it was when it was made.

The record of ``<results>/Re400/events.nc`` is ``<results>/.records/Re400/events.nc.json``: the
job, its settings and code, the digests of its inputs and of the file itself. A job writes it when
all its outputs are in place. What is planned rests on records alone
(`snaketrust.planning`), so they belong to the results, wherever these are moved and whoever
uses them; and each job verifies its inputs by them.

A file is read as a whole to verify it. Of a large one this is remembered: its record keeps the
stamp (size, times, inode) with which the digest was last found right. The time of a
file's last status change cannot be set: it reveals changes, even if other times were put back.
"""

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from snaketrust.files import digest, replaced, stamp
from snaketrust.run import check_ownership

DIRECTORY = ".records"
"""Directory of the records, in the results directory."""

NO_RECORD = "results without a record of what made them"

# larger files are verified by their stamp where it is known; reading a smaller one takes no time
_LARGE = 4 * 2**20


class DamagedFileError(ValueError):
    """A file is not what its job wrote, or nothing says which job that was."""


@dataclass(frozen=True)
class Record:
    """Origin of a file.

    Attributes
    ----------
    path
        The file, below the results directory.
    digest
        SHA-256 of its content.
    stamp
        State of the file when its digest was last found right.
    identity
        Rule and wildcards of its job.
    parameters
        Settings and code of the job, as Snakemake passed them.
    inputs
        Digests of the files that it was made from, by their paths below the results directory.
    log
        Its log, below the results directory; empty if it has none.
    seconds
        How long the job took.
    revision
        Revision of the sources that it was planned with. It makes no job run again: what a job
        runs, the fingerprints in its parameters tell.
    environment
        What the job noted of its surroundings. It makes no job run again either.
    """

    path: str
    digest: str
    stamp: list[int]
    identity: dict[str, Any]
    parameters: dict[str, Any]
    inputs: dict[str, str]
    log: str
    seconds: float
    revision: str = ""
    environment: Sequence[str] = ()

    def __post_init__(self) -> None:
        texts = self.digest, self.log, self.identity["rule"], *self.inputs.values()
        held, kinds = (self.stamp, self.parameters, self.seconds, *texts), (list, dict, float)
        if not all(map(isinstance, held, (*kinds, *[str] * len(texts)))):
            raise TypeError("an entry is not of its type")


class Records:
    """Records of a results directory."""

    def __init__(self, results: str) -> None:
        self.results = results

    def name(self, path: str) -> str:
        """Path of a file from the results directory."""
        prefix = f"{self.results}/"
        inside = path.startswith(prefix)
        return path.removeprefix(prefix) if inside else os.path.relpath(path, self.results)

    def path(self, name: str) -> str:
        """Path of a file from its name, as the rules give it."""
        plain = f"{self.results}/{name}"
        return os.path.normpath(plain) if name.startswith("../") else plain

    def file(self, path: str) -> Path:
        """Path of the record of a file."""
        return Path(f"{self.results}/{DIRECTORY}/{self.name(path)}.json")

    def names(self) -> list[str]:
        """Names of all files that are there and have a record, from the results directory on."""
        root = Path(f"{self.results}/{DIRECTORY}")
        found = sorted(
            str(record.relative_to(root)).removesuffix(".json") for record in root.rglob("*.json")
        )
        return [name for name in found if os.path.exists(self.path(name))]

    def read(self, path: str) -> tuple[Record | None, str]:
        """Read the record of a file, which may have been deleted.

        Returns
        -------
        The record, or None and what is wrong.
        """
        try:
            record = Record(**json.loads(self.file(path).read_bytes()))
        except FileNotFoundError:
            return None, NO_RECORD
        except Exception as error:  # whatever the file holds
            return None, f"the record of {path} cannot be read ({type(error).__name__})"
        if record.path != self.name(path):
            return None, f"the record of {path} belongs to another file, {record.path}"
        return record, ""

    def found(self, path: str, *, read: bool = False) -> tuple[Record | None, str]:
        """Find the record of a file, if the file is still what its job wrote.

        Parameters
        ----------
        path
            The file, which exists.
        read
            Whether to read files that are not large even if their stamps are right.

        Returns
        -------
        The record, or None and what is wrong.
        """
        record, problem = self.read(path)
        if record is None:
            return None, problem
        state = stamp(path)
        if record.stamp == state and not (read and state[0] < _LARGE):
            return record, ""
        if state[:1] != record.stamp[:1] or digest(path) != record.digest:
            return None, f"{path} is not what its job wrote"
        if record.stamp != state and stamp(path) == state:
            with suppress(OSError):  # results that others have made may be read-only
                self._write(replace(record, stamp=state))
        return record, ""

    def write(
        self,
        outputs: Iterable[str],
        identity: Mapping[str, Any],
        parameters: Mapping[str, Any],
        inputs: Mapping[str, str],
        log: str,
        seconds: float,
        revision: str = "",
        environment: Sequence[str] = (),
    ) -> None:
        """Write the records (`Record`) of a job's outputs; inputs by their paths in the rules."""
        for path in outputs:
            if (name := self.name(path)).startswith("../"):
                continue  # elsewhere, as by the prefix of a workflow that has this one as a module
            record = Record(
                path=name,
                digest=digest(path),
                stamp=stamp(path),
                identity=dict(identity),
                parameters=dict(parameters),
                inputs={self.name(source): value for source, value in inputs.items()},
                log=self.name(log) if log else "",
                seconds=round(seconds, 3),
                revision=revision,
                environment=list(environment),
            )
            check_ownership()
            self._write(record)

    def _write(self, record: Record) -> None:
        # Not flushed to the disk: a record that is lost, or that outlives its file, is no harm.
        with replaced(self.file(self.path(record.path))) as partial:
            partial.write_text(json.dumps(asdict(record)))


@dataclass(frozen=True)
class Inputs:
    """Files that a job reads, verified.

    Attributes
    ----------
    by_name
        Their digests, by the rule's names for them.
    by_path
        Their digests.
    stamps
        Their states when they were verified.
    """

    by_name: dict[str, list[str]]
    by_path: dict[str, str]
    stamps: dict[str, list[int]]

    @classmethod
    def read(cls, files: Mapping[str, Sequence[str]], records: Records | None) -> "Inputs":
        """Verify files by their records; without records, outside of the workflow, digest them.

        Raises
        ------
        DamagedFileError
            If a result is not what its job wrote; the message says how to repair it.
        """
        paths = [path for group in files.values() for path in group]
        stamps = {path: stamp(path) for path in paths}
        digests = {path: _verified(path, records) for path in paths}
        by_name = {name: [digests[path] for path in group] for name, group in files.items()}
        return cls(by_name, digests, stamps)

    def check(self) -> None:
        """Check that the files are unchanged since.

        Raises
        ------
        DamagedFileError
            If a file has changed.
        """
        changed = [
            path
            for path, before in self.stamps.items()
            if stamp(path) != before and digest(path) != self.by_path[path]
        ]
        if changed:
            raise DamagedFileError(f"{', '.join(changed)} changed while the job ran: run again")


def _verified(path: str, records: Records | None) -> str:
    if records is None or records.name(path).startswith("../"):
        return digest(path)  # a source
    record, problem = records.found(path, read=True)
    if record is None:
        raise DamagedFileError(f"{problem}: remove it (rm {path}), and run again")
    return record.digest

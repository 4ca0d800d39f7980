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
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from snaketrust.files import digest, replaced, stamp
from snaketrust.plain import groups
from snaketrust.run import check_ownership

DIRECTORY = ".records"
"""Directory of the records, in the results directory."""

NO_RECORD = "results without a record of what made them"

_SOURCE_CACHE = "snakemake-runtime-cache"

# larger files are verified by their stamp where it is known; reading a smaller one takes no time
_LARGE = 4 * 2**20


class DamagedFileError(ValueError):
    """A file is not what its job wrote, or nothing says which job that was."""


@dataclass(frozen=True)
class Record:
    """Origin of a file."""

    path: str  # of the file, below the results directory
    digest: str  # SHA-256 of its content
    stamp: list[int]  # state of the file when its digest was last found right
    identity: dict[str, Any]  # rule and wildcards of its job
    parameters: dict[str, Any]  # of the job, plain data by name, in the order of the rule
    inputs: dict[str, str]  # digests by paths below the results directory, in the rule's order
    log: str  # below the results directory; empty if there is none
    seconds: float  # how long the job took
    revision: str = ""  # of the sources at planning; it makes no job run again
    environment: Sequence[str] = ()  # what the job noted of its surroundings; nor does this
    #: Names of the job's inputs and outputs, and its wildcards, as `shape` tells them; empty in
    #: records of former versions, of which the order of inputs counts alone.
    shape: str = ""
    #: Representations of parameters that JSON cannot hold, with whole numbers as keys.
    texts: Mapping[str, str] = field(default_factory=dict)
    run: str = ""  # token of the run that made it

    def __post_init__(self) -> None:
        texts = self.digest, self.log, self.identity["rule"], *self.inputs.values()
        held, kinds = (self.stamp, self.parameters, self.seconds, *texts), (list, dict, float)
        if not all(map(isinstance, held, (*kinds, *[str] * len(texts)))):
            raise TypeError("an entry is not of its type")

    def represented(self) -> dict[str, str]:
        """Representations of the parameters by name, in the order of the rule."""
        return {key: self.texts.get(key) or repr(one) for key, one in self.parameters.items()}


def shape(
    inputs: Any, read: Sequence[str], outputs: Any, made: Sequence[str], wildcards: Any
) -> str:
    """Text of what tells equal files of a job apart: names of inputs and outputs, and wildcards.

    ``read`` and ``made`` are the files' names in the results directory (`Records.name`).
    """
    own = {key: str(value) for key, value in wildcards.items()}
    return repr([groups(inputs, read), groups(outputs, made), list(made), own])


class Records:
    """Records of a results directory."""

    def __init__(self, results: str) -> None:
        self.results = results
        self._prefix, self._names = f"{results}/", dict[str, str]()

    def name(self, path: str) -> str:
        """Path of a file from the results directory: one for all spellings of the path."""
        if path not in self._names:
            self._names[path] = self._name(path)
        return self._names[path]

    def _name(self, path: str) -> str:
        inside = path.removeprefix(self._prefix)
        if inside != path and not {"", ".", ".."}.intersection(inside.split("/")):
            return inside
        if _SOURCE_CACHE in path:  # a copy of a file of the workflow, in a temporary directory
            return f"../{_SOURCE_CACHE}/{os.path.basename(path)}"
        name = os.path.relpath(path, self.results)
        if name.startswith("../"):  # unless a link leads there
            place, results = map(os.path.realpath, (os.path.dirname(path) or ".", self.results))
            linked = os.path.relpath(os.path.join(place, os.path.basename(path)), results)
            return name if linked.startswith("../") else linked
        return name

    def __contains__(self, path: str) -> bool:
        return not self.name(path).startswith("../")

    def path(self, name: str) -> str:
        """Path of a file from its name, as the rules give it."""
        plain = f"{self.results}/{name}"
        return os.path.normpath(plain) if name.startswith("../") else plain

    def file(self, path: str) -> Path:
        """Path of the record of a file."""
        return Path(f"{self.results}/{DIRECTORY}/{self.name(path)}.json")

    def read(self, path: str) -> tuple[Record | None, str]:
        """Read the record of a file, which may have been deleted."""
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

        With ``read``, files that are not large are read even if their stamps are right.
        """
        record, problem = self.read(path)
        if record is None:
            return None, problem
        state = stamp(path)
        if record.stamp == state and not (_is_coarse(state) or (read and state[0] < _LARGE)):
            return record, ""
        if state[:1] != record.stamp[:1] or digest(path) != record.digest:
            return None, f"{path} is not what its job wrote"
        if record.stamp != state and stamp(path) == state:
            with suppress(OSError):  # results that others have made may be read-only
                self._write(replace(record, stamp=state))
        return record, ""

    def made_by(self, run: str, outputs: Sequence[str]) -> list[Record]:
        """Records of a job's outputs, if this run (its token) has made all; empty otherwise."""
        found = []
        for path in outputs:
            record = self.read(path)[0] if path in self and os.path.exists(path) else None
            if record is None or record.run != run or self.found(path)[0] is None:
                return []
            found.append(record)
        return found

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
        shape: str = "",
        run: str = "",
    ) -> None:
        """Write the records (`Record`) of a job's outputs; inputs by their paths in the rules."""
        held = json.loads(json.dumps(parameters))
        texts = {key: repr(one) for key, one in parameters.items() if repr(held[key]) != repr(one)}
        for path in outputs:
            record = Record(
                path=self.name(path),
                digest=digest(path),
                stamp=stamp(path),
                identity=dict(identity),
                parameters=dict(parameters),
                inputs={self.name(source): value for source, value in inputs.items()},
                log=self.name(log) if log else "",
                seconds=round(seconds, 3),
                revision=revision,
                environment=list(environment),
                shape=shape,
                texts=texts,
                run=run,
            )
            check_ownership()
            self._write(record)

    def _write(self, record: Record) -> None:
        # Not flushed to the disk: a record that is lost, or that outlives its file, is no harm.
        with replaced(self.file(self.path(record.path))) as partial:
            partial.write_text(json.dumps(asdict(record)))


def _is_coarse(state: list[int]) -> bool:
    """Whether a stamp is of a file system with times of whole seconds: edits may leave it alone."""
    return state[2] % 10**9 == 0


@dataclass(frozen=True)
class Inputs:
    """Files that a job reads, verified."""

    by_path: dict[str, str]  # their digests
    stamps: dict[str, list[int]]  # their states when they were verified

    @classmethod
    def read(cls, paths: Sequence[str], records: Records | None) -> "Inputs":
        """Verify files by their records; without records, outside of the workflow, digest them.

        Raises `DamagedFileError`, which says how to repair it, if a result is not what its job
        wrote.
        """
        stamps = {path: stamp(path) for path in paths}
        return cls({path: _verified(path, records) for path in paths}, stamps)

    def check(self) -> None:
        """Check that the files are unchanged since, else raise `DamagedFileError`."""
        changed = [
            path
            for path, before in self.stamps.items()
            if not os.path.exists(path)
            or (
                (_is_coarse(before) or stamp(path) != before) and digest(path) != self.by_path[path]
            )
        ]
        if changed:
            raise DamagedFileError(f"{', '.join(changed)} changed while the job ran: run again")


def _verified(path: str, records: Records | None) -> str:
    if records is None or path not in records:
        return digest(path)  # a source
    record, problem = records.found(path, read=True)
    if record is None:
        raise DamagedFileError(f"{problem}: remove it (rm {path}), and run again")
    return record.digest

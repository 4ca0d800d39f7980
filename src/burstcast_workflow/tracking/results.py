"""Results of jobs: what their job wrote, where, and from what; whether they still are that.

Beside each result lies ``.<name>.sha256``, its note: the digest of what its job wrote, its place
below the results, a hash of the job's parameters, and the digests of the job's inputs; then the
size, times and inode that the file had. A file is only read again where one of the latter differs.
Notes travel with the results, so that these can be copied, moved and restored.
"""

import hashlib
import json
import os
import secrets
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, Self, TypeAlias

_SUFFIX = ".sha256"


class DamagedResultError(ValueError):
    """A result is not what its job wrote."""


class Making(NamedTuple):
    """What a result is made from."""

    parameters: str  #: hash of the job's parameters (`parameters_hash`)
    inputs: Mapping[str, str]  #: digests of the job's inputs, by their places


class Note(NamedTuple):
    """What a job wrote."""

    content: str  #: digest of the content
    place: str  #: path below the results
    making: Making
    stamp: list[int]  #: size, times and inode of the file that has this content


def digest(path: str | Path) -> str:
    """SHA-256 of a file's content; of a directory, a Zarr store, also of its files' names."""
    if (directory := Path(path)).is_dir():
        files = sorted(file for file in directory.rglob("*") if file.is_file())
        named = "".join(f"{digest(file)} {file.relative_to(directory)}\n" for file in files)
        return hashlib.sha256(named.encode()).hexdigest()
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def parameters_hash(parameters: Iterable[Any]) -> str:
    """Hash of a job's parameters, each once, in any order, as Snakemake compares them."""
    return _hash_of_representations(map(repr, parameters))


def place_in(results: str | Path, path: str | Path) -> str:
    """Path of a file below the results, also of a copy that a storage has fetched."""
    root, parts = Path(os.path.normpath(results)).parts, Path(os.path.normpath(path)).parts
    for start in range(len(parts) - len(root), -1, -1):
        if parts[start : start + len(root)] == root:
            return "/".join(parts[start + len(root) :])
    return "/".join(parts)


def note(path: str | Path, content: str, place: str, making: Making) -> None:
    """Write down beside a result what its job wrote."""
    _write(path, Note(content, place, making, _stamp(path)))


def _write(path: str | Path, written: Note) -> None:
    sidecar = _sidecar(path)
    partial = sidecar.with_suffix(f".{secrets.token_hex(4)}")
    partial.write_text(json.dumps({**written._asdict(), "making": written.making._asdict()}))
    os.replace(partial, sidecar)


def noted(path: str | Path) -> Note | None:
    """What a job wrote, by the note beside a result; None without one that can be read."""
    try:
        record = json.loads(_sidecar(path).read_bytes())
        return Note(**{**record, "making": Making(**record["making"])})
    except (OSError, ValueError, KeyError, TypeError):
        return None


def forget(path: str | Path) -> None:
    """Remove the note of a result that is about to be made again, perhaps not to its end."""
    _sidecar(path).unlink(missing_ok=True)


def checked(path: str) -> str:
    """Digest of an input; `DamagedResultError` if it is a result, and not what its job wrote."""
    written = noted(path)
    if written is None:
        return digest(path)  # no result of a job: a file of the user, or one of a storage
    if fault := _fault(path, written):
        raise DamagedResultError(f"{fault}. Delete it, and run again")
    return written.content


def _fault(path: str | Path, written: Note) -> str:
    """What is wrong with a result; empty if it is what its job wrote, where it wrote it."""
    place = Path(written.place).parts
    if Path(path).parts[-len(place) :] != place:
        return f"{path} is a copy of {written.place}, and not what its own job wrote"
    if written.stamp != _stamp(path) and digest(path) != written.content:
        return f"{path} is not what its job wrote: it was edited, exchanged or cut off since"
    return ""


Recorded: TypeAlias = tuple[Iterable[str], Mapping[str, str]]
"""What Snakemake has recorded of a result: representations of parameters, digests of inputs."""


class Notes:
    """Notes of results, by the paths of these, as they were when they were read."""

    def __init__(self, results: str | Path, notes: Mapping[Path, Note]) -> None:
        self.results, self._notes = Path(results), notes

    @classmethod
    def of(cls, results: str | Path) -> Self:
        """All notes in a directory of results."""
        return cls(results, dict(_all_notes(Path(results))))

    def damaged(self) -> list[str]:
        """Results that are not what their jobs wrote; deleted ones are none of them."""
        return [
            fault
            for path, written in sorted(self._notes.items())
            if (fault := _fault(path, written))
        ]

    def stamp(self) -> None:
        """Note the size, times and inode of files that were copied, so that none is read again."""
        for path, written in self._notes.items():
            if path.exists() and (stamp := _stamp(path)) != written.stamp:
                with suppress(OSError):  # the results may be read-only
                    _write(path, written._replace(stamp=stamp))

    def is_up_to_date(
        self, path: str, recorded: Recorded, parameters: Callable[[], Iterable[Any]]
    ) -> bool:
        """Whether an existing result is one of its job's parameters and of the inputs there are.

        Or whether Snakemake sees by itself that it is not: by the parameters that it has recorded,
        and by inputs that are newer than the result and have other contents than it has recorded.
        ``parameters``: Those of the job as it is now.
        """
        written = self._notes.get(Path(path))
        if written is None:
            return False
        of_note, of_record = written.making.parameters, _hash_of_representations(recorded[0])
        if of_note != of_record and of_note != parameters_hash(parameters()):
            return False
        return all(self._is_seen(place, path, recorded[1]) for place in self._others(written))

    def _others(self, written: Note) -> Iterator[str]:
        """Inputs that have another content than those a result was made from."""
        for place, content in written.making.inputs.items():
            now = self._notes.get(self.results / place)
            if now is not None and now.content != content:
                yield place

    def _is_seen(self, place: str, path: str, recorded: Mapping[str, str]) -> bool:
        """Whether Snakemake sees that an input is another: it is newer, with another content."""
        source = self.results / place
        if os.stat(source).st_mtime_ns <= os.stat(path).st_mtime_ns:
            return False
        return recorded.get(str(source), "").removeprefix("sha256:") != self._notes[source].content


def _hash_of_representations(texts: Iterable[str]) -> str:
    return hashlib.sha256("\n".join(sorted({*texts})).encode()).hexdigest()[:16]


def _all_notes(results: Path) -> Iterator[tuple[Path, Note]]:
    for sidecar in results.rglob(f".*{_SUFFIX}"):
        path = sidecar.with_name(sidecar.name.removeprefix(".").removesuffix(_SUFFIX))
        if path.exists() and (written := noted(path)):
            yield path, written


def date_after(outputs: Iterable[str], inputs: Iterable[str]) -> None:
    """Date outputs no earlier than inputs, which another machine's clock may have dated later."""
    newest = max((os.stat(path).st_mtime_ns for path in inputs), default=0)
    for path in outputs:
        if os.stat(path).st_mtime_ns < newest:
            os.utime(path, ns=(newest, newest))


def _sidecar(path: str | Path) -> Path:
    path = Path(path)
    return path.with_name(f".{path.name}{_SUFFIX}")


def _stamp(path: str | Path) -> list[int]:
    state = os.stat(path)
    return [state.st_size, state.st_mtime_ns, state.st_ctime_ns, state.st_ino]

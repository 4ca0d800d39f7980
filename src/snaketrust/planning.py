"""Planning by the records of results.

Snakemake keeps metadata by the paths of files, in the directory that it runs in. They say nothing
about files that were exchanged, restored, made by another copy of the project, or that outlived
that directory. Planning therefore reads the records of the results instead
(`snaketrust.records`, `snaketrust.hooks`).

By itself, Snakemake does not check a deleted intermediate file. Here its record counts like the
record of any other file: its job runs again if settings, code or inputs have changed; otherwise it
waits until a job needs the file.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

from snaketrust.files import digest, stamp
from snaketrust.plain import named, plain
from snaketrust.records import Record, Records, shape


class Known(NamedTuple):
    """Knowledge of a result."""

    record: Record | None  # if it is what its job wrote, or was deleted
    problem: str  # what is wrong otherwise; empty for a file that was never made
    stamp: Sequence[int]  # its state (`snaketrust.files.stamp`); empty if it is missing


class KnownResults:
    """Knowledge of the files in a results directory, as the rules spell it."""

    def __init__(self, results: str) -> None:
        self.results, self.records = results, Records(results)
        self._known: dict[str, Known] = {}
        self._others: dict[tuple[str | int, ...], str] = {}

    def __contains__(self, path: str) -> bool:
        return path in self.records

    def of(self, path: str) -> Known:
        """Knowledge of a result; its record is read anew when the file has changed."""
        state = _stamp(path)
        known = self._known.get(path)
        if known is None or known.stamp != state:
            record, problem = self.records.found(path) if state else self.records.read(path)
            if not state and record is None:
                problem = ""  # never made; what was made from it nevertheless, does not fit
            known = self._known[path] = Known(record, problem, state)
        return known

    def inputs(self, record: Record) -> dict[str, bool]:
        """Files that a result was made from, and whether they are still those.

        A damaged one is: it is made again anyway.
        """
        paths = {self.records.path(name): value for name, value in record.inputs.items()}
        return {path: self.fits(path, value) for path, value in paths.items()}

    def fits(self, path: str, value: str) -> bool:
        """Whether a file that a result was made from has this digest still, or is damaged."""
        if path in self:
            known = self.of(path)
            return bool(known.problem) if known.record is None else known.record.digest == value
        state = _stamp(path)
        if not state:
            return True  # a source that is missing: Snakemake says so
        if (path, *state) not in self._others:
            self._others[path, *state] = digest(path)
        return self._others[path, *state] == value


def _stamp(path: str) -> list[int]:
    try:
        return stamp(path)
    except FileNotFoundError:
        return []


class Jobs:
    """Comparison of planned jobs with the records of their results."""

    def __init__(self, known: KnownResults) -> None:
        self.known = known
        # representations of parameters by their id; the parameters are kept
        self._texts: dict[int, tuple[Any, str]] = {}

    def text(self, value: Any, name: str) -> str:
        """Representation of a parameter in plain form."""
        found = self._texts.get(id(value))
        if found is None or found[0] is not value:
            found = self._texts[id(value)] = value, repr(plain(value, name))
        return found[1]

    def name(self, path: Any) -> str:
        """Path of a file from the results directory."""
        return self.known.records.name(str(path))

    def changed_parameters(self, job: Any, path: str) -> tuple[set[str], set[str]]:
        """Parameters, names and wildcards of a job that its result has not, and the reverse."""
        record, problem, _ = self.known.of(path)
        if record is None:
            return ({problem} if problem else set()), set()
        parameters, values = named(job.params), record.represented()
        now = [
            # what Snakemake cannot tell yet, since an input is missing, is not compared
            f"{key}: {values.get(key)}"
            if type(value).__name__ == "TBDString"
            else f"{key}: {self.text(value, f'params.{key} of the rule {job.rule.name}')}"
            for key, value in parameters.items()
        ]
        then = [f"{key}: {value}" for key, value in values.items()]
        if {*now} == {*then} and now != then:
            return {f"the order {', '.join(values)}"}, {f"the order {', '.join(parameters)}"}
        told = ""
        if record.shape:
            read, made = ([*map(self.name, files)] for files in (job.input, job.output))
            told = shape(job.input, read, job.output, made, job.wildcards_dict)
        if told != record.shape:
            then, now = [*then, record.shape], [*now, told]
        return {*then} - {*now}, {*now} - {*then}

    def has_other_inputs(self, job: Any, path: str) -> bool:
        """Whether a result was made from other files, in another order or with other content."""
        record = self.known.of(path).record
        if record is None:
            return False
        paths = {self.name(one): str(one) for one in job.input}
        return [*paths] != [*record.inputs] or not all(
            self.known.fits(paths[name], value) for name, value in record.inputs.items()
        )

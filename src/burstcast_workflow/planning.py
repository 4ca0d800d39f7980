"""What Snakemake knows of results that are there: their own records, and nothing else.

Snakemake keeps records of its own, by the paths of files, in the directory that it runs in. They
say nothing about files that were exchanged, restored, made by another copy of the project, or that
outlived that directory. Here it is told what the results' own records say instead
(`burstcast_workflow.harness.records`).

By itself, Snakemake checks nothing about an intermediate file that was deleted. Here the record of
a deleted file counts like that of any other file: its job runs again if settings, code or inputs
have changed, and is left out otherwise, until a job needs the file.
"""

import os
from functools import cache
from typing import Any

import snakemake.api  # noqa: F401 - other modules of Snakemake cannot be imported before it
from snakemake.persistence import RECORD_FORMAT_VERSION, MetadataRecord, PersistenceBase

from burstcast_workflow.harness.records import Record, Records, digest

FORMER = " as it was"
"""What is put after the path of an input whose content is not what a file was made from."""

_snakemakes_own = PersistenceBase.metadata
_marked_incomplete = PersistenceBase.incomplete


def plan_by_records(results: str) -> None:
    """Let Snakemake plan by the records of a results directory.

    Parameters
    ----------
    results
        The directory, as the rules spell it.
    """
    records = Records(results)

    @cache
    def found(path: str, changed: int | None) -> tuple[Record | None, str]:
        return records.read(path) if changed is None else records.found(path)

    def fits(path: str, value: str) -> bool:
        """Whether an input is what a file was made from; a damaged one is made again anyway."""
        changed = _time_of_change(path)
        if not path.startswith(f"{results}/"):
            return changed is None or digest(path) == value
        record, _ = found(path, changed)
        return changed is not None if record is None else record.digest == value

    @cache
    def known(path: str, changed: int | None) -> MetadataRecord | None:
        record, problem = found(path, changed)
        if record is None:
            if changed is None:
                return None  # never made; what was made from it nevertheless, does not fit
            # parameters that no job has: it runs again, and Snakemake says why
            return MetadataRecord(record_format_version=RECORD_FORMAT_VERSION, params=[problem])
        inputs = {records.path(name): value for name, value in record.inputs.items()}
        end = (changed or 0) / 1e9
        return MetadataRecord(
            record_format_version=RECORD_FORMAT_VERSION,
            rule=record.identity["rule"],
            params=sorted(map(repr, record.parameters.values())),
            input=sorted(
                path if fits(path, value) else path + FORMER for path, value in inputs.items()
            ),
            input_checksums={path: f"sha256:{value}" for path, value in inputs.items()},
            log=[records.path(record.log)],
            starttime=end - record.seconds,
            endtime=end,
        )

    def metadata(self: PersistenceBase, target: Any) -> MetadataRecord | None:
        path = str(target)
        if not path.startswith(f"{results}/"):
            return _snakemakes_own(self, target)
        return known(path, _time_of_change(path))

    async def incomplete(self: PersistenceBase, job: Any) -> list[Any]:
        """Outputs that were being made when Snakemake was killed, and were not finished since."""
        marked = await _marked_incomplete(self, job)
        return [file for file in marked if (made := metadata(self, file)) is None or not made.rule]

    PersistenceBase.metadata = metadata
    PersistenceBase.incomplete = incomplete


def _time_of_change(path: str) -> int | None:
    """Time of a file's last change, in nanoseconds; None if there is no such file."""
    try:
        return os.stat(path).st_mtime_ns
    except FileNotFoundError:
        return None

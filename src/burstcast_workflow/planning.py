"""What Snakemake knows of results that are there: their own records, and nothing else.

Snakemake keeps records of its own, by the paths of files, in the directory that it runs in. They
say nothing about files that were exchanged, restored, made by another copy of the project, or that
outlived that directory. Here it is told what the results' own records say instead
(`burstcast_workflow.harness.records`).
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
    def found(path: str, _changed: int) -> tuple[Record | None, str]:
        return records.found(path)

    def content(path: str) -> str | None:
        """Digest of a file as it is now; None if it is not there, or damaged."""
        if not os.path.exists(path):
            return None
        if not path.startswith(f"{results}/"):
            return digest(path)
        record, _ = found(path, os.stat(path).st_mtime_ns)
        return None if record is None else record.digest

    @cache
    def known(path: str, changed: int) -> MetadataRecord:
        record, problem = found(path, changed)
        if record is None:
            # parameters that no job has: it runs again, and Snakemake says why
            return MetadataRecord(record_format_version=RECORD_FORMAT_VERSION, params=[problem])
        inputs = {records.path(name): value for name, value in record.inputs.items()}
        return MetadataRecord(
            record_format_version=RECORD_FORMAT_VERSION,
            rule=record.identity["rule"],
            params=sorted(map(repr, record.parameters.values())),
            input=sorted(
                path if content(path) in (value, None) else path + FORMER
                for path, value in inputs.items()
            ),
            input_checksums={path: f"sha256:{value}" for path, value in inputs.items()},
            log=[records.path(record.log)],
            starttime=changed / 1e9 - record.seconds,
            endtime=changed / 1e9,
        )

    def metadata(self: PersistenceBase, target: Any) -> MetadataRecord | None:
        path = str(target)
        if not path.startswith(f"{results}/"):
            return _snakemakes_own(self, target)
        return known(path, os.stat(path).st_mtime_ns) if os.path.exists(path) else None

    async def incomplete(self: PersistenceBase, job: Any) -> list[Any]:
        """Outputs that were being made when Snakemake was killed, and were not finished since."""
        marked = await _marked_incomplete(self, job)
        return [file for file in marked if (made := metadata(self, file)) is None or not made.rule]

    PersistenceBase.metadata = metadata
    PersistenceBase.incomplete = incomplete

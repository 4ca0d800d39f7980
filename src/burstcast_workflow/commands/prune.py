"""Results that the campaign does not make any more: ``burstcast prune [options of snakemake]``.

A stale file has a record, and no job of the whole campaign makes it. Own files have no record.
"""

import sys
from collections.abc import Sequence
from typing import Any

from burstcast_workflow.start import covers_campaign, names_of_rules
from snaketrust.plan import planned
from snaketrust.records import Records


def stale_files(results: str, workflow: Any) -> list[str]:
    """Paths of recorded results that a plan of the whole campaign does not make; none of a part."""
    if not covers_campaign(workflow):
        return []
    records = Records(results)
    made = {records.name(str(path)) for job in workflow.dag.jobs for path in job.output}
    return [f"{results}/{name}" for name in records.names() if name not in made]


def stale_note(results: str, workflow: Any) -> str:
    """One line about stale files for the end of a run; empty if none are known."""
    if not (count := len(stale_files(results, workflow))):
        return ""
    counted = f"{count} file{'s' if count > 1 else ''}"
    return f"Not of this campaign any more: {counted} in {results} (burstcast prune lists them)."


def main(arguments: Sequence[str]) -> int:
    """Print the stale files, one a line."""
    workflow = planned(arguments)
    if not covers_campaign(workflow):
        print("prune looks at the whole campaign: leave out targets", file=sys.stderr)
        return 2
    for path in stale_files(names_of_rules(workflow)["run"].results, workflow):
        print(path)
    return 0

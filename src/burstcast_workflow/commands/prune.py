"""Results that the campaign does not make any more: named, and removed where that is wanted.

::

    burstcast prune [--remove] [options of snakemake]

A stage that was switched off and networks that left the campaign leave files behind, which nothing
keeps up to date. The records know them all (`snaketrust.records`): what has a
record, and is not made by any job of the plan of the whole campaign, is stale. Files without a
record, a user's own, are never looked at.
"""

import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from burstcast_workflow.start import covers_campaign, names_of_rules
from snaketrust.plan import planned
from snaketrust.records import Records
from snaketrust.run import OvertakenError, Run


class PartOfCampaignError(ValueError):
    """A plan has only a part of the campaign."""


def stale_files(results: str, workflow: Any) -> list[str]:
    """Names of files in a results directory that a planned campaign does not make any more."""
    if not covers_campaign(workflow):
        raise PartOfCampaignError("this looks at the whole campaign: leave out targets")
    records = Records(results)
    made = {records.name(str(path)) for job in workflow.dag.jobs for path in job.output}
    return [name for name in records.names() if name not in made]


def stale_note(results: str, workflow: Any) -> str:
    """One line about stale files for the end of a run; empty if none are known."""
    try:
        count = len(stale_files(results, workflow))
    except PartOfCampaignError:
        return ""
    counted = f"{count} file{'s' if count > 1 else ''}"
    said = f"Not of this campaign any more: {counted} in {results} (burstcast prune lists them)."
    return said if count else ""


def remove_files(results: str, names: Sequence[str]) -> list[str]:
    """Remove files with their records, and directories that are empty then.

    Files that are not what their jobs wrote stay: a user has put them there. Returns why each file
    stays that is not removed.
    """
    Run("", results).check_idle()
    records, kept = Records(results), []
    for name in names:
        record, problem = records.found(records.path(name))
        if record is None:
            kept.append(problem)
            continue
        for path in (Path(records.path(name)), records.file(records.path(name))):
            path.unlink(missing_ok=True)
            for above in path.parents[: len(path.relative_to(results).parts) - 1]:
                with suppress(OSError):  # not empty
                    above.rmdir()
    return kept


def main(arguments: Sequence[str], *, remove: bool = False) -> int:
    """List stale files; remove them if told so."""
    workflow = planned(arguments)
    run = names_of_rules(workflow)["run"]
    kept: list[str] = []
    try:
        names = stale_files(run.results, workflow)
        if remove:
            kept = remove_files(run.results, names)
    except (PartOfCampaignError, OvertakenError) as error:
        print(error, file=sys.stderr)
        return 2
    for name in names:
        print(f"{run.results}/{name}")
    what = "removed" if remove else "not of this campaign any more (--remove?)"
    print(f"{len(names) - len(kept)} files in {run.results}: {what}")
    for problem in kept:
        print(f"not removed: {problem}", file=sys.stderr)
    return 1 if kept else 0

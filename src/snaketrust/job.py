"""Steps around a job's own work: check code and inputs, take or keep results, record them."""

import logging
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from snaketrust.cache import Cache, restore, store
from snaketrust.files import remove_partial
from snaketrust.fingerprint import check_code, script_of
from snaketrust.modules import make_importable
from snaketrust.records import Inputs, Records
from snaketrust.run import Run

logger = logging.getLogger(__name__)


def run_job(
    snakemake: Any,
    compute: Callable[[], object],
    *,
    identity: Mapping[str, Any] | None = None,
    cache: Callable[[], Cache | None] = lambda: None,
    environment: Callable[[], Sequence[str]] = list,
) -> None:
    """Make a job's outputs, and write the records that make them results.

    The job has the parameter ``code``, fingerprints of what it runs (`Sources.fingerprint`), and
    any others, which are plain data.

    Parameters
    ----------
    snakemake
        The object that Snakemake puts into the script.
    compute
        Writes the outputs.
    identity
        Plain data that says which job it is; rule and wildcards unless told otherwise.
    cache
        Gives the cache that the job's results may be in.
    environment
        Gives what the records note of the surroundings, once the job has done its work.

    Raises
    ------
    UnlikeCodeError
        If the code on disk is not what was planned, at the beginning or at the end.
    DamagedFileError
        If an input is not what its job wrote, or has changed while the job ran.
    OvertakenError
        If a newer run has claimed the results directory.
    """
    start = time.monotonic()
    run = Run.current()
    records = None if run is None else Records(run.results)
    plan: dict[str, Any] = {"code": {}, "directories": []} if run is None else run.plan()
    make_importable(plan["directories"])
    identity = identity or {"rule": str(snakemake.rule), **dict(snakemake.wildcards.items())}
    script, parameters = script_of(snakemake), dict(snakemake.params.items())
    check_code(script, parameters["code"], plan["code"])
    for path in map(Path, snakemake.output):
        path.parent.mkdir(parents=True, exist_ok=True)
        remove_partial(path)

    inputs, shelf = Inputs.read(_by_name(snakemake.input), records), cache()
    outputs = {
        f"{name}{number or ''}": Path(path)
        for name, paths in _by_name(snakemake.output).items()
        for number, path in enumerate(paths)
    }
    job = {"identity": identity, "parameters": parameters, "inputs": inputs.by_name}
    entry = shelf.entry(**job, outputs=sorted(outputs)) if shelf else None
    cached = entry is not None and restore(entry, outputs)
    if not cached:
        compute()

    # what was edited meanwhile may have taken part
    check_code(script, parameters["code"], plan["code"])
    inputs.check()
    seconds = time.monotonic() - start
    if records is not None:
        log = snakemake.log[0] if snakemake.log else ""
        noted = plan["revision"], environment()
        records.write(snakemake.output, identity, parameters, inputs.by_path, log, seconds, *noted)
    if entry is not None and not cached:
        store(entry, identity["rule"], outputs, seconds)


def _by_name(files: Any) -> dict[str, list[str]]:
    """A job's inputs or outputs by the rule's names for them; those without a name as ``file``."""
    found = {name: [one] if isinstance(one, str) else list(one) for name, one in files.items()}
    named = {path for group in found.values() for path in group}
    unnamed = [path for path in files if path not in named]
    return {**found, **({"file": unnamed} if unnamed else {})}

"""Steps around a job's own work: check code and inputs, take or keep results, record them."""

import logging
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from snaketrust.cache import Cache, restore, store
from snaketrust.files import remove_partial
from snaketrust.fingerprint import check_code, script_of
from snaketrust.modules import UnlikeCodeError, make_importable
from snaketrust.plain import groups, named, plain
from snaketrust.records import Inputs, Records, shape
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
    any others, which are plain data; ``compute`` finds them in one form (`snaketrust.plain`).

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
    parameters = {
        name: plain(value, f"params.{name}") for name, value in named(snakemake.params).items()
    }
    _hand_on(snakemake, parameters)
    script = script_of(snakemake)
    check_code(script, parameters["code"], plan["code"])
    for path in map(Path, snakemake.output):
        path.parent.mkdir(parents=True, exist_ok=True)
        remove_partial(path)

    paths = list(map(str, snakemake.input))
    inputs, shelf = Inputs.read(paths, records), cache()
    outputs = {str(place): Path(path) for place, path in enumerate(snakemake.output)}
    name = str if records is None else records.name
    read, made = ([*map(name, files)] for files in (paths, snakemake.output))
    told = shape(snakemake.input, read, snakemake.output, made, snakemake.wildcards)
    places = [groups(snakemake.input, read), groups(snakemake.output, made)]
    job = {"identity": identity, "parameters": repr(parameters), "places": repr(places)}
    digests = {one: inputs.by_path[path] for one, path in zip(read, paths, strict=True)}
    if run is not None and records is not None:
        texts = {key: repr(value) for key, value in parameters.items()}
        before = records.made_by(run.token, [*snakemake.output])
        same = [
            (one.represented(), one.inputs, one.shape) == (texts, digests, told) for one in before
        ]
        if before and all(same):
            logger.info("this run has made the outputs before: they are kept")
            return
        for path in outputs.values() if before else ():
            path.unlink()
    entry = shelf.entry(**job, inputs=[*digests.values()]) if shelf else None
    cached = entry is not None and restore(entry, outputs)
    if not cached:
        compute()

    # what was edited meanwhile may have taken part
    check_code(script, parameters["code"], plan["code"])
    inputs.check()
    seconds = time.monotonic() - start
    if records is not None:
        log = snakemake.log[0] if snakemake.log else ""
        noted = plan["revision"], environment(), told, plan["token"]
        records.write(snakemake.output, identity, parameters, inputs.by_path, log, seconds, *noted)
    if entry is not None and not cached:
        store(entry, identity["rule"], outputs, seconds)


class _Untracked:
    """The config in a job: reading it would be a setting that nothing compares."""

    def __getattr__(self, name: str) -> Any:
        raise UnlikeCodeError(
            "a job reads snakemake.config, which no record compares: give what it reads to the "
            "rule's params"
        )

    __getitem__ = __contains__ = __iter__ = __len__ = __getattr__


def _hand_on(snakemake: Any, parameters: Mapping[str, Any]) -> None:
    """Give a script the parameters that are compared, and no config."""
    handed, kind = snakemake.params, type(snakemake)
    names = {place: name for name, (place, _) in handed._get_names()}
    for place, value in enumerate(parameters.values()):
        handed[place] = value
        if place in names:
            setattr(handed, names[place], value)
    if isinstance(getattr(kind, "params", None), property):  # a copy each time that it is read
        snakemake.__class__ = type(kind.__name__, (kind,), {"params": handed})
    snakemake.config = _Untracked()

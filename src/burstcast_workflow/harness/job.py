"""Harness of the workflow's scripts: log, failure, provenance.

A script is one function with explicit arguments, at its end::

    @job
    def scan(*, ensemble: str, scan: str, settings: Scan) -> None: ...

The arguments are the rule's inputs and outputs by their names, and ``settings``, whose class
declares them (`burstcast_workflow.harness.settings`). Settings that other jobs determine, event
thresholds and the unit of time, have their values already.
"""

import atexit
import gc
import json
import logging
import os
import platform
import re
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn

from burstcast.base.discovery import imported_file
from burstcast.base.files.atomic_files import remove_partial
from burstcast_workflow.harness.canonical import canonical_json
from burstcast_workflow.harness.logs import FROM_CACHE
from burstcast_workflow.harness.settings import (
    THRESHOLDS,
    TIME_UNIT,
    JobSettings,
    Provenance,
    at,
    concerning,
    exponent_in,
    with_thresholds,
)
from burstcast_workflow.harness.storage import (
    atomic,
    read_json,
    write_json,
    write_netcdf,
    write_table,
    write_text,
)
from burstcast_workflow.project import packages_of, project_root
from burstcast_workflow.tracking.cache import Entry
from burstcast_workflow.tracking.code import Sources, make_importable
from burstcast_workflow.tracking.environment import LIBRARIES, environment, library_version
from burstcast_workflow.tracking.results import checked, date_after, digest, forget, note
from burstcast_workflow.tracking.run import plan

__all__ = [
    "JobSettings",
    "at",
    "atomic",
    "concerning",
    "job",
    "read_json",
    "tell",
    "write_json",
    "write_netcdf",
    "write_table",
    "write_text",
]
"""The names that scripts import."""

logger = logging.getLogger(__name__)
_terminal = logger.getChild("told")


_functions: dict[str, Callable[..., None]] = {}  # of scripts, by their modules


def job(function: Callable[..., None]) -> Callable[..., None]:
    """Run a script's function as a job if Snakemake runs the script; if not, only return it."""
    _functions[function.__module__] = function
    if snakemake := function.__globals__.get("snakemake"):
        run_job(snakemake, function)
    return function


@cache
def function_of(script: Path) -> Callable[..., None]:
    """Function of a script, which is imported and runs nothing."""
    return _functions[imported_file(script).__name__]


def settings_taken(function: Callable[..., None]) -> type[JobSettings]:
    """Class of the settings that a script's function takes."""
    taken: type[JobSettings] = function.__annotations__.get("settings", JobSettings)
    return taken


def run_job(snakemake: Any, function: Callable[..., None]) -> None:
    """Run a script's function with everything that it prints in the rule's log.

    Floating-point errors keep NumPy's defaults, a warning in the log: a diverged forecast is a
    result, and the library raises an error where a number must be finite.
    """
    # at exit, Python would search all objects for garbage: a tenth of a second with SciPy
    atexit.register(gc.freeze)
    log = Path(snakemake.log[0])
    log.parent.mkdir(parents=True, exist_ok=True)
    label = _label(snakemake)
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup does with the latter
            signal.signal(number, _terminate)
    start = time.monotonic()
    with _output_to(log) as stderr:
        logging.basicConfig(
            stream=sys.stderr,
            level=logging.INFO,
            format="%(asctime)s %(levelname)s %(name)s: %(message)s",
            force=True,
        )
        logging.getLogger("fontTools").setLevel(logging.WARNING)  # it tells each glyph of a figure
        logging.captureWarnings(True)
        aloud = logging.StreamHandler(stderr)
        aloud.setFormatter(logging.Formatter(f"{label}: %(message)s"))
        _terminal.addHandler(aloud)
        try:
            _run(snakemake, function, label)
            logger.info("%s is done: %s", label, _cost(start))
        except Exception as error:
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            print(f"{label} failed: {reason} (log: {log})", file=stderr, flush=True)
            traceback.print_exc()
            logger.error("%s failed: %s", label, _cost(start))
            raise SystemExit(1) from None


def tell(message: str) -> None:
    """Print a message on the terminal of the run, and log it."""
    _terminal.warning(message)


class UnlikeCodeError(RuntimeError):
    """The code that runs is not what was planned."""


def _run(snakemake: Any, function: Callable[..., None], label: str) -> None:
    """Compute a job's outputs, or take them from the cache."""
    start = time.monotonic()
    declared, code = parameters(snakemake.params)
    (script,) = [entry.partition(" ")[0] for entry in code if ".py @" in entry]
    # one script makes many tables: there, the rule names the table's maker
    identity = job_identity(snakemake.params.get("maker") or Path(script).stem, snakemake.wildcards)
    logger.info("%s starts with settings %s", label, canonical_json(declared))
    planned = plan()
    make_importable(planned["directories"])
    sources = _checked_code(snakemake, function, code, planned)
    inputs = _contents(snakemake.input)
    entry = Entry(
        snakemake.output,
        identity=identity,
        settings=declared,
        code=code,
        inputs=inputs,
        names={name: [*map(_name, _listed(files))] for name, files in snakemake.output.items()},
        environment=environment(),
        libraries=sources.libraries(entry.partition(" ")[0] for entry in code),
    )
    for path in snakemake.output:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        remove_partial(path)
        forget(path)
    if made := entry.restore():
        seconds, log = made
        print(log)
        logger.info("%sthe outputs are those of this job, which took %.2f s", FROM_CACHE, seconds)
        _keep(snakemake)
        return

    files = {**dict(snakemake.input.items()), **dict(snakemake.output.items())}
    records = map(read_json, files.pop(THRESHOLDS, []))
    thresholds = {record["case"]: record["event_threshold"] for record in records}
    values = with_thresholds(declared, thresholds.__getitem__)
    exponent = exponent_in(files.pop(TIME_UNIT, ""))
    settings = settings_taken(function)(values, identity, provenance(identity, declared), exponent)
    function(**files, settings=settings)
    if unread := settings.unread():
        logger.info("settings not read: %s", ", ".join(unread))

    # what was edited meanwhile may have taken part
    _checked_code(snakemake, function, code, plan())
    if inputs != _contents(snakemake.input):
        raise UnlikeCodeError("an input has changed while the job ran: run again")
    seconds = time.monotonic() - start
    entry.store(_keep(snakemake), snakemake.rule, seconds, Path(snakemake.log[0]))


def parameters(params: Iterable[Any]) -> tuple[dict[str, Any], list[str]]:
    """Settings by path, and entries of code, of a job's parameters (`Stages.of_script`)."""
    texts = [text for text in params if isinstance(text, str)]
    code = [text for text in texts if re.fullmatch(r".+ @[0-9a-f]+", text) and " = " not in text]
    pairs = (text.partition(" = ") for text in texts)
    settings = {path: json.loads(value) for path, equals, value in pairs if equals}
    return dict(sorted(settings.items())), sorted(code)


def _checked_code(
    snakemake: Any, function: Callable[..., None], code: list[str], planned: Mapping[str, Any]
) -> Sources:
    """The sources, after a check that the code on disk is what the run has planned."""

    def script(name: str) -> Path:
        path = Path(snakemake.scriptdir) / Path(name).name
        # of a module from a repository, there is only the copy that Snakemake runs
        return path if path.is_file() else Path(function.__code__.co_filename)

    packages = packages_of(project_root())
    modules = {entry.partition(" ")[0]: () for entry in code}
    sources = Sources(script, packages, modules)
    others = {*code} - {*planned["code"]}
    if changed := sources.changed(code) or [entry.partition(" ")[0] for entry in others]:
        raise UnlikeCodeError(
            f"{', '.join(changed)} changed after the workflow was planned: nothing is kept of this "
            f"job; run the workflow again when the edit is done"
        )
    return sources


def _contents(inputs: Any) -> dict[str, list[list[str]]]:
    """Names and digests of inputs, by the names of the rule's inputs."""
    return {
        name: [[_name(file), checked(file)] for file in _listed(files)]
        for name, files in inputs.items()
    }


def _keep(snakemake: Any) -> list[str]:
    """Note what the outputs are; return their digests."""
    date_after(snakemake.output, snakemake.input)
    digests = [*map(digest, snakemake.output)]
    for path, content in zip(snakemake.output, digests, strict=True):
        note(path, content)
    return digests


def _listed(files: str | list[str]) -> list[str]:
    return [files] if isinstance(files, str) else files


def _name(path: str) -> str:
    """Name of a file and of its directory: in no campaign a file lies in the results themselves."""
    return "/".join(Path(path).parts[-2:])


def provenance(identity: Mapping[str, Any], settings: Mapping[str, Any]) -> Provenance:
    """Provenance of an output: package, job, settings, versions; no time, machine or path.

    All libraries that change results are there: which of them a job imports depends on its
    settings, and llvmlite is imported late.
    """
    record = {
        "source": f"burstcast {version('burstcast')}",
        "rule": identity["rule"],
        "identity": canonical_json(dict(identity)),
        "settings": canonical_json(dict(settings)),
        "python": platform.python_version(),
    }
    return {**record, **{library: library_version(library) for library in LIBRARIES}}


def job_identity(rule: str, wildcards: Mapping[str, str]) -> dict[str, Any]:
    """Rule and wildcards of a job, numbers as numbers."""
    return {"rule": rule, **{name: _value(text) for name, text in _telling(wildcards).items()}}


def _telling(wildcards: Mapping[str, str]) -> dict[str, str]:
    """Wildcards without the family of a forecaster, which follows from its name."""
    return {name: text for name, text in wildcards.items() if name != "family"}


def _value(text: str) -> str | int | float:
    if not re.fullmatch(r"\d+(\.\d+)?", text):
        return text
    number = float(text)
    return int(number) if number.is_integer() else number


def _label(snakemake: Any) -> str:
    """Rule and wildcards as a person reads them: train (case=Re400, seed=3)."""
    names = _telling(snakemake.wildcards).items()
    wildcards = ", ".join(f"{name}={value}" for name, value in names)
    return f"{snakemake.rule} ({wildcards})" if wildcards else str(snakemake.rule)


@contextmanager
def _output_to(log: Path) -> Iterator[Any]:
    """Send stdout and stderr to the log, compiled code's included; yield the original stderr."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = os.dup(1), os.dup(2)
    streams = sys.stdout, sys.stderr
    with (
        log.open("w", encoding="utf-8", buffering=1, errors="backslashreplace") as file,
        os.fdopen(os.dup(saved[1]), "w", encoding="utf-8", errors="backslashreplace") as stderr,
    ):
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        sys.stdout = sys.stderr = file
        try:
            yield stderr
        finally:
            sys.stdout, sys.stderr = streams
            for descriptor, original in zip((1, 2), saved, strict=True):
                os.dup2(original, descriptor)
                os.close(original)


def _terminate(signum: int, _frame: Any) -> NoReturn:
    """Leave through the exits of all contexts, which removes half-written files."""
    raise SystemExit(128 + signum)


def _cost(start: float) -> str:
    return f"{time.monotonic() - start:.2f} s, peak memory {_peak_memory() / 2**20:.0f} MiB"


def _peak_memory() -> int:
    """Largest resident memory of this process so far, in bytes."""
    status = Path("/proc/self/status")
    if status.exists():  # getrusage on Linux includes the process that this one was forked from
        for line in status.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024

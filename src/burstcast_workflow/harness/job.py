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
import inspect
import logging
import os
import platform
import re
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn

from burstcast_workflow.harness.canonical import canonical, canonical_json
from burstcast_workflow.harness.environment import (
    LIBRARIES,
    blas_kernels,
    library_version,
    shared_results,
)
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
from snaketrust import job as trust
from snaketrust.fingerprint import script_of

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
_told = logger.getChild("told")


def job(function: Callable[..., None]) -> Callable[..., None]:
    """Run a script's function as a job if Snakemake runs the script; if not, only return it."""
    if snakemake := function.__globals__.get("snakemake"):
        run_job(snakemake, function)
    return function


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
        logging.captureWarnings(True)
        aloud = logging.StreamHandler(stderr)
        aloud.setFormatter(logging.Formatter(f"{label}: %(message)s"))
        _told.addHandler(aloud)
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
    _told.warning(message)


def _run(snakemake: Any, function: Callable[..., None], label: str) -> None:
    """Compute a job's outputs, or take them from the cache, and record what made them."""
    # one script makes many tables: there, the rule names the table's maker
    name = snakemake.params.get("maker") or script_of(snakemake).stem
    identity = job_identity(name, snakemake.wildcards)
    declared = canonical(dict(snakemake.params.settings), "params.settings")
    logger.info("%s starts with settings %s", label, canonical_json(declared))

    def compute() -> None:
        files = {**_by_name(snakemake.input), **_by_name(snakemake.output)}
        known = _known(declared, files.pop(THRESHOLDS, []))
        exponent = exponent_in(files.pop(TIME_UNIT, ""))
        of_job = function.__annotations__.get("settings", JobSettings)
        settings = of_job(known, identity, provenance(identity, declared), exponent)
        function(**arguments_for(function, {**files, "settings": settings}))
        if unread := settings.unread():
            logger.info("settings not read: %s", ", ".join(unread))

    trust.run_job(
        snakemake,
        compute,
        identity=identity,
        cache=shared_results if snakemake.resources.get("cached", 0) else lambda: None,
        environment=blas_kernels,
    )


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
    return {"rule": rule, **{name: _value(text) for name, text in wildcards.items()}}


def _known(settings: Any, thresholds: list[str]) -> Any:
    """Settings with the event thresholds of these files, where the config gives quantiles."""
    values = {one["case"]: one["event_threshold"] for one in map(read_json, thresholds)}
    return with_thresholds(settings, values.__getitem__)


def _by_name(files: Any) -> dict[str, Any]:
    return {name: file if isinstance(file, str) else list(file) for name, file in files.items()}


def arguments_for(function: Callable[..., Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Given arguments that a function takes; it must take all files."""
    taken = inspect.signature(function).parameters
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in taken.values()):
        return dict(given)
    ignored = [name for name in given if name not in (*taken, "settings")]
    if ignored:
        raise TypeError(f"{function.__name__} takes no argument {', '.join(ignored)}")
    return {name: value for name, value in given.items() if name in taken}


def _value(text: str) -> str | int | float:
    if not re.fullmatch(r"\d+(\.\d+)?", text):
        return text
    number = float(text)
    return int(number) if number.is_integer() else number


def _label(snakemake: Any) -> str:
    """Rule and wildcards as a person reads them: train (case=Re400, seed=3)."""
    wildcards = ", ".join(f"{name}={value}" for name, value in snakemake.wildcards.items())
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

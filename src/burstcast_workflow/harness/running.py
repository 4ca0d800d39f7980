"""Runs jobs: log, failure, cache, ownership of the results. Nothing here changes a result.

It is in no fingerprint (`burstcast_workflow.project.UNTRACKED`): an edit runs no job again.
"""

import atexit
import gc
import logging
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from burstcast.base.files.atomic_files import remove_partial
from burstcast_workflow.harness.call import Call, identifying
from burstcast_workflow.harness.canonical import canonical_json
from burstcast_workflow.harness.logs import FROM_CACHE
from burstcast_workflow.project import packages_of, project_root
from burstcast_workflow.tracking.cache import Entry
from burstcast_workflow.tracking.code import Sources, make_importable, of_files
from burstcast_workflow.tracking.environment import environment
from burstcast_workflow.tracking.results import (
    Making,
    checked,
    date_after,
    digest,
    forget,
    note,
    parameters_hash,
    place_in,
)
from burstcast_workflow.tracking.run import check_ownership, plan

logger = logging.getLogger(__name__)
_terminal = logger.getChild("told")


def run_job(snakemake: Any, function: Callable[..., None], call: type[Call]) -> None:
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
            _run(snakemake, call(function, snakemake), label)
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


def _run(snakemake: Any, call: Call, label: str) -> None:
    """Compute a job's outputs, or take them from the cache."""
    start = time.monotonic()
    logger.info("%s starts with settings %s", label, canonical_json(call.settings))
    planned = plan(snakemake.config.get("results", ""))
    make_importable(planned["directories"])
    sources = _checked_code(snakemake, call, planned)
    inputs = _contents(snakemake.input)
    entry = Entry(
        snakemake.output,
        identity=call.identity,
        settings=call.settings,
        code=call.code,
        inputs=inputs,
        names={name: [*map(_name, _listed(files))] for name, files in snakemake.output.items()},
        environment=environment(),
        libraries=sources.libraries(call.code),
    )
    for path in snakemake.output:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        check_ownership()  # a job that was held up takes away no note of a newer run's results
        remove_partial(path)
        forget(path)
    making = _making(snakemake, planned["results"])
    if made := entry.restore():
        seconds, log = made
        print(log)
        logger.info("%sthe outputs are those of this job, which took %.2f s", FROM_CACHE, seconds)
        _note(snakemake, making, planned["results"], _dated(snakemake))
        return

    if unread := call():
        logger.info("settings not read: %s", ", ".join(unread))

    # what was edited meanwhile may have taken part
    _checked_code(snakemake, call, plan(snakemake.config.get("results", "")))
    if inputs != _contents(snakemake.input):
        raise UnlikeCodeError("an input has changed while the job ran: run again")
    seconds = time.monotonic() - start
    # in the log that the cache keeps, too
    logger.info("computed in %.2f s, %.2f s of processor", seconds, _processor())
    digests = _dated(snakemake)
    entry.store(digests, snakemake.rule, seconds, Path(snakemake.log[0]))
    _note(snakemake, making, planned["results"], digests)


def _checked_code(snakemake: Any, call: Call, planned: Mapping[str, Any]) -> Sources:
    """The sources, after a check that the code on disk is what the run has planned."""

    def script(name: str) -> Path:
        path = Path(snakemake.scriptdir) / Path(name).name
        # of a module from a repository, there is only the copy that Snakemake runs
        return path if path.is_file() else call.file

    sources = Sources(script, packages_of(project_root()), dict.fromkeys(call.code, ()))
    whole, code = planned["code"], of_files(call.code)
    missing = [name for name in code if name not in whole]
    if changed := missing or sources.changed({name: whole[name] for name in code}):
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


def _making(snakemake: Any, results: str) -> Making:
    """What the outputs of a job are made with: its parameters, and the contents of its inputs."""
    inputs = {place_in(results, path): checked(path) for path in snakemake.input}
    return Making(parameters_hash(snakemake.params), inputs)


def _dated(snakemake: Any) -> list[str]:
    """Digests of the outputs, which get a date no earlier than the inputs'."""
    date_after(snakemake.output, snakemake.input)
    return [*map(digest, snakemake.output)]


def _note(snakemake: Any, making: Making, results: str, digests: list[str]) -> None:
    """Note beside the outputs what they are."""
    check_ownership()
    for path, content in zip(snakemake.output, digests, strict=True):
        note(path, content, place_in(results, path), making)


def _listed(files: str | list[str]) -> list[str]:
    return [files] if isinstance(files, str) else files


def _name(path: str) -> str:
    """Name of a file and of its directory: in no campaign a file lies in the results themselves."""
    return "/".join(Path(path).parts[-2:])


def _label(snakemake: Any) -> str:
    """Rule and wildcards as a person reads them: train (case=Re400, seed=3)."""
    names = identifying(snakemake.wildcards).items()
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
    seconds = time.monotonic() - start
    return (
        f"{seconds:.2f} s, {_processor():.2f} s of processor with the start of Python, "
        f"peak memory {_peak_memory() / 2**20:.0f} MiB"
    )


def _processor() -> float:
    """Seconds of the processor that this process and its finished children have taken."""
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def _peak_memory() -> int:
    """Largest resident memory of this process so far, in bytes."""
    status = Path("/proc/self/status")
    if status.exists():  # getrusage on Linux includes the process that this one was forked from
        for line in status.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024

"""Whether a job runs the code that its rule took fingerprints of.

Fingerprints are taken when the workflow is planned, jobs run later, for hours in a campaign, and
perhaps in another environment. A result of other code under the record of this one would be
believed for good.
"""

import marshal
import os
import py_compile
import sys
from collections.abc import Collection, Iterable, Sequence
from contextlib import suppress
from importlib.util import MAGIC_NUMBER, cache_from_source
from pathlib import Path
from typing import Any

import burstcast
import burstcast_workflow
from burstcast_workflow.fingerprint import fingerprint, forget_files


class CodeChangedError(RuntimeError):
    """The code that a job runs is not what its rule was planned with."""


def package_root() -> Path:
    """Directory that both packages are imported from.

    Raises
    ------
    CodeChangedError
        If they are imported from different places.
    """
    roots = {
        Path(package.__path__[0]).resolve().parent for package in (burstcast, burstcast_workflow)
    }
    if len(roots) > 1:
        listed = " and ".join(sorted(map(str, roots)))
        raise CodeChangedError(
            f"burstcast and burstcast_workflow lie in different places: {listed}"
        )
    return roots.pop()


def check_imports(sources: Path) -> None:
    """Check that Python imports the packages from the sources that fingerprints are taken of.

    Raises
    ------
    CodeChangedError
        If it imports another copy: edits of this one would be recorded, and the other one run.
    """
    if package_root() != sources.resolve():
        raise CodeChangedError(
            f"this workflow lies beside the sources in {sources}, but Python imports burstcast "
            f"from {package_root()}, another copy: install this one (make does), or set PYTHONPATH "
            f"to {sources}"
        )


# of compiled modules: what Python looks at before it runs one (PEP 552)
_HEADER_LENGTH = 16
_BY_CONTENT = MAGIC_NUMBER + bytes([0b11, 0, 0, 0])


def compile_by_content(sources: Path, own_files: Iterable[Path] = ()) -> None:
    """Compile modules so that Python compares them with the content of their sources.

    By itself it compares size and time of change only, and runs an old compiled module after an
    edit that keeps both. A module that is compiled like this stays so. These are the project's and
    the user's own.

    Parameters
    ----------
    sources
        Directory of the project's packages.
    own_files
        Modules that lie elsewhere.

    Raises
    ------
    CodeChangedError
        If this process itself runs a module that was compiled from another source.
    """
    running = {
        os.path.abspath(getattr(one, "__file__", "") or "") for one in [*sys.modules.values()]
    }
    stale = []
    for path in (*sorted(sources.absolute().glob("burstcast*/**/*.py")), *own_files):
        compiled = Path(cache_from_source(str(path)))
        before = compiled.read_bytes() if compiled.exists() else b""
        if before.startswith(_BY_CONTENT):
            continue
        # where nothing may be written, or a source is not Python, Python says so itself
        with suppress(OSError, py_compile.PyCompileError):
            mode = py_compile.PycInvalidationMode.CHECKED_HASH
            py_compile.compile(str(path), doraise=True, invalidation_mode=mode)
            if str(path) in running and before.startswith(MAGIC_NUMBER):
                old, new = (text[_HEADER_LENGTH:] for text in (before, compiled.read_bytes()))
                stale += [path.name] if marshal.loads(old) != marshal.loads(new) else []
    if stale:
        raise CodeChangedError(
            f"Python had compiled {', '.join(stale)} from another source with the same size and "
            f"time: it is compiled anew now, run again"
        )


def script_of(snakemake: Any) -> Path:
    """File of a job's script, from the object that Snakemake puts into it."""
    names = [str(entry).rpartition("@")[0] for entry in snakemake.params.code]
    (script,) = [name for name in names if name.endswith(".py") and ":" not in name]
    return Path(snakemake.scriptdir) / script


def changed_code(script: Path, code: Sequence[str]) -> list[str]:
    """Names of the script and the modules that are not what they were when fingerprints were taken.

    Parameters
    ----------
    script
        The job's script.
    code
        Fingerprints as its rule passes them.
    """
    forget_files()
    planned = dict(entry.rsplit("@", 1) for entry in code)
    modules = [name for name in planned if name != script.name]
    try:
        found = dict(entry.rsplit("@", 1) for entry in fingerprint(script, package_root(), modules))
    except FileNotFoundError as error:
        return [str(error)]
    return sorted(name for name in {*planned, *found} if planned.get(name) != found.get(name))


def check_code(script: Path, code: Sequence[str], planned: Collection[str]) -> None:
    """Check that the code on disk is what fingerprints were taken of when the run was planned.

    Parameters
    ----------
    script
        The job's script.
    code
        Fingerprints as its rule passes them; on a cluster, they are taken anew for every job.
    planned
        Fingerprints of all code at the time when the run was planned.

    Raises
    ------
    CodeChangedError
        If it is not.
    """
    edited = [entry.rpartition("@")[0] for entry in code if entry not in planned]
    if changed := sorted({*edited, *changed_code(script, code)}):
        raise CodeChangedError(
            f"{', '.join(changed)} changed after the workflow was planned: nothing is kept of this "
            f"job; run the workflow again when the edit is done"
        )

"""Places where Python finds modules, and checks that it runs their present sources."""

import importlib.util
import marshal
import os
import pkgutil
import py_compile
import sys
from collections.abc import Iterable
from contextlib import suppress
from importlib.machinery import EXTENSION_SUFFIXES, ModuleSpec
from importlib.util import MAGIC_NUMBER, cache_from_source
from pathlib import Path

SUFFIXES = (*EXTENSION_SUFFIXES, ".py")
"""Endings of the files of modules, in the order in which Python looks for them."""


class UnlikeCodeError(RuntimeError):
    """The code that runs, or would run, is not what fingerprints were taken of."""


def module_file(module: str) -> Path | None:
    """File that Python runs when it imports a module, which need not have been imported.

    None if there is no such module, or it has no file (built-in modules, namespace packages).
    """
    first, *rest = module.split(".")
    try:
        spec = importlib.util.find_spec(first)
    except (ImportError, ValueError):
        return None
    name, directories = first, list((spec and spec.submodule_search_locations) or [])
    for part in rest:
        name = f"{name}.{part}"
        found = [_spec_in(directory, name) for directory in directories]
        spec = next((one for one in found if one is not None and one.loader is not None), None)
        places = found if spec is None else [spec]
        directories = [
            place for one in places for place in (one and one.submodule_search_locations) or []
        ]
    return Path(spec.origin).absolute() if spec and spec.has_location and spec.origin else None


def _spec_in(directory: str, module: str) -> ModuleSpec | None:
    """Specification of a module in a directory of its package."""
    importer = pkgutil.get_importer(directory)
    return importer.find_spec(module) if importer is not None else None


def search_directories(configs: Iterable[str | Path], project: Path) -> list[str]:
    """Directories of a user's own modules: the working directory, then the configs' directories.

    The project's own directory is none of them.
    """
    places = [Path.cwd(), *(Path(config).absolute().parent for config in configs)]
    outside = [place for place in places if place.resolve() != project.resolve()]
    return list(dict.fromkeys(map(str, outside)))


def make_importable(directories: Iterable[str]) -> None:
    """Let Python look for modules in these directories, too, after all others.

    What is installed comes first: a file that is called like a library does no harm.
    """
    sys.path += [directory for directory in directories if directory not in sys.path]


# of compiled modules: what Python looks at before it runs one (PEP 552)
_HEADER_LENGTH = 16
_BY_CONTENT = MAGIC_NUMBER + bytes([0b11, 0, 0, 0])


def compile_by_content(files: Iterable[Path]) -> None:
    """Compile modules so that Python compares them with the content of their sources.

    By itself it compares size and time of change only, and runs an old compiled module after an
    edit that keeps both. `UnlikeCodeError` if this process runs an old one.
    """
    running = {
        os.path.abspath(getattr(one, "__file__", "") or "") for one in [*sys.modules.values()]
    }
    stale = []
    for path in files:
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
        raise UnlikeCodeError(
            f"Python had compiled {', '.join(stale)} from another source with the same size and "
            f"time: it is compiled anew now, run again"
        )

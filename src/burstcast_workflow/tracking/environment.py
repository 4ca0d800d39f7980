"""Environment that numbers depend on: versions of libraries, Python, the processor."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_info

LIBRARIES = ("numpy", "scipy", "llvmlite", "scikit-learn", "scikit-optimize")
"""Libraries another version of which may give other numbers."""


def environment() -> dict[str, Any]:
    """All that last digits depend on beside the code, as plain data.

    All of `LIBRARIES`, as every file names them: a job's code may not import what computes for it,
    as scikit-learn does for scikit-optimize.
    """
    import numpy  # most jobs that ask for it have it loaded; the others start without it

    return {
        "libraries": {library: library_version(library) for library in LIBRARIES},
        "python": ".".join(platform.python_version_tuple()[:2]),
        "machine": platform.machine(),
        "instructions": numpy.show_config(mode="dicts").get("SIMD Extensions"),
        "blas": numpy_blas(),
    }


@cache
def library_version(library: str) -> str:
    """Version of a library; not every platform has every library."""
    try:
        return version(library)
    except PackageNotFoundError:
        return "not installed"


def numpy_blas() -> list[str]:
    """NumPy's BLAS: version, kernel for this processor, and threads.

    OpenBLAS chooses the kernel by the processor's model or ``OPENBLAS_CORETYPE``; another one adds
    in another order. A wheel of SciPy brings a BLAS that belongs to SciPy's version: whether it is
    loaded already depends on the order of imports.
    """
    import numpy  # loads it

    package = Path(numpy.__file__).resolve().parent
    places = {package, package.with_name("numpy.libs")}
    loaded = [library for library in threadpool_info() if library["user_api"] == "blas"]
    of_wheel = [library for library in loaded if places & {*Path(library["filepath"]).parents}]
    return sorted(
        f"{library['internal_api']} {library['version']} {library.get('architecture', '')}, "
        f"threads {library['num_threads']}"
        for library in of_wheel or loaded
    )

"""Environment that numbers depend on: versions of libraries, Python, the processor."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from threadpoolctl import threadpool_info

LIBRARIES = ("numpy", "scipy", "llvmlite", "scikit-learn", "scikit-optimize")
"""Libraries another version of which may give other numbers."""


def environment() -> dict[str, Any]:
    """All that last digits depend on beside the libraries that a job imports, as plain data."""
    import numpy  # most jobs that ask for it have it loaded; the others start without it

    return {
        "python": ".".join(platform.python_version_tuple()[:2]),
        "machine": platform.machine(),
        "instructions": numpy.show_config(mode="dicts").get("SIMD Extensions"),
        "blas": blas_kernels(),
    }


@cache
def library_version(library: str) -> str:
    """Version of a library; not every platform has every library."""
    try:
        return version(library)
    except PackageNotFoundError:
        return "not installed"


def blas_kernels() -> list[str]:
    """BLAS libraries of this process: version, kernel for this processor, and threads.

    OpenBLAS chooses the kernel by the processor's model or ``OPENBLAS_CORETYPE``; another one adds
    in another order.
    """
    return sorted(
        f"{library['internal_api']} {library['version']} {library.get('architecture', '')}, "
        f"threads {library['num_threads']}"
        for library in threadpool_info()
        if library["user_api"] == "blas"
    )

"""Environment that numbers depend on: libraries, Python, the processor."""

import logging
import os
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_info

from snaketrust.cache import Cache

logger = logging.getLogger(__name__)

CACHE = "BURSTCAST_CACHE"
"""Environment variable that names the cache's directory. It is no setting: it changes no result."""

LIBRARIES = ("numpy", "scipy", "llvmlite", "scikit-learn", "scikit-optimize")
"""Libraries another version of which may give other numbers."""


def shared_results() -> Cache | None:
    """The cache of results of the expensive stages; None where there is none."""
    directory = os.environ.get(CACHE, "")
    try:
        return Cache(Path(directory).expanduser(), environment()) if directory else None
    except RuntimeError as error:
        logger.warning("the cache %s is not used: %s", directory, error)
        return None


def environment() -> dict[str, Any]:
    """All that last digits depend on, as plain data."""
    import numpy  # most jobs that ask for it have it loaded; the others start without it

    return {
        "libraries": {name: library_version(name) for name in LIBRARIES},
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
        f"{one['internal_api']} {one['version']} {one.get('architecture', '')}, "
        f"threads {one['num_threads']}"
        for one in threadpool_info()
        if one["user_api"] == "blas"
    )

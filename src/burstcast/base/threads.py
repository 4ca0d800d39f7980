"""One thread for the libraries of linear algebra, also where several threads of Python ask for it.

Threads of small matrices wait for each other more than they work. Each use limits what is loaded by
then; the last one that ends gives the process back the numbers that it had before the first.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits

_LOCK = threading.Lock()
_LIMITS: list[threadpool_limits] = []
_USERS: list[int] = [0]


@contextmanager
def single_threaded() -> Iterator[None]:
    """Limit the threads of BLAS and OpenMP to one as long as any user is inside."""
    import scipy.linalg  # noqa: F401 - its BLAS is limited only once it is loaded

    with _LOCK:
        _USERS[0] += 1
        _LIMITS.append(threadpool_limits(limits=1))
    try:
        yield
    finally:
        with _LOCK:
            _USERS[0] -= 1
            if not _USERS[0]:
                while _LIMITS:
                    _LIMITS.pop().restore_original_limits()

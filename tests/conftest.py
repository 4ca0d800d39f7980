"""What all tests need."""

import os

import pytest

# Before anything loads a BLAS: as in the workflow's jobs, and because threads of tests that run
# beside other work slow each other down.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

# Runs of whole campaigns that tests of several files look at.
SHARED = ("finished", "miniature")


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tell pytest-xdist which tests belong together: those of a file, or of a shared run.

    With `-n 2 --dist loadgroup` a process then makes what they share once.
    """
    for item in items:
        shared = [name for name in SHARED if name in getattr(item, "fixturenames", ())]
        item.add_marker(pytest.mark.xdist_group(shared[0] if shared else item.path.name))

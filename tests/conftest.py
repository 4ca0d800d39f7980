"""What all tests need."""

import os

from hypothesis import settings

# Before anything loads a BLAS: as in the workflow's jobs, and because threads of tests that run
# beside other work slow each other down.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
# a machine that does other work, too, breaks no test
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")

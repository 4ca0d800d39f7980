"""What all tests need."""

import os

# Before anything loads a BLAS: as in the workflow's jobs, and because threads of tests that run
# beside other work slow each other down.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

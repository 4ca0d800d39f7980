"""What all tests need."""

import os
import signal as signals

import pytest
from hypothesis import settings

# Before anything loads a BLAS: as in the workflow's jobs, and because threads of tests that run
# beside other work slow each other down.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
# Jobs of tests run, whatever a cache of the user's has; and they can be interrupted, where a shell
# that runs the tests in the background lets all of them ignore it.
os.environ.pop("BURSTCAST_CACHE", None)
signals.signal(signals.SIGINT, signals.default_int_handler)
# Property tests draw the same examples in every run of the gate. `make test-long` draws new ones
# with the profile "new" and a seed that its command line shows. No deadline: other work on the
# machine breaks no test.
settings.register_profile("gate", deadline=None, derandomize=True)
settings.register_profile("new", deadline=None, print_blob=True)
settings.load_profile("gate")


def pytest_collection_modifyitems(items):
    """Files that run campaigns come first: with several processes, none waits for another's."""
    items.sort(key=lambda item: not item.nodeid.startswith("tests/workflow"))


@pytest.fixture(scope="session")
def signal():
    """Noisy data of several frequencies: five series of 900 steps, (steps, dimension, batch)."""
    import numpy as np

    generator = np.random.default_rng(7)
    time = np.arange(900)[:, None, None]
    frequency = np.array([0.05, 0.081, 0.131, 0.212])
    phase = generator.uniform(0, 2 * np.pi, size=(frequency.size, 5))
    waves = np.sin(2 * np.pi * frequency[None, :, None] * time / 4 + phase[None])
    mixing = generator.normal(size=(4, frequency.size))
    clean = np.einsum("ij,tjb->tib", mixing, waves + 0.5 * waves[:, ::-1] ** 2)
    noise = generator.normal(size=clean.shape) * clean.std(axis=(0, 2))[:, None]
    return clean + 0.01 * noise


@pytest.fixture(scope="session")
def reservoir():
    """A reservoir for the signal."""
    import numpy as np

    from burstcast.networks.reservoir import make_reservoir

    return make_reservoir(150, 4, 8, 0.1, np.random.default_rng(3))

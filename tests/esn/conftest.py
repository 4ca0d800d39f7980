import numpy as np
import pytest

from burstcast.esn.reservoir import make_reservoir

DIMENSION = 4


@pytest.fixture(scope="session")
def signal():
    """Noisy data of several frequencies: five series of 900 steps, (steps, dimension, batch)."""
    generator = np.random.default_rng(7)
    time = np.arange(900)[:, None, None]
    frequency = np.array([0.05, 0.081, 0.131, 0.212])
    phase = generator.uniform(0, 2 * np.pi, size=(frequency.size, 5))
    waves = np.sin(2 * np.pi * frequency[None, :, None] * time / 4 + phase[None])
    mixing = generator.normal(size=(DIMENSION, frequency.size))
    clean = np.einsum("ij,tjb->tib", mixing, waves + 0.5 * waves[:, ::-1] ** 2)
    noise = generator.normal(size=clean.shape) * clean.std(axis=(0, 2))[:, None]
    return clean + 0.01 * noise


@pytest.fixture(scope="session")
def reservoir():
    return make_reservoir(150, DIMENSION, 8, 0.1, np.random.default_rng(3))

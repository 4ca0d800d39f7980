"""Named streams of random numbers: one root seed, and every stream derived from it by name.

A stream depends on nothing but the root seed and its own name, so that adding a Reynolds number, a
reservoir size or a seed changes no other result.
"""

import hashlib
import operator

import numpy as np


def seed_sequence(root_seed: int, *names: str | int) -> np.random.SeedSequence:
    """Seed sequence of a stream, named from the general to the particular: ``"noise", 3``."""
    if root_seed < 0:
        raise ValueError(f"the root seed must not be negative, not {root_seed}")
    if not names:
        raise ValueError("a random stream needs a name")
    # repr keeps 1 and "1" apart, and the separator cannot occur in it unescaped; whole numbers of
    # NumPy, whose repr is another one, count as what they are
    parts = [repr(name if isinstance(name, str) else operator.index(name)) for name in names]
    digest = hashlib.sha256("\x1f".join(parts).encode()).digest()
    key = [int.from_bytes(digest[start : start + 4], "little") for start in range(0, 32, 4)]
    return np.random.SeedSequence(root_seed, spawn_key=key)


def stream(root_seed: int, *names: str | int) -> np.random.Generator:
    """Generator of the stream called ``names`` under ``root_seed`` (see `seed_sequence`).

    Examples
    --------
    >>> bool(stream(2022, "noise", 3).normal() == stream(2022, "noise", 3).normal())
    True
    """
    return np.random.Generator(np.random.PCG64(seed_sequence(root_seed, *names)))

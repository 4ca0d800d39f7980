"""What jobs ask a scheduler for: memory and time. They are bounds, doubled at each retry."""

import math
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal

from burstcast.base.names import parsed

Level = Literal["short", "usual", "long", "training"]
"""Work of seconds (tables, figures), of minutes, of an hour, and of networks: its memory and time
grow with the square of the neurons, for the Gram matrix of the states, of all series or of each."""

_MIB = 500
_MINUTES = {"short": 2, "usual": 10, "long": 120, "training": 10}
_MATRICES = 16
_MINUTES_OF_1000_NEURONS = 10.0


def resources_of(work: Level) -> dict[str, Callable[..., int]]:
    """Resources of a rule, as functions of a job's wildcards and of the number of its attempt."""

    def memory(wildcards: Any, attempt: int) -> int:
        return memory_mib(work, _neurons(wildcards)) << (attempt - 1)

    def runtime(wildcards: Any, attempt: int) -> int:
        return minutes(work, _neurons(wildcards)) << (attempt - 1)

    return {"mem_mb": memory, "runtime": runtime}


def memory_mib(work: Level, neurons: int) -> int:
    """Memory of a job in MiB."""
    return _MIB + (math.ceil(_MATRICES * _matrix_mib(neurons)) if work == "training" else 0)


def minutes(work: Level, neurons: int) -> int:
    """Time of a job in minutes."""
    more = _MINUTES_OF_1000_NEURONS * (neurons / 1000) ** 2 if work == "training" else 0
    return _MINUTES[work] + math.ceil(more)


def _matrix_mib(neurons: int) -> float:
    return 8 * neurons**2 / 2**20


def _neurons(wildcards: Mapping[str, str]) -> int:
    names = dict(wildcards.items())
    return parsed(names.get("forecaster") or names.get("reservoir") or "none").neurons or 0


def beyond_memory(neurons: Iterable[int | None], machine_mib: float | None = None) -> str:
    """Why this machine cannot train the largest network, in words; empty if it may.

    It is a bound, no prediction: the Gram matrix alone does not fit. Of other machines, only their
    scheduler knows the memory.
    """
    if machine_mib is None:
        machine_mib = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**20
    most = max(filter(None, neurons), default=0)
    if _matrix_mib(most) <= machine_mib:
        return ""
    return (
        f"a network of {most} neurons cannot be trained on this machine: the Gram matrix of its "
        f"states takes {_matrix_mib(most) / 1024:.1f} GiB, and there are {machine_mib / 1024:.1f} "
        f"GiB of memory. Take fewer neurons (campaign.forecasters.esn.neurons), or a cluster "
        f"(docs/cluster.md)"
    )

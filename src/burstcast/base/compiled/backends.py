"""Implementations of the reservoir's dynamics, and the one that works on this machine.

The compiled one needs llvmlite, which does not exist for every platform; scipy is everywhere, and
several times slower.
"""

import warnings
from functools import cache
from typing import Literal

Backend = Literal["compiled", "scipy"]


@cache
def compiler_problem() -> str:
    """Reason why nothing can be compiled on this machine; empty if compilation works."""
    try:
        import llvmlite.binding  # noqa: F401 - loading it is the test
    except Exception as error:  # a library that does not fit the machine raises whatever it likes
        return f"{type(error).__name__}: {error}"
    return ""


def usable_backend(wanted: Backend) -> Backend:
    """Wanted implementation, or, with a warning, the one that runs everywhere."""
    if wanted == "compiled" and (problem := compiler_problem()):
        warnings.warn(
            f"reservoirs are computed by scipy, which is several times slower: nothing can be "
            f"compiled here ({problem}); results agree to rounding error",
            RuntimeWarning,
            stacklevel=2,
        )
        return "scipy"
    return wanted

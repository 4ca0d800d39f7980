"""Classes found by the module that they lie in, so that a new one needs no registration.

The only place of the library that imports modules by name: whatever is found this way must be named
wherever the code that a result depends on is listed.
"""

import difflib
import importlib
import inspect
import pkgutil
from collections.abc import Iterable
from types import ModuleType
from typing import TypeVar

Base = TypeVar("Base")


def module_names(package: ModuleType) -> list[str]:
    """Names of the modules of a package, without the package's own, sorted."""
    return sorted(module.name for module in pkgutil.iter_modules(package.__path__))


def concrete_classes(package: ModuleType, name: str, base: type[Base]) -> list[type[Base]]:
    """Concrete subclasses that a module of a package itself defines (not those it imports).

    A class whose name begins with an underscore is the module's own and is not found.

    Parameters
    ----------
    package
        The package.
    name
        Of a module of it (`module_names`).
    base
        Abstract class that they are subclasses of.
    """
    module = importlib.import_module(f"{package.__name__}.{name}")
    return [
        candidate
        for candidate in vars(module).values()
        if inspect.isclass(candidate)
        and issubclass(candidate, base)
        and candidate.__module__ == module.__name__
        and not inspect.isabstract(candidate)
        and not candidate.__name__.startswith("_")
    ]


def suggestion(name: str, candidates: Iterable[str]) -> str:
    """End of an error message: what an unknown name may have meant; empty if nothing is near."""
    closest = difflib.get_close_matches(str(name), list(candidates), n=1)
    return f" (did you mean {closest[0]!r}?)" if closest else ""

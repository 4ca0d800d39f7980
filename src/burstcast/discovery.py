"""Classes found by the module that they lie in, so that a new one needs no registration.

The only place of the library that imports modules by name: whatever is found this way must be named
wherever the code that a result depends on is listed.
"""

import dataclasses
import difflib
import importlib
import importlib.util
import inspect
import math
import numbers
import os
import pkgutil
import traceback
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import TypeVar

Base = TypeVar("Base")


def module_names(package: ModuleType) -> list[str]:
    """Names of the modules of a package, without the package's own and private ones, sorted."""
    return list(_module_names(*package.__path__))


@cache
def _module_names(*directories: str) -> tuple[str, ...]:
    """Names in a package's directories, which do not change while a process goes on."""
    names = (module.name for module in pkgutil.iter_modules(directories))
    return tuple(sorted(name for name in names if not name.startswith("_")))


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
    module = imported(f"{package.__name__}.{name}")
    return [found for found in classes_in(module, base) if not inspect.isabstract(found)]


def classes_in(module: ModuleType, base: type[Base]) -> list[type[Base]]:
    """Subclasses, abstract ones too, that a module itself defines, without its own ``_Classes``."""
    return [
        candidate
        for candidate in vars(module).values()
        if inspect.isclass(candidate)
        and issubclass(candidate, base)
        and candidate.__module__ == module.__name__
        and not candidate.__name__.startswith("_")
    ]


def imported(name: str) -> ModuleType:
    """Import a module by its name.

    Raises
    ------
    ValueError
        If there is no such module, or it has a mistake: the message says which, and where.
    """
    try:
        return importlib.import_module(name)
    except Exception as error:  # whatever the module's code raises
        if isinstance(error, ModuleNotFoundError) and f"{name}.".startswith(f"{error.name}."):
            where = "here or among what is installed" if error.name == name.split(".")[0] else ""
            raise ValueError(f"there is no module {error.name} {where}".rstrip()) from None
        raise ValueError(
            f"the module {name} cannot be imported: {_place(error)}{type(error).__name__}: "
            f"{getattr(error, 'msg', error)}"
        ) from error


def _place(error: Exception) -> str:
    """Where a module's mistake is: "flows.py, line 3: "."""
    if isinstance(error, SyntaxError):
        return f"{error.filename}, line {error.lineno}: "
    frames = traceback.extract_tb(error.__traceback__)
    # the module's own line, not that of a library which it calls
    libraries = (os.path.dirname(os.__file__), "<frozen ")
    files = [
        frame
        for frame in frames
        if not frame.filename.startswith(libraries) and "site-packages" not in frame.filename
    ]
    return f"{files[-1].filename}, line {files[-1].lineno}: " if len(files) > 1 else ""


def module_file(module: str) -> Path | None:
    """File that Python runs when it imports a module, which need not have been imported.

    None if there is no such module, or it has no file (built-in modules, namespace packages).
    """
    first, *rest = module.split(".")
    try:
        spec = importlib.util.find_spec(first)
    except (ImportError, ValueError):
        return None
    name, directories = first, list((spec and spec.submodule_search_locations) or [])
    for part in rest:
        name = f"{name}.{part}"
        found = [_spec_in(directory, name) for directory in directories]
        spec = next((one for one in found if one is not None and one.loader is not None), None)
        places = found if spec is None else [spec]
        directories = [
            place for one in places for place in (one and one.submodule_search_locations) or []
        ]
    return Path(spec.origin).absolute() if spec and spec.has_location and spec.origin else None


def _spec_in(directory: str, module: str) -> ModuleSpec | None:
    """Specification of a module in a directory of its package."""
    importer = pkgutil.get_importer(directory)
    return importer.find_spec(module) if importer is not None else None


def suggestion(name: str, candidates: Iterable[str]) -> str:
    """End of an error message: what an unknown name may have meant; empty if nothing is near."""
    closest = difflib.get_close_matches(str(name), list(candidates), n=1)
    return f" (did you mean {closest[0]!r}?)" if closest else ""


def checked_numbers(
    what: str, part: str, owner: type, values: Mapping[str, float]
) -> dict[str, float]:
    """Check the numbers that an object of a dataclass is made of; return them as floats.

    Parameters
    ----------
    what
        What is made, for messages: "system 'mfe'".
    part
        What its fields are called there: "parameter".
    owner
        The class.
    values
        By the names of its fields; those with a default may be left out.

    Raises
    ------
    ValueError
        If a field is unknown or missing, or a value is not a finite number.
    TypeError
        If the class is no dataclass.
    """
    if not dataclasses.is_dataclass(owner):
        raise TypeError(f"{owner.__name__} must be a dataclass of its {part}s")
    fields = [field for field in dataclasses.fields(owner) if field.init]
    known = [field.name for field in fields]
    for key in values:
        if key not in known:
            raise ValueError(
                f"{what} has no {part} {key!r}{suggestion(key, known)}; "
                f"its {part}s are {', '.join(known) or 'none'}"
            )
    for field in fields:
        optional = (
            field.default is not dataclasses.MISSING
            or field.default_factory is not dataclasses.MISSING
        )
        if not optional and field.name not in values:
            raise ValueError(f"{what} needs the {part} {field.name!r}")
    for key, value in values.items():
        is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
        if not is_number or not math.isfinite(value):
            raise ValueError(f"{part} {key!r} of {what} must be a finite number, not {value!r}")
    return {key: float(value) for key, value in values.items()}

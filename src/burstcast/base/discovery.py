"""Classes found by the module that they lie in, so that a new one needs no registration.

The only place of the library that imports modules by name.
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
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType, NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

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
    """Concrete subclasses that a module of a package itself defines, without ``_Classes``."""
    module = imported(f"{package.__name__}.{name}")
    return [
        candidate for candidate in classes_in(module, base) if not inspect.isabstract(candidate)
    ]


def classes_in(module: ModuleType, base: type[Base]) -> list[type[Base]]:
    """Subclasses, abstract ones too, that a module itself defines, without its own ``_Classes``."""
    return list(_classes_in(module, base))  # type: ignore[arg-type]


@cache
def _classes_in(module: ModuleType, base: type) -> tuple[Any, ...]:
    return tuple(
        candidate
        for candidate in vars(module).values()
        if inspect.isclass(candidate)
        and issubclass(candidate, base)
        and candidate.__module__ == module.__name__
        and not candidate.__name__.startswith("_")
    )


class UnsoundError(ValueError):
    """A class that does not keep to its interface; ``problems`` has one message for each."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        super().__init__("; ".join(problems))


def own_class(name: str, base: type[Base], noun: str) -> type[Base]:
    """Find a class of a user's module by name, ``my_flows.kuramoto:KuramotoSivashinsky``.

    ``noun``: What such classes are called in messages: "system".
    """
    module_name, _, class_name = name.partition(":")
    module = imported(module_name)
    candidate = getattr(module, class_name, None)
    place = f"{module_name} ({getattr(module, '__file__', None) or 'a namespace package'})"
    if candidate is None:
        names = [member.__name__ for member in classes_in(module, base)]
        raise ValueError(
            f"the module {place} has no class {class_name}{suggestion(class_name, names)}; "
            f"its {noun}s are {', '.join(names) or 'none'}"
        )
    if not (inspect.isclass(candidate) and issubclass(candidate, base)):
        raise ValueError(
            f"{class_name} of {place} is no {noun}: it must be a subclass of "
            f"{base.__module__}.{base.__qualname__}"
        )
    if inspect.isabstract(candidate):
        raise ValueError(unfinished(candidate))
    return candidate


def unfinished(candidate: type) -> str:
    """Message about a class that lacks methods of its interface."""
    methods = ", ".join(sorted(getattr(candidate, "__abstractmethods__", ())))
    return f"the class {candidate.__name__} of {candidate.__module__} lacks {methods}"


def module_of(name: str, package: ModuleType) -> str:
    """Full name of a module: of a package's own ``name``, or of one's own ``module:Class``."""
    module, colon, _ = name.partition(":")
    return module if colon else f"{package.__name__}.{name}"


def imported(name: str) -> ModuleType:
    """Import a module by its name."""
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


def imported_file(file: Path) -> ModuleType:
    """Import a file that lies in no package."""
    spec = importlib.util.spec_from_file_location(f"burstcast_file_{file.stem}", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _place(error: Exception) -> str:
    """Place of a module's mistake, for messages: "flows.py, line 3: "."""
    if isinstance(error, SyntaxError):
        return f"{error.filename}, line {error.lineno}: "
    frames = traceback.extract_tb(error.__traceback__)
    # the module's own line, not a line of a library which it calls
    libraries = (os.path.dirname(os.__file__), "<frozen ")
    files = [
        frame
        for frame in frames
        if not frame.filename.startswith(libraries) and "site-packages" not in frame.filename
    ]
    return f"{files[-1].filename}, line {files[-1].lineno}: " if len(files) > 1 else ""


def suggestion(name: str, candidates: Iterable[str]) -> str:
    """End of an error message with the nearest known name; empty if none is near."""
    closest = difflib.get_close_matches(str(name), list(candidates), n=1)
    return f" (did you mean {closest[0]!r}?)" if closest else ""


def made(noun: str, name: str, part: str, owner: type[Base], values: Mapping[str, Any]) -> Base:
    """Make an object of a class from checked values of its fields (`checked_values`).

    ``noun``, ``part``: What it and its fields are called in messages: "system", "parameter".
    """
    checked = checked_values(f"{noun} {name!r}", part, owner, values)
    try:
        return owner(**checked)
    except (ValueError, ArithmeticError):
        raise
    except Exception as error:  # a mistake in the class
        text = f"the {noun} {name} cannot be made: {type(error).__name__}: {error}"
        raise ValueError(text) from error


def checked_values(what: str, part: str, owner: type, values: Mapping[str, Any]) -> dict[str, Any]:
    """Check the values of the fields of a dataclass; numbers become floats, sequences tuples.

    Fields are numbers, or annotated as ``bool``, ``int``, ``str``, a ``Literal``, ``tuple[float,
    ...]``, ``tuple[str, ...]`` or one of these ``| None``; fields with ``fitted`` in their metadata
    take no value.
    """
    if not dataclasses.is_dataclass(owner):
        raise TypeError(f"{owner.__name__} must be a dataclass of its {part}s")
    fields = {
        field.name: field
        for field in dataclasses.fields(owner)
        if field.init and not field.metadata.get("fitted")
    }
    for key in values:
        if key not in fields:
            raise ValueError(
                f"{what} has no {part} {key!r}{suggestion(key, fields)}; "
                f"its {part}s are {', '.join(fields) or 'none'}"
            )
    for field in fields.values():
        optional = (
            field.default is not dataclasses.MISSING
            or field.default_factory is not dataclasses.MISSING
        )
        if not optional and field.name not in values:
            raise ValueError(f"{what} needs the {part} {field.name!r}")
    types = {name: field.type for name, field in fields.items()}
    if any(isinstance(types[key], str) for key in values):  # annotations that are not evaluated
        types = get_type_hints(owner)
    return {
        key: _checked(value, types[key], f"{part} {key!r} of {what}")
        for key, value in values.items()
    }


def _checked(value: Any, expected: Any, what: str) -> Any:
    """A value of the type of a field."""
    if get_origin(expected) in (UnionType, Union):
        if value is None and NoneType in get_args(expected):
            return None
        expected = next(kind for kind in get_args(expected) if kind is not NoneType)
    if get_origin(expected) is Literal:
        if value not in get_args(expected):
            allowed = " or ".join(map(str, get_args(expected)))
            raise ValueError(f"{what} must be {allowed}, not {value!r}")
        return value
    if expected in (bool, str):
        if not isinstance(value, expected):
            kind = "true or false" if expected is bool else "a text"
            raise ValueError(f"{what} must be {kind}, not {value!r}")
        return value
    if get_origin(expected) is tuple:
        kind = get_args(expected)[0]
        if not isinstance(value, Sequence) or isinstance(value, str):
            words = "texts" if kind is str else "numbers"
            raise ValueError(f"{what} must be a list of {words}, not {value!r}")
        return tuple(_checked(entry, kind, f"an entry of {what}") for entry in value)
    is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value):
        raise ValueError(f"{what} must be a finite number, not {value!r}")
    if expected is int:
        if value != int(value):
            raise ValueError(f"{what} must be a whole number, not {value!r}")
        return int(value)
    return float(value)

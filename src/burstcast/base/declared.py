"""Where values come from: declared by the defaults of arguments, and by fields of settings.

A figure or a table is a function whose arguments declare what it is given::

    def draw(*, bins: pd.DataFrame = read("case/tables/reliability.csv"), neurons: int = at("...")):

Classes of settings have fields of the same kind (`burstcast_workflow.harness.settings`).
"""

import functools
import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

_RAISE = object()
Result = TypeVar("Result")


def at(path: str, *, otherwise: Any = _RAISE, make: Callable[[Any], Any] | None = None) -> Any:
    """Declare a setting: an argument of a function, or a field of a class of settings.

    ``path``: Where its value stands in the config. ``case.`` stands for the job's case,
    ``forecaster.options`` for the section of its kind of forecaster; ``job.`` and ``shown.`` for
    properties of the job and of what figures show. ``otherwise``: The value where the setting does
    not concern a job. ``make``: Makes the value that is used.
    """
    return Setting(path, otherwise, make)


def read(place: str, variables: str = "") -> Any:
    """Declare an input: a DataFrame of a table, or a mapping of a NetCDF or JSON file.

    ``place``: The directory and the name of the file there: ``case`` is the directory of the case,
    ``example`` of the example network, others are properties of
    `burstcast_workflow.campaign.shown.Shown`. ``<file>.nc:<variable>`` is one variable,
    ``<file>.json:<key>`` one value, ``<file>.nc:path`` the path of the file. ``variables``: Names
    of variables of a NetCDF file that are read, by default all; one with an asterisk is optional.
    """
    return File(place, variables)


def gathered(place: str, variables: str = "") -> Any:
    """Declare an input: a file of each forecaster, or of each run of control, of a case."""
    return File(place, variables, of_each=True)


def made_by(function: Callable[..., Any]) -> Any:
    """Declare what a function makes of arguments that it declares itself."""
    return Made(function)


@dataclass(frozen=True)
class Setting:
    """A setting (`at`)."""

    path: str
    otherwise: Any
    make: Callable[[Any], Any] | None

    def __str__(self) -> str:
        """Its name in messages: the path in the config, or in the section of a case."""
        return self.path.removeprefix("case.")

    def __get__(self, settings: Any, _: type) -> Any:
        return self if settings is None else self.value(settings.value_of)

    def __set__(self, _: Any, value: Any) -> None:
        raise AttributeError(f"{self} is a setting: a job does not change it")

    def value(self, value_of: Callable[[str], Any]) -> Any:
        """Its value, by a function of paths."""
        try:
            value = value_of(self.path)
        except KeyError:
            if self.otherwise is _RAISE:
                raise
            return self.otherwise
        return self.make(value) if self.make else value


@dataclass(frozen=True)
class File:
    """An input (`read`, `gathered`)."""

    place: str
    variables: str
    of_each: bool = False  #: whether it is `gathered`

    @property
    def path(self) -> str:
        """Directory and name of the file."""
        return self.place.partition(":")[0]

    @property
    def part(self) -> str:
        """The part that is read: one variable or value, its ``path``, or all of it (empty)."""
        return self.place.partition(":")[2]


@dataclass(frozen=True)
class Made:
    """What a function makes (`made_by`)."""

    function: Callable[..., Any]


def declaring(function: Callable[..., Result]) -> Callable[..., Result]:
    """A function whose declared arguments must all be given: no marker passes for a value."""

    @functools.wraps(function)
    def checked(**arguments: Any) -> Result:
        if lacking := [name for name, _ in _declarations(function) if name not in arguments]:
            raise TypeError(f"{function.__module__} is called without {', '.join(lacking)}")
        return function(**arguments)

    return checked


def _declarations(function: Callable[..., Any]) -> Iterator[tuple[str, Setting | File | Made]]:
    for name, argument in inspect.signature(function).parameters.items():
        if isinstance(argument.default, Setting | File | Made):
            yield name, argument.default


def _inputs(function: Callable[..., Any]) -> Iterator[tuple[str, Setting | File]]:
    """Declared arguments of a function, and of what makes them."""
    for name, declared in _declarations(function):
        if isinstance(declared, Made):
            yield from _inputs(declared.function)
        else:
            yield name, declared


def files_of(function: Callable[..., Any]) -> dict[str, File]:
    """Files that a function declares, by the name of the argument."""
    return {name: file for name, file in _inputs(function) if isinstance(file, File)}


def paths_of(function: Callable[..., Any]) -> list[str]:
    """Paths of the settings that a function declares."""
    settings = (setting for _, setting in _inputs(function) if isinstance(setting, Setting))
    return [*dict.fromkeys(setting.path for setting in settings)]


def called(
    function: Callable[..., Result],
    value_of: Callable[[str], Any],
    content_of: Callable[[str, File], Any],
    **others: Any,
) -> Result:
    """Call a function with what it declares, and with other arguments as they are.

    ``value_of``: Values of settings, by their paths. ``content_of``: Contents of files, by the name
    of the argument and its declaration.
    """
    values = dict(others)
    for name, declared in _declarations(function):
        match declared:
            case Setting():
                values[name] = declared.value(value_of)
            case File():
                values[name] = content_of(name, declared)
            case Made():
                values[name] = called(declared.function, value_of, content_of)
    return function(**values)

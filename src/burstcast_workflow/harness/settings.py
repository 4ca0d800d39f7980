"""The settings of a job: fields of a class that its script declares, each with a name and a type.

A script's function takes ``settings: Scan``, and that class says what the script reads::

    class Horizons(JobSettings):
        washout: Washout
        tolerance: float = at("horizon.tolerance")
        event_threshold: float = computed("event_threshold.event_threshold")

A field is a setting, a value that another job computes, or a part: settings that several jobs
share, with what follows from them (`burstcast_workflow.jobs`). The rule names the settings,
``settings("horizon.tolerance", ...)``, and has the files of computed values as inputs;
`burstcast_workflow.stages.stages.Stages.complete` compares both with the class when the rules are
read.
"""

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar

from burstcast.base.declared import Setting, at
from burstcast_workflow.harness.storage import read_json

__all__ = ["JobSettings", "at", "computed"]

Provenance = dict[str, str]
OfJob = TypeVar("OfJob", bound="JobSettings")


@dataclass(frozen=True)
class Computed:
    """A value that another job computes (`computed`)."""

    path: str

    @property
    def file(self) -> str:
        """Name of the rule's input that has it."""
        return self.path.partition(".")[0]

    def __get__(self, settings: Any, _: type) -> Any:
        return self if settings is None else settings.computed_value(self.path)

    def __set__(self, _: Any, value: Any) -> None:
        raise AttributeError(f"{self.path} is computed by another job: a job does not change it")


def computed(path: str) -> Any:
    """Declare a field whose value another job computes: ``<input of the rule>.<key in its JSON>``.

    The input is read for the field, and is no argument of the script's function.
    """
    return Computed(path)


class UndeclaredSettingError(KeyError):
    """A script reads what is no setting of its job, so that nothing would track it."""

    def __str__(self) -> str:
        return str(self.args[0])


def _wildcard(name: str) -> Any:
    return property(lambda settings: settings.identity[name])


@dataclass(frozen=True)
class _Given:
    """Values, wildcards and files of a job, of which all parts of its settings read."""

    declared: Mapping[str, Any]
    identity: Mapping[str, Any]
    provenance: Provenance
    files: Mapping[str, str]
    read: set[str]
    content: Callable[[str], Any]


@dataclass(frozen=True)
class Part:
    """A field that is itself settings, of a class of its own."""

    kind: "type[JobSettings]"

    def __get__(self, settings: Any, _: type) -> Any:
        return self if settings is None else settings.part(self.kind)

    def __set__(self, _: Any, value: Any) -> None:
        raise AttributeError(f"{self.kind.__name__} is a part of the settings of a job")


class JobSettings:
    """Settings of a job, and the wildcards that it was called with.

    ``declared``: Values by the paths that the rule names. ``identity``: Rule and wildcards.
    ``provenance``: Origin of the job's outputs, which every NetCDF and JSON file carries.
    ``files``: Paths of the JSON files with computed values, by the names of the rule's inputs.
    """

    rule: str = _wildcard("rule")
    case: str = _wildcard("case")
    forecaster: str = _wildcard("forecaster")
    controller: str = _wildcard("controller")
    reservoir: str = _wildcard("reservoir")
    strategies: str = _wildcard("strategies")
    figure: str = _wildcard("figure")

    def __init__(
        self,
        declared: Mapping[str, Any],
        identity: Mapping[str, Any],
        provenance: Provenance | None = None,
        files: Mapping[str, str] | None = None,
    ) -> None:
        read: set[str] = set()
        self._given = _Given(
            declared, identity, provenance or {}, files or {}, read, cache(read_json)
        )

    def __init_subclass__(cls) -> None:
        annotations = inspect.get_annotations(cls, eval_str=True)
        for name in {*vars(cls), *annotations}:
            if not name.startswith("_") and name in vars(JobSettings):
                raise TypeError(f"{cls.__name__}.{name} has a name of all settings of jobs")
        for name, kind in annotations.items():
            if isinstance(kind, type) and issubclass(kind, JobSettings):
                setattr(cls, name, Part(kind))

    def part(self, kind: "type[OfJob]") -> "OfJob":
        """The same job's settings, as another class reads them."""
        part = object.__new__(kind)
        part._given = self._given
        return part

    @property
    def identity(self) -> Mapping[str, Any]:
        """Rule and wildcards of the job."""
        return self._given.identity

    @property
    def provenance(self) -> Provenance:
        """Origin of the job's outputs."""
        return self._given.provenance

    @classmethod
    def _fields(cls) -> Iterator[Any]:
        by_name = {
            name: field for base in reversed(cls.__mro__) for name, field in vars(base).items()
        }
        for field in by_name.values():
            if isinstance(field, Part):
                yield from field.kind._fields()
            yield field

    @classmethod
    def paths(cls) -> list[str]:
        """Paths of all settings of the class, those of its parts included."""
        fields = cls._fields()
        return [*dict.fromkeys(field.path for field in fields if isinstance(field, Setting))]

    @classmethod
    def files(cls) -> list[str]:
        """Names of the rule's inputs that have computed values of the class."""
        fields = cls._fields()
        return [*dict.fromkeys(field.file for field in fields if isinstance(field, Computed))]

    def computed_value(self, path: str) -> Any:
        """A value that another job has computed (`computed`)."""
        file, _, key = path.partition(".")
        if file not in self._given.files:
            raise UndeclaredSettingError(
                f"{self.identity.get('rule', 'this')} reads {path}, and no input is called {file}"
            )
        return self._given.content(self._given.files[file])[key]

    def value_of(self, path: str) -> Any:
        """Value of a setting by its path, also below a declared one, or of a wildcard."""
        if path in self.identity:
            return self.identity[path]
        parts = path.split(".")
        for count in range(len(parts), 0, -1):
            name = ".".join(parts[:count])
            if name in self._given.declared:
                self._given.read.add(path)
                value = self._given.declared[name]
                for key in parts[count:]:
                    if key not in value:
                        raise UndeclaredSettingError(f"the setting {name} has no {key}")
                    value = value[key]
                return value
        raise UndeclaredSettingError(
            f"{self.identity.get('rule', 'this')} reads the setting {path}, which does not concern "
            f"it; its settings are: {', '.join(sorted(self._given.declared)) or 'none'}"
        )

    def unread(self) -> list[str]:
        """Declared settings, down to their leaves, that have not been read."""
        return [
            leaf
            for path, value in self._given.declared.items()
            for leaf, _ in leaves(value, path)
            if not any(covers(read, leaf) for read in self._given.read)
        ]


def covers(declared: str, path: str) -> bool:
    """Whether a declared path is a setting's, or one that it lies below."""
    return path == declared or path.startswith(f"{declared}.")


def undeclared(declared: Iterable[str], read: Iterable[str]) -> list[str]:
    """Paths that are read and that no declared one covers."""
    declared = [*declared]
    return [path for path in read if not any(covers(each, path) for each in declared)]


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """All settings below a path, with their values."""
    if isinstance(value, Mapping) and value:
        for key, below in value.items():
            yield from leaves(below, f"{path}.{key}".removeprefix("."))
    else:
        yield path, value


def names(*fields: object) -> str:
    """Names of settings in messages, of fields as their class has them: ``Scan.grid``."""
    return ", ".join(map(str, fields))


@contextmanager
def concerning(*fields: object) -> Iterator[None]:
    """Put the names of the affected settings before the message of the library."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{names(*fields)}: {error}") from error

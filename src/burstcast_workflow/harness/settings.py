"""The settings of a job: fields of a class that its script declares, each with a name and a type.

A script's function takes ``settings: Scan``, and that class says what the script reads::

    class Scan(Search):
        grid: int = at("search.grid")

The parameters of the rule are made from it. What several jobs share is a base in
`burstcast_workflow.jobs`, with what follows from its settings.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from burstcast.base.declared import Setting, at
from burstcast_workflow.harness.storage import read_json

__all__ = ["JobSettings", "at"]

Provenance = dict[str, str]


class UndeclaredSettingError(KeyError):
    """A script reads what is no setting of its job, so that nothing would track it."""

    def __str__(self) -> str:
        return str(self.args[0])


def _wildcard(name: str) -> Any:
    return property(lambda settings: settings.identity[name])


class JobSettings:
    """Settings of a job, and the wildcards that it was called with.

    ``declared``: Values by the paths that the rule declares. ``identity``: Rule and wildcards.
    ``provenance``: Origin of the job's outputs, which every NetCDF and JSON file carries.
    ``computed_exponent``: Lyapunov exponent that sets the unit of time; None where the config knows
    it.
    """

    rule: str = _wildcard("rule")
    case: str = _wildcard("case")
    forecaster: str = _wildcard("forecaster")
    controller: str = _wildcard("controller")
    reservoir: str = _wildcard("reservoir")
    strategy: str = _wildcard("strategy")
    strategies: str = _wildcard("strategies")
    figure: str = _wildcard("figure")

    def __init__(
        self,
        declared: Mapping[str, Any],
        identity: Mapping[str, Any],
        provenance: Provenance | None = None,
        computed_exponent: float | None = None,
    ) -> None:
        self._declared, self.identity = declared, identity
        self.provenance, self.computed_exponent = provenance or {}, computed_exponent
        self._read: set[str] = set()

    def __init_subclass__(cls) -> None:
        members: dict[str, str] = {}
        for base in cls.__mro__[:-1]:
            for name, value in vars(base).items():
                if not name.startswith("__") and members.setdefault(name, str(value)) != str(value):
                    raise TypeError(f"{cls.__name__} has the name {name} twice, or of a wildcard")

    @classmethod
    def paths(cls) -> list[str]:
        """Paths of all settings of the class."""
        fields = [field for base in cls.__mro__ for field in vars(base).values()]
        return [*dict.fromkeys(field.path for field in fields if isinstance(field, Setting))]

    def value_of(self, path: str) -> Any:
        """Value of a setting by its path, also below a declared one, or of a wildcard."""
        if path in self.identity:
            return self.identity[path]
        parts = path.split(".")
        for count in range(len(parts), 0, -1):
            name = ".".join(parts[:count])
            if name in self._declared:
                self._read.add(path)
                value = self._declared[name]
                for part in parts[count:]:
                    value = value[part]
                return value
        raise UndeclaredSettingError(
            f"{self.identity.get('rule', 'this')} reads the setting {path}, which does not concern "
            f"it; its settings are: {', '.join(sorted(self._declared)) or 'none'}"
        )

    def unread(self) -> list[str]:
        """Declared settings, down to their leaves, that have not been read."""
        return [
            leaf
            for path, value in self._declared.items()
            for leaf, _ in leaves(value, path)
            if not any(leaf == read or leaf.startswith(f"{read}.") for read in self._read)
        ]


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


THRESHOLDS = "event_thresholds"
"""Input of jobs whose config gives event thresholds as quantiles: files of their values."""

TIME_UNIT = "time_unit"
"""Input of jobs whose unit of time is computed: file of the Lyapunov exponents."""


def exponent_in(time_unit: str) -> float | None:
    """Leading exponent in a file of computed ones; None without a file."""
    return read_json(time_unit)["leading"]["mean"] if time_unit else None


def with_thresholds(settings: Any, value_of: Callable[[str], Any]) -> Any:
    """Copy settings with values of event thresholds, where the config gives quantiles.

    The config of a job has the quantile and its case; the value is known when the training series
    are. Scripts are given the value.
    """
    if isinstance(settings, Mapping):
        if settings.keys() == {"quantile", "case"}:
            return value_of(settings["case"])
        return {key: with_thresholds(value, value_of) for key, value in settings.items()}
    if isinstance(settings, list):
        return [with_thresholds(value, value_of) for value in settings]
    return settings


def cases_of_thresholds(settings: Any) -> list[str]:
    """Cases whose event thresholds some settings have as quantiles."""
    cases: dict[str, None] = {}
    with_thresholds(settings, cases.setdefault)
    return list(cases)

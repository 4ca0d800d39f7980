"""The settings of a job, by the names that they have in the config."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from burstcast_workflow.harness.storage import read_json

Provenance = dict[str, str]


class UndeclaredSettingError(KeyError):
    """A script reads what its rule does not declare, so that nothing would track it."""

    def __str__(self) -> str:
        return str(self.args[0])


class Settings(Mapping[str, Any]):
    """Settings of a job by their path in the config: ``settings["search.grid"]``.

    A rule declares the paths that its script reads; a path below a declared one may be read, too
    (``case.training.noise`` where ``case.training`` is declared). ``case.`` stands for the job's
    case, ``forecaster.options`` for the section of its kind of forecaster. The wildcards of the job
    are there by their names.

    ``provenance``: Origin of the job's outputs, which every NetCDF and JSON file carries.
    ``computed_exponent``: Lyapunov exponent that sets the unit of time; None where the config knows
    it.
    """

    def __init__(
        self,
        declared: Mapping[str, Any],
        identity: Mapping[str, Any],
        provenance: Provenance | None = None,
        computed_exponent: float | None = None,
    ) -> None:
        self._declared, self._identity = declared, identity
        self.provenance, self.computed_exponent = provenance or {}, computed_exponent
        self._read: set[str] = set()

    def __getitem__(self, path: str) -> Any:
        if path in self._identity:
            return self._identity[path]
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
            f"{self._identity.get('rule', 'this')} reads the setting {path}, which its rule does "
            f"not declare; it declares: {', '.join(sorted(self._declared)) or 'none'}"
        )

    def __iter__(self) -> Iterator[str]:
        return iter(self._declared)

    def __len__(self) -> int:
        return len(self._declared)

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


VALIDATION = "recycle_validation.intervals_per_series, search.interval_lt, washout_lt"
CLASSIFICATION = "classification.longest_prediction_time_lt, classification.window_lt, washout_lt"
HORIZON = "horizon.longest_lead_time_lt, washout_lt"
LONG_RUNS = "statistics.duration, statistics.fixed_point_interval_lt"


@contextmanager
def concerning(settings: str) -> Iterator[None]:
    """Put the affected settings before the message of the library."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{settings}: {error}") from error


THRESHOLDS = "event_thresholds"
"""Input of jobs whose config gives event thresholds as quantiles: files of their values."""

TIME_UNIT = "time_unit"
"""Input of jobs whose unit of time is computed: file of the Lyapunov exponents."""


def exponent_in(time_unit: str) -> float | None:
    """Leading exponent in a file of computed ones; None without a file."""
    return read_json(time_unit)["leading"]["mean"] if time_unit else None


def with_thresholds(settings: Any, value_of: Callable[[str], Any], name: str = "") -> Any:
    """Copy settings with values of event thresholds, where the config gives quantiles.

    The config of a job has the quantile and its case; the value is known when the training series
    are. Scripts are given the value.
    """
    if isinstance(settings, Mapping):
        if name.endswith("event_threshold"):
            return value_of(settings["case"])
        return {key: with_thresholds(value, value_of, key) for key, value in settings.items()}
    if isinstance(settings, list):
        return [with_thresholds(value, value_of, name) for value in settings]
    return settings


def cases_of_thresholds(settings: Any) -> list[str]:
    """Cases whose event thresholds some settings have as quantiles."""
    cases: dict[str, None] = {}
    with_thresholds(settings, cases.setdefault)
    return list(cases)

"""The settings of a job, by the names that they have in the config."""

from collections.abc import Iterator, Mapping
from typing import Any


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

    Parameters
    ----------
    declared
        Values by path, as the rule passes them.
    identity
        Rule and wildcards of the job.
    """

    def __init__(self, declared: Mapping[str, Any], identity: Mapping[str, Any]) -> None:
        self._declared, self._identity = declared, identity
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
            f"{self._identity['rule']} reads the setting {path}, which its rule does not declare; "
            f"it declares: {', '.join(sorted(self._declared)) or 'none'}"
        )

    def __iter__(self) -> Iterator[str]:
        return iter(self._declared)

    def __len__(self) -> int:
        return len(self._declared)

    def unread(self) -> list[str]:
        """Declared settings, down to their leaves, that nobody has read so far."""
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

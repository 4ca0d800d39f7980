"""The call of a script's function: settings and files, of what Snakemake gives a job.

All of this is code of every job (`burstcast_workflow.tracking.code`): an edit runs all jobs again.
"""

import platform
import re
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from burstcast_workflow.harness.canonical import canonical_json
from burstcast_workflow.harness.settings import JobSettings, Provenance
from burstcast_workflow.tracking.environment import LIBRARIES, library_version


class Call:
    """A script's function with its arguments.

    ``settings``: Values by path. ``code``: Hashes of the code by name. ``identity``: Rule and
    wildcards. ``file``: File of the script as it runs.
    """

    def __init__(self, function: Callable[..., None], snakemake: Any) -> None:
        self._function, self.file = function, Path(function.__code__.co_filename)
        self.settings: dict[str, Any] = snakemake.params.settings
        self.code: dict[str, str] = snakemake.params.code
        (script,) = filter(is_script, self.code)
        # one script makes many tables: there, the rule names the table's maker
        rule = snakemake.params.get("maker") or Path(script).stem
        self.identity = job_identity(rule, snakemake.wildcards)
        self._files = {**dict(snakemake.input.items()), **dict(snakemake.output.items())}

    def __call__(self) -> list[str]:
        """Call the function; return the settings that it has not read."""
        kind = settings_taken(self._function)
        computed = {name: self._files[name] for name in kind.files()}
        files = {name: file for name, file in self._files.items() if name not in computed}
        settings = kind(
            self.settings, self.identity, provenance(self.identity, self.settings), computed
        )
        self._function(**files, settings=settings)
        return settings.unread()


def settings_taken(function: Callable[..., None]) -> type[JobSettings]:
    """Class of the settings that a script's function takes."""
    taken: type[JobSettings] = function.__annotations__.get("settings", JobSettings)
    return taken


def is_script(name: str) -> bool:
    """Whether a name of code is a script's: no module's, and no file's that a module reads."""
    return name.endswith(".py") and ":" not in name


def provenance(identity: Mapping[str, Any], settings: Mapping[str, Any]) -> Provenance:
    """Provenance of an output: package, job, settings, versions; no time, machine or path.

    All libraries that change results are there: which of them a job imports depends on its
    settings, and llvmlite is imported late.
    """
    record = {
        "source": f"burstcast {version('burstcast')}",
        "rule": identity["rule"],
        "identity": canonical_json(dict(identity)),
        "settings": canonical_json(dict(settings)),
        "python": platform.python_version(),
    }
    return {**record, **{library: library_version(library) for library in LIBRARIES}}


def job_identity(rule: str, wildcards: Mapping[str, str]) -> dict[str, Any]:
    """Rule and wildcards of a job, numbers as numbers."""
    named = identifying(wildcards).items()
    return {"rule": rule, **{name: _value(text) for name, text in named}}


def identifying(wildcards: Mapping[str, str]) -> dict[str, str]:
    """Wildcards without the family of a forecaster, which follows from its name."""
    return {name: text for name, text in wildcards.items() if name != "family"}


def _value(text: str) -> str | int | float:
    if not re.fullmatch(r"\d+(\.\d+)?", text):
        return text
    number = float(text)
    return int(number) if number.is_integer() else number

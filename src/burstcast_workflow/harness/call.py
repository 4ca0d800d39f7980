"""The call of a script's function: settings and files, of what Snakemake gives a job.

All of this is code of every job (`burstcast_workflow.tracking.code`): an edit runs all jobs again.
"""

import json
import platform
import re
from collections.abc import Callable, Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from burstcast_workflow.harness.canonical import canonical_json
from burstcast_workflow.harness.settings import (
    THRESHOLDS,
    TIME_UNIT,
    JobSettings,
    Provenance,
    exponent_in,
    with_thresholds,
)
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.tracking.environment import LIBRARIES, library_version


class Call:
    """A script's function with its arguments.

    ``declared``: Settings by path. ``code``: Entries of code. ``identity``: Rule and wildcards.
    ``file``: File of the script as it runs.
    """

    def __init__(self, function: Callable[..., None], snakemake: Any) -> None:
        self._function, self.file = function, Path(function.__code__.co_filename)
        self.declared, self.code = parameters(snakemake.params)
        (script,) = [entry.partition(" @")[0] for entry in self.code if is_script(entry)]
        # one script makes many tables: there, the rule names the table's maker
        rule = snakemake.params.get("maker") or Path(script).stem
        self.identity = job_identity(rule, snakemake.wildcards)
        self._files = {**dict(snakemake.input.items()), **dict(snakemake.output.items())}

    def __call__(self) -> list[str]:
        """Call the function; return the declared settings that it has not read."""
        files = dict(self._files)
        records = map(read_json, files.pop(THRESHOLDS, []))
        thresholds = {record["case"]: record["event_threshold"] for record in records}
        values = with_thresholds(self.declared, thresholds.__getitem__)
        exponent = exponent_in(files.pop(TIME_UNIT, ""))
        settings = settings_taken(self._function)(
            values, self.identity, provenance(self.identity, self.declared), exponent
        )
        self._function(**files, settings=settings)
        return settings.unread()


def settings_taken(function: Callable[..., None]) -> type[JobSettings]:
    """Class of the settings that a script's function takes."""
    taken: type[JobSettings] = function.__annotations__.get("settings", JobSettings)
    return taken


def parameters(params: Iterable[Any]) -> tuple[dict[str, Any], list[str]]:
    """Settings by path, and entries of code, of a job's parameters (`Stages.of_script`)."""
    texts = [text for text in params if isinstance(text, str)]
    code = [text for text in texts if re.fullmatch(r"(file:.+|[^=]+) @[0-9a-f]+", text)]
    pairs = (text.partition(" = ") for text in texts if text not in code)
    settings = {path: json.loads(value) for path, equals, value in pairs if equals}
    return dict(sorted(settings.items())), sorted(code)


def is_script(entry: str) -> bool:
    """Whether an entry of code is a script, and no file that a module reads."""
    return ".py @" in entry and not entry.startswith("file:")


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

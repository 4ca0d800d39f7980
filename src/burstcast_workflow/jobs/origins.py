"""Origins of files: the jobs that wrote them."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from burstcast.base.files.netcdf import read_attributes
from burstcast.base.names import ForecasterName, parsed
from burstcast_workflow.harness.storage import read_json


@dataclass(frozen=True)
class Origin:
    """A file, and the job that wrote it."""

    path: str
    identity: Mapping[str, Any]  #: rule and wildcards of the job

    @property
    def name(self) -> ForecasterName:
        """Name of the job's forecaster or controller."""
        return parsed(self.identity.get("forecaster") or self.identity["controller"])


def origins(paths: Iterable[str | Path]) -> list[Origin]:
    """Origins of files, in their order."""
    by_identity: dict[str, Origin] = {}
    for path in map(str, paths):
        is_json = path.endswith(".json")
        provenance = read_json(path).get("provenance", {}) if is_json else read_attributes(path)
        identity = provenance.get("identity")
        if not isinstance(identity, str):
            raise ValueError(f"{path} does not say which job wrote it: remove it, and run again")
        if identity in by_identity:
            raise ValueError(
                f"{path} and {by_identity[identity].path} are both of the job {identity}"
            )
        by_identity[identity] = Origin(path, json.loads(identity))
    return list(by_identity.values())

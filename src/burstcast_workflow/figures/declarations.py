"""What figures declare, as plain data: planning needs no Matplotlib, which is slow to load.

Declarations are read off the modules of `burstcast.figures`, and remembered beside Snakemake's
records by the contents of all modules of the project: as soon as one of them has changed, they are
read again.
"""

import hashlib
import json
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from burstcast.base.declared import File
from burstcast.base.files.atomic_files import atomic
from burstcast_workflow.project import PACKAGES, packages_of, project_root

if TYPE_CHECKING:
    from burstcast.figures.registry import Drawn

_MEMORY = Path(".snakemake") / "burstcast_figures.json"


@dataclass(frozen=True)
class Declaration:
    """What a figure declares: see `burstcast.figures.registry.Drawn`."""

    section: str
    position: int
    cases: str
    only_flows: bool
    needs_networks: bool
    files: dict[str, File]
    paths: list[str]
    published: bool
    always_published: bool
    caption: str  #: in reStructuredText, on one line

    @classmethod
    def of(cls, figure: "Drawn", caption: str) -> "Declaration":
        """What a figure declares."""
        names = [field.name for field in fields(cls) if field.name != "caption"]
        return cls(**{name: getattr(figure, name) for name in names}, caption=caption)


class Memory(NamedTuple):
    """Declarations by the name of the figure, in their order, and the code that they are of."""

    code: str
    figures: dict[str, Declaration]


def remembered() -> Memory:
    """What is remembered of the code as it is; no figures if that is nothing."""
    code = _digest()
    with suppress(OSError, ValueError, LookupError, TypeError):
        record = json.loads(_MEMORY.read_bytes())
        if record["code"] == code:
            return Memory(code, {name: _read(each) for name, each in record["figures"].items()})
    return Memory(code, {})


def _read(record: Mapping[str, Any]) -> Declaration:
    files = {name: File(**file) for name, file in record["files"].items()}
    return Declaration(**{**record, "files": files})


def keep(code: str, figures: Mapping[str, Declaration]) -> None:
    """Remember declarations for the processes of jobs, and for the next run.

    ``code``: Of `remembered`, before the declarations were read: if it has changed since, they may
    be of either.
    """
    if code == _digest():
        record = {"code": code, "figures": {name: asdict(each) for name, each in figures.items()}}
        with suppress(OSError):
            _MEMORY.parent.mkdir(exist_ok=True)
            with atomic(_MEMORY) as partial:
                partial.write_text(json.dumps(record))


def _digest() -> str:
    """Digest of what declarations follow from: modules, declarations of tables, Python's version.

    The directory of sources counts, too, so that no other copy of the project is believed.
    """
    root = project_root()
    sources = packages_of(root)
    files = [file for package in PACKAGES for file in sorted((sources / package).rglob("*.py"))]
    digest = hashlib.sha256(f"{sys.version}\n{sources}".encode())
    for file in [root / "workflow" / "tables.yaml", *files]:
        content = file.read_bytes()
        digest.update(f"\n{file} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()

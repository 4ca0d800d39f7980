"""Declaration of a workflow's directories and packages."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from snaketrust.modules import UnlikeCodeError, module_file


@dataclass(frozen=True, eq=False)
class Project:
    """The code of a workflow."""

    #: Its own directory: modules beside its Snakefile are not a user's own.
    root: Path
    #: Directory of its scripts.
    scripts: Path
    #: Directory of its packages, which scripts import.
    sources: Path
    #: Names of these packages. Others in the same directory count, too, unless it is one of
    #: installed libraries.
    packages: tuple[str, ...]
    #: Modules that no fingerprint has, or packages of such modules, each with the module that
    #: stands for it: one that holds a version, raised by hand. This is for code that all jobs run,
    #: such as what writes files.
    stand_ins: Mapping[str, str] = field(default_factory=dict)
    #: Revision of the sources, which records repeat for people. It makes no job run again.
    revision: str = ""
    #: Whether tests of the project keep out what fingerprints cannot see. Docstrings, texts of
    #: errors and of the log, and what packages offer late then count nothing; otherwise all but
    #: comments and formatting counts, and code that cannot be seen is refused.
    checked: bool = False

    def files(self) -> list[Path]:
        """All modules of the packages, sorted."""
        return sorted(
            path for name in self.packages for path in self.sources.glob(f"{name}/**/*.py")
        )

    def name_of(self, path: Path) -> str:
        """Name of the module in a file of `files`."""
        parts = path.relative_to(self.sources).with_suffix("").parts
        return ".".join(parts).removesuffix(".__init__")

    def stand_in(self, module: str) -> str:
        """The module that stands for a module: mostly itself."""
        for left_out, version in self.stand_ins.items():
            if f"{module}.".startswith(f"{left_out}."):
                return version
        return module

    def check_imports(self) -> None:
        """Check that Python imports the packages from the sources that fingerprints are taken of.

        `UnlikeCodeError` if it is another copy: this one would be recorded, and the other one run.
        """
        for package in self.packages:
            path = module_file(package)
            place = path.parent.parent.resolve() if path else "nowhere"
            if place != self.sources.resolve():
                raise UnlikeCodeError(
                    f"this workflow lies beside the sources in {self.sources}, but Python imports "
                    f"{package} from {place}, another copy: install this one, or set PYTHONPATH to "
                    f"{self.sources}"
                )

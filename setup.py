"""What pyproject.toml cannot say: a wheel has the workflow's files inside burstcast_workflow."""

import os
import shutil
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).parent
FILES = (
    *("Snakefile", "config.yaml", "workflow", "resources", "profiles"),
    *("requirements.lock", "CITATION.cff"),
)


class BuildWithWorkflow(build_py):
    """Copies the workflow's files beside the modules, and notes the revision that they are of."""

    def run(self):
        """Build; an editable installation uses the files where they are."""
        super().run()
        if not self.editable_mode:
            self.copy_workflow(Path(self.build_lib) / "burstcast_workflow" / "project")

    def copy_workflow(self, target):
        """Copy all files into a directory, which is made anew."""
        shutil.rmtree(target, ignore_errors=True)
        target.mkdir(parents=True)
        for name in FILES:
            source = ROOT / name
            if source.is_dir():
                without = shutil.ignore_patterns("__pycache__", ".*")
                shutil.copytree(source, target / name, ignore=without)
            else:
                shutil.copy2(source, target / name)
        if revision := os.environ.get("BURSTCAST_REVISION") or self.revision():
            (target / "revision.txt").write_text(f"{revision}\n", encoding="utf-8")

    def revision(self):
        """Git revision of these sources; None where they are not in a repository."""
        if not (ROOT / ".git").exists():
            return None
        # nothing is installed yet: modules are those of the sources
        sys.path.insert(0, str(ROOT / "src"))
        from burstcast_workflow.project import git_revision

        return git_revision(ROOT)


setup(cmdclass={"build_py": BuildWithWorkflow})

"""Print which modules of the project scripts load when Python imports them, and some modules.

The harness is replaced by something empty: what it loads is not what a result depends on.
"""

import json
import os
import runpy
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType

HARNESS = "burstcast_workflow.harness"
REGISTRIES = (
    *("systems", "forecasters", "tuning/strategies"),
    *("control/strategies", "tables/makers"),
)


def _take_anything(*_: object, **__: object) -> None:
    pass


class EmptyHarness(MetaPathFinder, Loader):
    """Finds modules of the harness that have every name, with nothing behind it."""

    def find_spec(self, name: str, *_: object) -> ModuleSpec | None:
        ours = name == HARNESS or name.startswith(f"{HARNESS}.")
        return ModuleSpec(name, self, is_package=name == HARNESS) if ours else None

    def exec_module(self, module: ModuleType) -> None:
        # a class, or what decorates a function
        module.__dict__["__getattr__"] = lambda name: type(name, (), {"__init__": _take_anything})


def loaded(load: Callable[[], object]) -> list[str]:
    """Modules that something loads, found in a fork so that scripts do not see each other's."""
    read, write = os.pipe()
    if os.fork() == 0:
        os.close(read)
        sys.meta_path.insert(0, EmptyHarness())
        load()
        names = [name for name in sys.modules if name.partition(".")[0].startswith("burstcast")]
        with open(write, "w") as stream:
            json.dump(names, stream)
        os._exit(0)
    os.close(write)
    with open(read) as stream:
        return json.load(stream)


def of_script(script: Path) -> list[str]:
    def load() -> None:
        sys.path.insert(0, str(script.parent))
        runpy.run_path(str(script), run_name="not a job")

    return loaded(load)


if __name__ == "__main__":
    scripts, library = Path("workflow/scripts").resolve(), Path("src/burstcast")
    found = {
        str(script.relative_to(scripts)): of_script(script)
        for script in sorted(scripts.rglob("*.py"))
    }
    modules = [
        ".".join(path.relative_to("src").with_suffix("").parts)
        for package in REGISTRIES
        for path in sorted((library / package).glob("*.py"))
        if path.name != "__init__.py"
    ]
    found.update({name: loaded(lambda name=name: import_module(name)) for name in modules})
    print(json.dumps(found))

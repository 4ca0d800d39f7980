"""Print which modules of the project each script loads when Python imports it."""

import json
import os
import runpy
import sys
from pathlib import Path


def loaded(script: Path) -> list[str]:
    """Modules that a script loads, found in a fork so that scripts do not see each other's."""
    read, write = os.pipe()
    if os.fork() == 0:
        os.close(read)
        sys.path.insert(0, str(script.parent))
        runpy.run_path(str(script), run_name="not a job")
        names = [name for name in sys.modules if name.partition(".")[0].startswith("burstcast")]
        with open(write, "w") as stream:
            json.dump(names, stream)
        os._exit(0)
    os.close(write)
    with open(read) as stream:
        return json.load(stream)


if __name__ == "__main__":
    scripts = sorted(Path("workflow/scripts").resolve().glob("*.py"))
    print(json.dumps({script.stem: loaded(script) for script in scripts}))

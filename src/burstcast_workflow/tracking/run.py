"""The run that a results directory belongs to: what was planned, whether it still is the newest.

``.run.json`` in the results has the config, so that results can be opened, and jobs of a cluster
have the settings of their plan. Jobs know their run by an environment variable: jobs that a killed
run has left behind write nothing once another run has begun.
"""

import json
import os
import secrets
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from burstcast_workflow.tracking.environment import numpy_blas

VARIABLE = "BURSTCAST_RUN"
"""Environment variable that tells jobs their run: its token, and the results directory."""

CLAIM = ".run.json"
_METADATA = Path(".snakemake") / "metadata"
_RUNS = Path(".snakemake") / "burstcast_runs.json"


class OvertakenError(RuntimeError):
    """A newer run has begun in the results directory."""


def begin(
    results: str,
    config: Mapping[str, Any],
    code: Sequence[str],
    directories: Sequence[str],
    revision: str,
) -> None:
    """Make this process's run the one that the results directory belongs to.

    ``directories``: Of a user's own modules. ``revision``: Of the sources.
    """
    token = secrets.token_hex(8)
    _write(
        Path(results) / CLAIM,
        {
            "token": token,
            "revision": revision,
            "linear algebra": numpy_blas(),
            "config": config,
            "code": code,
            "directories": directories,
        },
    )
    _write(_RUNS, {**_tokens(), os.path.normpath(results): token})
    os.environ[VARIABLE] = f"{token} {results}"


def _write(path: Path, record: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(f".{secrets.token_hex(4)}")
    partial.write_text(json.dumps(record, indent=1))
    os.replace(partial, path)


def is_known(results: str) -> bool:
    """Whether Snakemake knows from this directory what the results, if any, were made with.

    It does not where its metadata are gone, or another directory was the last to make them: it
    would believe them.
    """
    files = (path for path in Path(results).rglob("*") if path.is_file())
    if not any(path.name != CLAIM and path.suffix != ".log" for path in files):
        return True
    token = _tokens().get(os.path.normpath(results))
    return token is not None and _claim(results).get("token") == token and any(_METADATA.glob("*"))


def plan() -> dict[str, Any]:
    """What the run that this process's job belongs to has planned."""
    token, _, results = os.environ.get(VARIABLE, "").partition(" ")
    if not token:
        raise OvertakenError(
            f"the environment variable {VARIABLE} does not reach jobs: let the executor pass on "
            f"the environment; a workflow that has burstcast as a module calls its onstart"
        )
    claim = _claim(results)
    if claim.get("token") != token:
        raise OvertakenError(f"{results} belongs to a newer run: nothing is written for this one")
    return claim


def check_ownership() -> None:
    """Check that no newer run has begun in the results directory of this process's run, if any."""
    if VARIABLE in os.environ:
        plan()


def _claim(results: str) -> dict[str, Any]:
    return _read(Path(results) / CLAIM)


def _tokens() -> dict[str, Any]:
    return _read(_RUNS)


def _read(path: Path) -> dict[str, Any]:
    try:
        record = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return {}
    return record if isinstance(record, dict) else {}

"""The run that a results directory belongs to: what was planned, whether it still is the newest.

``.run.json`` in the results has the config, so that results can be opened, and jobs of a cluster
have the settings of their plan. An environment variable tells jobs their run, so that jobs that a
killed run has left behind write nothing once another run has begun; where it does not reach them,
they belong to the newest run.
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


class OvertakenError(RuntimeError):
    """A newer run has begun in the results directory."""


def begin(
    results: str,
    config: Mapping[str, Any],
    code: Mapping[str, str],
    directories: Sequence[str],
    revision: str,
) -> None:
    """Make this process's run the one that the results directory belongs to.

    ``code``: Hashes of all code that jobs run, whole, by name. ``directories``: Of a user's own
    modules. ``revision``: Of the sources.
    """
    token = secrets.token_hex(8)
    claim = {
        "token": token,
        "revision": revision,
        "linear algebra": numpy_blas(),
        "config": config,
        "code": code,
        "directories": directories,
    }
    path = Path(results) / CLAIM
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(f".{secrets.token_hex(4)}")
    partial.write_text(json.dumps(claim, indent=1))
    os.replace(partial, path)
    os.environ[VARIABLE] = f"{token} {results}"


def plan(results: str = "") -> dict[str, Any]:
    """What the run that this process's job belongs to has planned, and its ``results`` directory.

    ``results``: Where that is, unless the environment says it.
    """
    token, _, said = os.environ.get(VARIABLE, "").partition(" ")
    results = said or results
    claim = _claim(results)
    if not claim and not token:
        raise OvertakenError(
            f"{Path(results) / CLAIM}, which a run writes, is not there: run snakemake in the "
            f"directory of the campaign, or let the executor pass on the environment variable "
            f"{VARIABLE}"
        )
    if token and claim.get("token") != token:
        raise OvertakenError(f"{results} belongs to a newer run: nothing is written for this one")
    return {**claim, "results": results}


def check_ownership() -> None:
    """Check that no newer run has begun in the results directory of this process's run, if any."""
    if VARIABLE in os.environ:
        plan()


def _claim(results: str) -> dict[str, Any]:
    try:
        record = json.loads((Path(results) / CLAIM).read_bytes())
    except (OSError, ValueError):
        return {}
    return record if isinstance(record, dict) else {}

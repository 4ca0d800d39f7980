"""Runs of control for tables: the variables of their files, and their key columns."""

from typing import Any

from burstcast.control.records import COSTS, RECORDS
from burstcast.control.setting_names import as_columns
from burstcast.tables.makers.registry import Gathered

FLOWS = " ".join([*RECORDS, *(f"{name}*" for name in COSTS)])
"""Variables of the files of runs that `burstcast.control.records.FlowSample.of` takes."""


def conditions_of(run: Gathered) -> dict[str, Any]:
    """Conditions of a run: all of its plan but the settings of its strategy."""
    return {name: value for name, value in run.plan.items() if name != "settings"}


def keys_of(run: Gathered, noise: float) -> dict[str, Any]:
    """Key columns of a run: its controller, settings and conditions.

    ``noise`` is the case's; the noise of a plan replaces it. Equations are given none.
    """
    settings = as_columns(run.plan["settings"])
    return {**run.name.keys, "noise": noise, **settings, **conditions_of(run)}

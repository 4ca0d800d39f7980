"""Forecasts of all members of ensembles as files."""

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np

from burstcast.forecast.windows import WindowSummaries
from burstcast.forecasters.base import Forecaster
from burstcast.netcdf import Variable
from burstcast.probability.members import EnsembleForecaster, has_members
from burstcast.units import OBSERVABLE
from burstcast_workflow.harness.storage import write_netcdf


def with_members(forecaster: Forecaster) -> EnsembleForecaster:
    """Take a forecaster for one that tells an ensemble.

    Raises
    ------
    TypeError
        If its kind has none.
    """
    if not has_members(type(forecaster)):
        raise TypeError(f"{type(forecaster).__name__} has no ensemble")
    return cast(EnsembleForecaster, forecaster)


def write_member_forecasts(
    path: str, members: Sequence[WindowSummaries], name: str, provenance: Mapping[str, str]
) -> None:
    """Write forecasts of the observable of that name by all members, reduced to windows."""
    dimensions = ("member", "point", "window")
    write_netcdf(
        path,
        {
            "first": Variable(
                dimensions,
                np.stack([one.first for one in members]),
                OBSERVABLE,
                f"forecast {name} at the first step of each window",
            ),
            "largest": Variable(
                dimensions,
                np.stack([one.largest for one in members]),
                OBSERVABLE,
                f"largest forecast {name} in a window",
            ),
        },
        provenance,
    )

"""Series with schedules of the parameters in force, which some kinds of forecasters learn from."""

from collections.abc import Sequence

from burstcast.base.files.netcdf import read_attributes, read_netcdf
from burstcast.data.scheduled_series import TrainingSet
from burstcast_workflow.jobs.gather import origins


def read_scheduled(paths: Sequence[str], case: str) -> TrainingSet:
    """Read the scheduled series of several cases, for a forecaster of one (`TrainingSet`)."""
    parts = [read_netcdf(path, "state", "observed", "parameter") for path in paths]
    free = [
        number
        for number, origin in enumerate(origins(paths))
        if origin.identity["case"] == case and not int(read_attributes(origin.path)["actuated"])
    ]
    return TrainingSet.of_parts(parts, free[0] if free else None)

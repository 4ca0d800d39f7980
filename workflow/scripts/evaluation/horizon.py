"""Measure how long before each extreme event a forecaster predicts it."""

from burstcast.forecast.horizon import prediction_horizons
from burstcast.netcdf import Variable, read_netcdf
from burstcast.units import LYAPUNOV_TIMES, NUMBER
from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster, seen
from burstcast_workflow.jobs.horizons import horizon_search
from burstcast_workflow.jobs.systems import system_of


@job
def measure_horizons(
    *,
    forecaster: str,
    events: str,
    summary: str,
    time_unit: str | list[str],
    horizon: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the prediction horizon of every event."""
    data = read_netcdf(events)
    who = read_forecaster(forecaster, settings, time_unit)
    horizons = prediction_horizons(
        who,
        system_of(settings).observable,
        seen(who, data["observed"], data["true_state"]),
        data["truth"],
        horizon_search(settings, time_unit, read_json(summary)["mean_observable"]),
    )
    write_netcdf(
        horizon,
        {
            "series": Variable(("event",), data["series"], NUMBER, "row among the kept series"),
            "step": Variable(("event",), data["step"], NUMBER, "step at which the event begins"),
            "prediction_horizon_lt": Variable(
                ("event",),
                horizons,
                LYAPUNOV_TIMES,
                "prediction horizon of the event",
            ),
        },
        provenance,
    )

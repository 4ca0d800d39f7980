"""Test whether washouts of the test series are like those of the training series."""

import numpy as np

from burstcast.base.files.netcdf import Variable, read_netcdf
from burstcast.base.files.units import NUMBER
from burstcast.event_forecaster.consistency import (
    ConsistencyTest,
    hindcast_errors,
    starts_from_half,
)
from burstcast_workflow.harness.job import JobSettings, at, job, tell, write_netcdf
from burstcast_workflow.jobs.forecasters import Observing


class Consistency(JobSettings):
    """The test of one forecaster."""

    observing: Observing
    calibration_series: int = at("probability.calibration_series")


@job
def compare_washouts(
    *,
    ensemble: str,
    forecaster: str,
    calibration_set: str,
    evaluation_set: str,
    consistency: str,
    settings: Consistency,
) -> None:
    """Write the p-value of each washout of the evaluation set; NaN where there is no test.

    Hindcasts are of the calibration set, by forecasters that have not learnt from it.
    """
    observing, forecasting = settings.observing, settings.observing.forecasting
    model = forecasting.read_forecaster(forecaster)
    known = read_netcdf(calibration_set, "washout", "series")
    test: ConsistencyTest | None = None
    if settings.calibration_series and starts_from_half(model, known["washout"]):
        test = ConsistencyTest.of(hindcast_errors(model, known["washout"]))
    elif not settings.calibration_series:
        training = observing.learnt_rows(model, ensemble)
        case = forecasting.forecasting_case(ensemble)
        test = ConsistencyTest.left_out(model, training, case, known["washout"], known["series"])
    washouts = read_netcdf(evaluation_set, "washout")["washout"]
    if test is None:
        tell("there is no test of consistency: washouts are too short, or valid hindcasts too few")
        p_values = np.full(len(washouts), np.nan)
    else:
        p_values = test.p_values(model, washouts)
    meaning = "share of the hindcasts that are at least as odd as the washout of the point"
    variables = {"p_value": Variable(("point",), p_values, NUMBER, meaning)}
    write_netcdf(consistency, variables, settings.provenance)

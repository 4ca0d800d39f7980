"""Train a classifier of events; give probabilities at the points of test and of calibration."""

import numpy as np

from burstcast.base.files.netcdf import variables_of
from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasts.probabilities import EventProbabilities, out_of_sample_probabilities
from burstcast_workflow.harness.job import JobSettings, at, concerning, job, write_netcdf
from burstcast_workflow.jobs.forecasters import Forecasting, write_forecaster
from burstcast_workflow.jobs.forecasts import ScoredForecasts


class Classifying(JobSettings):
    """A classifier of events."""

    forecasting: Forecasting
    scored: ScoredForecasts
    calibration_series: int = at("probability.calibration_series")


@job
def event_probabilities(
    *,
    training_set: str,
    evaluation_set: str,
    calibration_set: str,
    forecaster: str,
    forecast: str,
    calibration_forecast: str,
    settings: Classifying,
) -> None:
    """Learn from the training set; what was learnt from is forecast out of sample."""
    forecasting, scored = settings.forecasting, settings.scored
    times, threshold = scored.prediction_times_lt, scored.event_threshold
    classifier, case = forecasting.unfitted(), forecasting.forecasting_case()
    assert isinstance(classifier, EventClassifier)
    steps, points = forecasting.clock.lyapunov_time, scored.points(training_set)
    schedules = points.exogenous_features(times, steps)
    learnt = points.labelled(times, threshold, schedules)
    with concerning(f"case {settings.case}"):
        learnt.check(times)
    fitted = classifier.fit(learnt, case)
    test = scored.points(evaluation_set)
    kept = scored.points(calibration_set)
    # an actuation of the test series alone is not known to what has learnt without one
    test_schedules = None if schedules is None else test.exogenous_features(times, steps)
    kept_schedules = None if schedules is None else kept.exogenous_features(times, steps)
    washouts = kept.data["washout"]
    tested = fitted.probabilities(test.data["washout"], test_schedules)
    if settings.calibration_series:
        calibrating = fitted.probabilities(washouts, kept_schedules)
    else:
        calibrating = out_of_sample_probabilities(
            fitted.tuned(), learnt, case, washouts, kept.data["series"], kept_schedules
        )
    write_forecaster(forecaster, fitted, settings.provenance)
    event = np.array(times, dtype=np.float64), np.array([threshold])
    for path, values in ((forecast, tested), (calibration_forecast, calibrating)):
        write_netcdf(path, variables_of(EventProbabilities(values, *event)), settings.provenance)

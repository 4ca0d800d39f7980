"""Forecasters that tests make up."""

from burstcast.forecasters.base import Forecaster


class MadeUpForecaster(Forecaster):
    """Forecaster that is neither fitted nor kept in files: only its forecasts matter."""

    @classmethod
    def fit(cls, training, case, parameters=None):
        raise NotImplementedError

    def record(self):
        raise NotImplementedError

    @classmethod
    def restore(cls, record, case):
        raise NotImplementedError

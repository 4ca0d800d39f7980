"""Parameter factors of kinds that know the parameters, fitted to series or read from a record."""

from burstcast.base.arrays import FloatArray
from burstcast.forecasters._options import AwareOptions
from burstcast.forecasters._parameter_factors import ParameterFactors
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.systems.parameters import Parameters


def given(parameters: Parameters | None) -> Parameters:
    """Parameters of a case, which must have some."""
    if parameters is None:
        raise ValueError("a forecaster that knows the parameters needs a case that has some")
    return parameters


def fitted_factors(
    schedules: FloatArray, parameters: Parameters | None, options: AwareOptions
) -> ParameterFactors:
    """Factors scaled by the inputs of training series; at least one parameter must vary.

    ``schedules``: ``(series, time - 1, parameters)``; without parameters where the case's own
    values are in force throughout.
    """
    names = given(parameters).names
    degree = options.parameter_degree
    factors = None
    if schedules.size:
        factors = ParameterFactors.of(names, schedules, options.transform, degree)
    if factors is None or factors.count == 0:
        raise ValueError(
            f"{', '.join(names)} does not vary in training, so that nothing can be learnt of it: "
            f"train on series under several values, or take a kind that is not aware"
        )
    return factors


def recorded_factors(factors: ParameterFactors) -> ForecasterRecord:
    """Record of factors."""
    return ForecasterRecord(
        {"parameter_low": factors.low, "parameter_high": factors.high},
        {"transform": factors.transform, "parameter_degree": factors.degree},
    )


def restored_factors(record: ForecasterRecord, case: ForecastingCase) -> ParameterFactors:
    """Factors from a forecaster's record."""
    return ParameterFactors(
        given(case.parameters).names,
        record.arrays["parameter_low"],
        record.arrays["parameter_high"],
        str(record.attributes["transform"]),
        int(record.attributes["parameter_degree"]),
    )

"""Parameter factors of kinds that know the parameters, fitted to series or read from a record."""

from burstcast.base.arrays import FloatArray
from burstcast.forecasters._options import AwareOptions
from burstcast.forecasters._parameter_factors import ParameterFactors
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.systems.parameters import Parameters


def parameters_of(case: ForecastingCase) -> Parameters:
    """Parameters of a case, which must have some."""
    if case.parameters is None:
        raise ValueError("a forecaster that knows the parameters needs a case that has some")
    return case.parameters


def fitted_factors(
    schedules: FloatArray | None, case: ForecastingCase, options: AwareOptions
) -> ParameterFactors:
    """Factors scaled by the schedules of training series; at least one parameter must vary.

    ``schedules``: ``(series, time - 1, parameters)``; None: the case's own values throughout.
    """
    parameters = parameters_of(case)
    names = parameters.names
    values = parameters.constant(1, 1)[..., 0] if schedules is None else schedules
    factors = ParameterFactors.of(names, values, options.transform, options.parameter_degree)
    if factors.count == 0:
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
        parameters_of(case).names,
        record.arrays["parameter_low"],
        record.arrays["parameter_high"],
        str(record.attributes["transform"]),
        int(record.attributes["parameter_degree"]),
    )

"""A job's network, trained with given hyperparameters."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast import durations
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.training import TrainingSeries, train
from burstcast.forecasters.esn import NetworkForecaster
from burstcast_workflow.jobs.time_unit import lyapunov_time
from burstcast_workflow.jobs.training import reservoir_seed

Settings = Mapping[str, Any]


def candidate(
    settings: Settings,
    time_unit: str | Sequence[str],
    series: TrainingSeries,
    point: Mapping[str, Any],
    divergence_bound: float | None,
) -> NetworkForecaster:
    """A job's network, trained on all of its series with the hyperparameters of a point.

    Parameters
    ----------
    settings
        Of the job: of its reservoir, time and the washout.
    time_unit
        The job's input of that name.
    series
        Training series.
    point
        spectral_radius, input_scaling and tikhonov.
    divergence_bound
        Of its forecasts; None where it makes none.
    """
    seed = reservoir_seed(settings, settings["forecaster"])
    dynamics = Dynamics(
        seed.reservoir(series.observed.shape[2]),
        point["spectral_radius"],
        point["input_scaling"],
        settings["forecasters.esn.backend"],
    )
    readout = train(
        dynamics,
        series,
        washout=durations.steps(settings["washout_lt"], lyapunov_time(settings, time_unit)),
        tikhonov=point["tikhonov"],
    )
    network = EchoStateNetwork(dynamics, readout, series.input_range)
    return NetworkForecaster(network, seed, divergence_bound)

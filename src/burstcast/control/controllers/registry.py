"""Controllers by name: the sources of alarms in a run of control.

The module ``burstcast.control.controllers.<name>`` has a function ``monitor`` with the arguments of
`controlling_monitor` after the name. A new controller is one new module.
"""

from collections.abc import Sequence

import burstcast.control.controllers
from burstcast.control.experiment import ControlExperiment
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.encoded import EncodedMonitor
from burstcast.control.strategies.base import ControlStrategy
from burstcast.discovery import imported
from burstcast.encoders.channels import EncodedFlow
from burstcast.forecasters.base import Forecaster


def controlling_monitor(
    name: str,
    strategy: ControlStrategy,
    experiment: ControlExperiment,
    forecasters: Sequence[Forecaster],
    alarm_rate: float = 0.0,
    seed: int = 0,
) -> Monitor:
    """Make the monitor of a controller.

    Parameters
    ----------
    name
        Module of `burstcast.control.controllers`: "forecaster", "committee", "random".
    strategy, experiment
        Strategy of control, and the flows that it controls.
    forecasters
        One; several in a committee of networks; none for controllers without a forecaster.
    alarm_rate
        Share of looks at which random alarms are raised.
    seed
        Name of the stream of random alarms.

    Raises
    ------
    TypeError
        If a committee is to control by a strategy without votes.
    """
    module = imported(f"{burstcast.control.controllers.__name__}.{name}")
    monitor: Monitor = module.monitor(strategy, experiment, forecasters, alarm_rate, seed)
    if isinstance(experiment.sensor, EncodedFlow):
        return EncodedMonitor(monitor, experiment.sensor.encode)
    return monitor

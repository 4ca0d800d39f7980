"""The echo state network that is given true washouts: the error of its present state is gone.

It is the network of the kind `esn`, trained on the same observed series with the same
hyperparameters; only the washouts of its forecasts have no noise. What separates it from the
equations is the error of the network itself, and what separates it from `esn` is the estimate of
the present state: networks and equations have the same two rows (`equations`, `equations_noisy`).
"""

from dataclasses import dataclass
from typing import ClassVar

from burstcast.forecasters.esn import NetworkForecaster


@dataclass(frozen=True)
class NetworkFromTruth(NetworkForecaster):
    """A network of `esn` whose reservoir is driven by true states before each forecast."""

    sees_truth: ClassVar[bool] = True
    searched_as: ClassVar[str] = "esn"

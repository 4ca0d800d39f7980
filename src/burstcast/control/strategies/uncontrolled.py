"""No control: the free flow, which controlled flows are compared with."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import Look, Policy
from burstcast.control.strategies.base import SampledStrategy


@dataclass(frozen=True)
class Uncontrolled(SampledStrategy):
    """Never acts."""

    decision_interval_lt: float = 1.0

    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        """Policy that acts nowhere."""

        def decide(look: Look) -> Any:
            return np.zeros(len(look.rows), dtype=bool)

        return decide

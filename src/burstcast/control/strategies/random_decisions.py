"""Random decisions: the effect of an actuator without information."""

from dataclasses import dataclass
from typing import Any

from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import Policy, at_random
from burstcast.control.strategies.base import SampledStrategy


@dataclass(frozen=True)
class RandomDecisions(SampledStrategy):
    """Acts until the next decision with a given probability, each decision by itself."""

    #: probability of acting: the expected share of the time under actuation
    probability: float

    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        """Act at random: each flow has a stream of its own."""
        looks = self.timing(experiment.schedule).most_looks
        return at_random(self.probability, experiment.draws("random decisions", looks))

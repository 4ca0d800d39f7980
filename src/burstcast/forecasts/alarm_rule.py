"""Rule of alarms: from a forecast to a probability, and from it to an alarm."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.forecasts.alarms import best_threshold
from burstcast.forecasts.calibration import Calibration
from burstcast.forecasts.outcomes import Outcomes

CALIBRATED, VOTES = "calibrated", "votes"
"""What tables call calibrated probabilities, and shares of votes as they are."""


@dataclass(frozen=True)
class AlarmRule:
    """Rule of alarms: a calibration and the alarm threshold."""

    calibration: Calibration  #: function from what is forecast to the probability
    threshold: float

    @classmethod
    def chosen(cls, outcomes: Outcomes, calibration: Calibration) -> Self:
        """Rule with the best threshold for a calibration, by outcomes summed over series."""
        levels = outcomes.at(calibration(outcomes.levels))
        return cls(calibration, best_threshold(levels.levels, levels.points))

    def alarms(self, values: FloatArray) -> BoolArray:
        """Whether an alarm is raised, by what is forecast; never without a calibration."""
        return np.asarray(self.calibration(values) >= self.threshold)

    def record(self) -> dict[str, Any]:
        """Lists and numbers from which `restore` recreates the rule."""
        return {
            "values": self.calibration.values.tolist(),
            "probabilities": self.calibration.probabilities.tolist(),
            "threshold": self.threshold,
        }

    @classmethod
    def restore(cls, record: Mapping[str, Any]) -> Self:
        """Make a rule from its record."""
        calibration = Calibration(np.array(record["values"]), np.array(record["probabilities"]))
        return cls(calibration, record["threshold"])


def rules_of(
    chosen: Mapping[str, Any], alarm: str, prediction_time_lt: float
) -> dict[str, AlarmRule]:
    """Rules of an alarm: by `CALIBRATED` probabilities, and, if it has any, by `VOTES`."""
    records = chosen["alarms"][alarm][f"{prediction_time_lt:g}"]
    return {name: AlarmRule.restore(record) for name, record in records.items()}

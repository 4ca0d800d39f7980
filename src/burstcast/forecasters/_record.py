"""What a fitted forecaster is restored from."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from burstcast.base.arrays import FloatArray


@dataclass(frozen=True)
class ForecasterRecord:
    """Record of a fitted forecaster, from which it is restored."""

    arrays: Mapping[str, FloatArray] = field(default_factory=dict)  #: by name
    #: numbers and texts by name
    attributes: Mapping[str, str | int | float] = field(default_factory=dict)

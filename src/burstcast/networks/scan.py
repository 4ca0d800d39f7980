"""The scan of the search space: validation of one reservoir at all points of a grid."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from burstcast.networks.hyperparameters import HyperparameterPoint, SearchSpace
from burstcast.networks.validation import PointValidator, Validation
from burstcast.networks.validation_strategies.base import ValidationStrategy


@dataclass(frozen=True)
class Evaluation:
    """Validation of one point by one strategy with one Tikhonov parameter."""

    number: int  #: number of the point in the search, from zero
    source: str  #: ``grid`` or ``bayesian``
    #: point, validation: where, and its outcome
    point: HyperparameterPoint
    validation: Validation

    @property
    def objective(self) -> float:
        """Objective that the search minimises."""
        return self.validation.objective

    def record(self) -> dict[str, str | int | float]:
        """The evaluation without errors of single intervals, as a row of a table."""
        leak_rate = self.point.leak_rate
        return {
            "evaluation": self.number,
            "source": self.source,
            "validation": self.validation.strategy,
            "spectral_radius": self.point.spectral_radius,
            "input_scaling": self.point.input_scaling,
            **({} if leak_rate == 1 else {"leak_rate": leak_rate}),
            "tikhonov": self.validation.tikhonov,
            "objective": self.objective,
            "solver": self.validation.solver,
            "reciprocal_condition": self.validation.reciprocal_condition,
        }

    @classmethod
    def restore(cls, record: Mapping[Any, Any], log_errors: tuple[float, ...]) -> Self:
        """Evaluation from its `record` and its errors in each interval."""
        validation = Validation(
            record["validation"],
            record["tikhonov"],
            log_errors,
            record["solver"],
            record["reciprocal_condition"],
        )
        point = HyperparameterPoint(
            record["spectral_radius"], record["input_scaling"], leak_rate_of(record)
        )
        return cls(record["evaluation"], record["source"], point, validation)


def leak_rate_of(record: Mapping[Any, Any]) -> float:
    """Leak rate of a record or a row of a table of them: 1 where it has none."""
    leak_rate = record.get("leak_rate")
    return 1.0 if leak_rate is None or leak_rate != leak_rate else float(leak_rate)


def scan(
    validator: PointValidator,
    space: SearchSpace,
    strategies: Sequence[ValidationStrategy],
    grid: int,
) -> list[Evaluation]:
    """Evaluate all points of a grid; ``strategies`` are validated in one go (`scanned_with`)."""
    return [
        Evaluation(number, "grid", point, validation)
        for number, point in enumerate(space.grid(grid))
        for validation in validator(point, strategies)
    ]

"""Recycle Validation: train on everything, validate in closed loop on the training data."""

from burstcast.networks.validation_strategies.base import (
    Block,
    Fold,
    ValidationPlan,
    ValidationStrategy,
)


class RecycleValidation(ValidationStrategy):
    """Validates on intervals laid end to end in some of the series that it has trained on."""

    name = "RV"
    title = "Recycle Validation"

    def folds(self, plan: ValidationPlan, series: int, length: int) -> list[Fold]:
        """Lay out one fold with all the intervals (see `ValidationStrategy.folds`)."""
        plan.check_intervals(series, length)
        whole = Block(range(series), length)
        return [Fold(trained=(whole,), series=range(plan.series), starts=plan.starts(length))]

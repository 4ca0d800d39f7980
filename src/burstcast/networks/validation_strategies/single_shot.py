"""Single Shot Validation: train on all but the end of the series, validate on the first's end."""

from burstcast.networks.validation_strategies.base import (
    Block,
    Fold,
    ValidationPlan,
    ValidationStrategy,
)


class SingleShotValidation(ValidationStrategy):
    """Validates on the last interval of the first series, which no series is trained on.

    The closed loop of the paper's authors starts one step earlier, from data that were trained on
    (`ValidationPlan.single_shot_lead`).
    """

    name = "SSV"
    title = "Single Shot Validation"

    def folds(self, plan: ValidationPlan, series: int, length: int) -> list[Fold]:
        """Lay out one fold with one interval (see `ValidationStrategy.folds`)."""
        cut = length - plan.interval
        start = cut - plan.single_shot_lead
        if start <= plan.washout:
            raise ValueError(
                f"series of {length} samples leave nothing to train on before the last validation "
                f"interval of {plan.interval} steps"
            )
        return [Fold(trained=(Block(range(series), cut),), series=range(1), starts=(start,))]

"""Walk Forward Validation: intervals laid end to end, each before a network has seen its future.

Source: Racca & Magri, "Robust optimization and validation of echo state networks for learning
chaotic dynamics", Neural Networks 142 (2021), for one long series. The form for an ensemble of
series is ours:

* The intervals are as in Recycle Validation: ``intervals`` of them laid end to end from the end of
  the washout, in each of the first ``series`` training series.
* Each interval is a fold. Its readout is trained on the steps of its own series from the end of
  the washout up to the interval's first step (excluded), and on the whole of all other series, from
  the end of their washouts. The interval, and what follows it in its series, are left out.
* The first interval of a series follows the washout at once: its readout knows the other series
  only. If there is but one series, that readout has nothing to train on, and the first interval is
  left out.
* The objective is the mean over all the intervals, as for the other strategies.

The other series start from other initial conditions, so that they do not tell the future of this
one. Moments of the data are sums over series and steps: a fold costs a merge of moments and a solve
for each Tikhonov parameter, no other open loop. It needs a Gram matrix of its own, which takes
``8 * neurons**2`` bytes.
"""

from burstcast.tuning.strategies.base import Block, Fold, ValidationPlan, ValidationStrategy


class WalkForwardValidation(ValidationStrategy):
    """Validates on each interval a readout that has not seen it, nor what follows it."""

    name = "WFV"
    title = "Walk Forward Validation"

    def folds(self, plan: ValidationPlan, series: int, length: int) -> list[Fold]:
        """Lay out a fold for each interval of each series (see `ValidationStrategy.folds`)."""
        plan.check_intervals(series, length)
        folds = []
        for row in range(plan.series):
            others = [
                *(Block(range(other, other + 1), length) for other in range(plan.series)),
                # series without intervals are summed up together
                Block(range(plan.series, series), length),
            ]
            del others[row]
            others = [block for block in others if len(block.series)]
            for start in plan.starts(length):
                before = Block(range(row, row + 1), start)
                trained = (*others, *([before] if start > plan.washout else []))
                if trained:
                    folds.append(Fold(trained=trained, series=range(row, row + 1), starts=(start,)))
        if not folds:
            raise ValueError("one series with one validation interval leaves nothing to train on")
        return folds

"""Options chosen on training series that a forecaster has not learnt from."""

import itertools
from dataclasses import replace

import numpy as np

HELD_OUT = 2
"""Training series that options are chosen on."""
REACH_LT = 2
"""Length of the forecasts that are compared, in Lyapunov times."""


def with_chosen_options(unfitted, names, training, case, washout_lt):
    """The unfitted forecaster with one value, the best, of each option that has several.

    ``names``: Options that are tuples of values. ``training``: ``(series, time, dimension)``.
    """
    choices = list(itertools.product(*[getattr(unfitted, name) for name in names]))
    if len(choices) == 1:
        return unfitted
    if len(training) <= HELD_OUT:
        raise ValueError(f"choosing options takes more than {HELD_OUT} training series")
    unit = case.steps_per_lyapunov_time
    washout, reach = max(1, int(washout_lt * unit)), REACH_LT * unit
    learnt, series = training[:-HELD_OUT], training[-HELD_OUT:]
    starts = np.arange(washout, series.shape[1] - reach, unit)
    washouts = np.concatenate([series[:, at - washout : at] for at in starts]).transpose(1, 2, 0)
    truth = np.concatenate([series[:, at : at + reach] for at in starts]).transpose(1, 2, 0)
    scale = training.std(axis=(0, 1))[:, np.newaxis]

    @np.errstate(over="ignore", invalid="ignore")
    def error(values):
        model = with_options(unfitted, names, values).fit(learnt, case)
        states, _ = model.advance(model.start(np.ascontiguousarray(washouts)), reach)
        missed = np.sqrt((((states - truth) / scale) ** 2).mean(axis=(0, 1))).mean()
        return missed if np.isfinite(missed) else np.inf

    return with_options(unfitted, names, min(choices, key=error))


def with_options(unfitted, names, values):
    """The unfitted forecaster with one value of each option."""
    return replace(unfitted, **{name: (value,) for name, value in zip(names, values, strict=True)})

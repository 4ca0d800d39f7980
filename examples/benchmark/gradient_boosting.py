"""Gradient-boosted trees of scikit-learn for a case of the benchmark.

::

    python gradient_boosting.py CASE.nc FORECASTS.csv

A classifier for each prediction window: from what is observed now, and was a while ago, to the
probability of an event. It forecasts no trajectories, so that it has no prediction horizon.
"""

import sys

import netCDF4
import numpy as np
from sklearn.ensemble import HistGradientBoostingClassifier
from sklearn.metrics import precision_recall_curve

LAGS = (0, 5, 10, 20)
"""Samples before the starting point whose components are features."""
HELD_OUT = 3
"""Training series that the alarm threshold is chosen on."""


def features(washouts):
    """Features of washouts, ``(points, lags * components)``."""
    return np.concatenate([washouts[:, -1 - lag] for lag in LAGS], axis=1)


def crosses(window, threshold):
    """Whether the observable is below the threshold at first, and reaches it later."""
    return window[0] < threshold <= window.max()


def examples(series, observable, washout, windows, threshold):
    """Features of starting points in training series, and whether an event is in each window."""
    starts = np.arange(washout - 1, series.shape[1] - windows[-1][1], 2)
    found, outcomes = [], []
    for states, values in zip(series, observable, strict=True):
        before = np.stack([values[at - washout + 1 : at + 1] for at in starts])
        quiet = starts[before.max(axis=1) < threshold]
        found.append(features(np.stack([states[at - washout + 1 : at + 1] for at in quiet])))
        for at in quiet:
            ahead = (values[at + first : at + last + 1] for first, last in windows)
            outcomes.append([crosses(one, threshold) for one in ahead])
    return np.concatenate(found), np.array(outcomes)


def classifiers(inputs, outcomes):
    """A classifier for each window."""
    return [
        HistGradientBoostingClassifier(
            max_iter=150,
            learning_rate=0.08,
            max_leaf_nodes=12,
            early_stopping=False,
            random_state=0,
        ).fit(inputs, outcomes[:, column])
        for column in range(outcomes.shape[1])
    ]


def probabilities(found, inputs):
    """Probabilities of an event, ``(points, windows)``."""
    return np.stack([one.predict_proba(inputs)[:, 1] for one in found], axis=1)


def best_threshold(series, observable, *asked):
    """Alarm threshold with the best F-score, over all windows, on series that are held out."""
    learnt = classifiers(*examples(series[:-HELD_OUT], observable[:-HELD_OUT], *asked))
    inputs, outcomes = examples(series[-HELD_OUT:], observable[-HELD_OUT:], *asked)
    told = probabilities(learnt, inputs)
    precision, recall, thresholds = precision_recall_curve(outcomes.ravel(), told.ravel())
    scores = 2 * precision * recall / np.maximum(precision + recall, 1e-9)
    return thresholds[scores[:-1].argmax()]


def main(case_path, path):
    """Write forecasts of a case, and print the alarm threshold to score them with."""
    with netCDF4.Dataset(case_path) as case:
        first_line = f"# case={case.case} case_version={case.case_version} seed={case.seed}"
        names = ("training", "training_observable", "washout", "prediction_time_lt")
        series, observable, washouts, times = (np.asarray(case[name][:]) for name in names)
        ends = (np.asarray(case[f"window_{end}_step"][:]) for end in ("first", "last"))
        windows = list(zip(*ends, strict=True))
        threshold = float(case.event_threshold)
    asked = washouts.shape[1], windows, threshold
    found = probabilities(classifiers(*examples(series, observable, *asked)), features(washouts))
    with open(path, "w", encoding="utf-8") as file:
        print(first_line, "point,prediction_time_lt,probability", sep="\n", file=file)
        for point, row in enumerate(found):
            for time, probability in zip(times, row, strict=True):
                print(f"{point},{time:g},{probability:.6f}", file=file)
    print(f"alarm threshold {best_threshold(series, observable, *asked):.3f}")


if __name__ == "__main__":
    main(*sys.argv[1:])

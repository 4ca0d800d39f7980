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
from sklearn.model_selection import GroupKFold, cross_val_predict

LAGS = (0, 5, 10, 20)
"""Samples before the starting point whose components are features, where washouts reach so far."""
FOLDS = 5
"""Groups of training series, each of which is left out once to choose the alarm threshold."""


def features(washouts):
    """Features of washouts, ``(points, lags * components)``."""
    reached = [lag for lag in LAGS if lag < washouts.shape[1]]
    return np.concatenate([washouts[:, -1 - lag] for lag in reached], axis=1)


def crosses(window, threshold):
    """Whether the observable is below the threshold at first, and reaches it later."""
    return window[0] < threshold <= window.max()


def examples(series, observable, washout, windows, threshold):
    """Starting points in training series: features, events in each window, and their series."""
    starts = np.arange(washout - 1, series.shape[1] - windows[-1][1], 2)
    found, outcomes, rows = [], [], []
    for row, (states, values) in enumerate(zip(series, observable, strict=True)):
        before = np.stack([values[at - washout + 1 : at + 1] for at in starts])
        quiet = starts[before.max(axis=1) < threshold]
        if not len(quiet):
            continue
        found.append(features(np.stack([states[at - washout + 1 : at + 1] for at in quiet])))
        for at in quiet:
            ahead = (values[at + first : at + last + 1] for first, last in windows)
            outcomes.append([crosses(one, threshold) for one in ahead])
            rows.append(row)
    return np.concatenate(found), np.array(outcomes), np.array(rows)


def classifier():
    """A classifier that has learnt nothing yet."""
    return HistGradientBoostingClassifier(
        max_iter=150,
        learning_rate=0.08,
        max_leaf_nodes=12,
        early_stopping=False,
        random_state=0,
    )


def best_threshold(inputs, outcomes, rows):
    """Alarm threshold with the best F-score, over all windows of training series left out."""
    options = {"groups": rows, "cv": GroupKFold(FOLDS), "method": "predict_proba"}
    told = [cross_val_predict(classifier(), inputs, one, **options)[:, 1] for one in outcomes.T]
    precision, recall, thresholds = precision_recall_curve(outcomes.T.ravel(), np.ravel(told))
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
    inputs, outcomes, rows = examples(series, observable, washouts.shape[1], windows, threshold)
    fitted = [classifier().fit(inputs, one) for one in outcomes.T]
    test = features(washouts)
    found = np.stack([one.predict_proba(test)[:, 1] for one in fitted], axis=1)
    with open(path, "w", encoding="utf-8") as file:
        print(first_line, "point,prediction_time_lt,probability", sep="\n", file=file)
        for point, row in enumerate(found):
            for time, probability in zip(times, row, strict=True):
                print(f"{point},{time:g},{probability:.6f}", file=file)
    print(f"alarm threshold {best_threshold(inputs, outcomes, rows):.3f}")


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Published percentiles in the form of the percentile tables.

Source: the results that Racca & Magri published with the paper (``resources/README.md``).
"""

import pandas as pd

_METRICS = {
    "mean_prediction_horizon": "mean_horizon_lt",
    "objective_log10_mse": "objective",
    "mle": "mean_log_error",
}

_TABLES = {
    "classification": "classification",
    "horizon": "horizon",
    "hyper": "hyperparameters",
    "statistics": "statistics",
}


def published_percentiles(published: pd.DataFrame, table: str) -> pd.DataFrame:
    """Select the published percentiles that belong to one of the percentile tables.

    Parameters
    ----------
    published
        Columns ``kind``, ``reynolds``, ``neurons``, ``validation``, ``prediction_time``,
        ``metric``, ``p25``, ``p50``, ``p75``. Rows with the validation ``TRAIN`` are the training
        set's own.
    table
        "classification", "horizon", "hyperparameters" or "statistics".

    Returns
    -------
    DataFrame
        Columns ``reynolds``, ``forecaster``, ``neurons``, ``validation``, ``prediction_time_lt``,
        ``metric``, ``p25``, ``p50``, ``p75``, with the names of our metrics.

    Raises
    ------
    ValueError
        If nothing is published for that table.
    """
    rows = published[published["kind"].map(_TABLES) == table]
    if rows.empty:
        raise ValueError(f"nothing is published for the table {table}")
    training = rows["validation"] == "TRAIN"
    return pd.DataFrame(
        {
            "reynolds": rows["reynolds"],
            "forecaster": training.map({True: "training", False: "esn"}),
            "neurons": rows["neurons"],
            "validation": rows["validation"].mask(training),
            "prediction_time_lt": rows["prediction_time"],
            "metric": rows["metric"].replace(_METRICS),
            **{name: rows[name] for name in ("p25", "p50", "p75")},
        }
    ).reset_index(drop=True)

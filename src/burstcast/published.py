"""Published percentiles in the form of the percentile tables.

Source: the results that Racca & Magri published with the paper (``resources/README.md``).
"""

import pandas as pd

_METRICS = {
    "mean_prediction_horizon": "mean_horizon_lt",
    "objective_log10_mse": "objective",
    "mle": "mean_log_error",
}

# The authors divide by the range of the mean velocity over half the channel, from the centre to a
# wall; ours is from wall to wall, 1.97 times as large. Other profiles have the same range in both.
_HALF_CHANNEL = 1.97
_IN_OUR_DEFINITION = {"nrmse_u": 1 / _HALF_CHANNEL}

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
        ``metric``, ``p25``, ``p50``, ``p75``, with the names of our metrics and in our
        definitions: the error of the mean velocity is normalised by its range from wall to wall.

    Raises
    ------
    ValueError
        If nothing is published for that table.
    """
    rows = published[published["kind"].map(_TABLES) == table]
    if rows.empty:
        raise ValueError(f"nothing is published for the table {table}")
    training = rows["validation"] == "TRAIN"
    factor = rows["metric"].map(_IN_OUR_DEFINITION).fillna(1.0)
    return pd.DataFrame(
        {
            "reynolds": rows["reynolds"],
            "forecaster": training.map({True: "training", False: "esn"}),
            "neurons": rows["neurons"],
            "validation": rows["validation"].mask(training),
            "prediction_time_lt": rows["prediction_time"],
            "metric": rows["metric"].replace(_METRICS),
            **{name: rows[name] * factor for name in ("p25", "p50", "p75")},
        }
    ).reset_index(drop=True)

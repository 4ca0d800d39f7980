"""Published percentiles in the form of our percentile tables, and comparisons with ours.

Source: the results that Racca & Magri published with the paper (``resources/README.md``). What
they define otherwise than we do is converted or left out here, and nowhere else.
"""

from collections.abc import Mapping

import pandas as pd

_TABLES = {
    "classification": "classification",
    "horizon": "horizon",
    "hyper": "hyperparameters",
    "statistics": "statistics",
    "control": "control",
}
_METRICS = {
    "mean_prediction_horizon": "mean_horizon_lt",
    "objective_log10_mse": "objective",
    "mle": "mean_log_error",
    "exceedance_probability": "exceedance_controlled",
}

# The authors divide by the range of the mean velocity over half the channel, from the centre to a
# wall; ours is from wall to wall, 1.97 times as large. Other profiles have the same range in both.
_HALF_CHANNEL = 1.97
# They add up bins of the density whose centre lies above the threshold, and so count the whole of
# the bin that holds it; we count steps. (1.2 to 1.8 %, more where less is left.)
_FROM_BIN_CENTRES = 1.02
_IN_OUR_DEFINITION = {"nrmse_u": 1 / _HALF_CHANNEL, "exceedance_controlled": 1 / _FROM_BIN_CENTRES}
# They divide inputs by the range of the first training series, we by the range of all ten, which is
# about 1.45 times as large, by a factor that depends on the component and the choice of the series.
_NOT_COMPARABLE = ("input_scaling",)

_KEYS = ["reynolds", "forecaster", "neurons", "validation", "prediction_time_lt", "metric"]
_NUMBERS = ["reynolds", "neurons", "prediction_time_lt"]
_PERCENTILES = ["p25", "p50", "p75"]


def published_percentiles(published: pd.DataFrame, table: str) -> pd.DataFrame:
    """Published percentiles that belong to one of our percentile tables, in our definitions.

    ``published``: Columns ``kind``, ``reynolds``, ``neurons``, ``validation``, ``prediction_time``,
    ``metric``, ``p25``, ``p50``, ``p75``; rows with the validation ``TRAIN`` are the training set's
    own. ``table``: "classification", "horizon", "hyperparameters", "statistics" or "control".
    Input scalings are left out. Classification is as it was published: with the paper's washout in
    place of the authors' fewer starting points are left out.
    """
    rows = published[published["kind"].map(_TABLES) == table]
    if rows.empty:
        raise ValueError(f"nothing is published for the table {table}")
    training = rows["validation"] == "TRAIN"
    metric = rows["metric"].replace(_METRICS)
    factor = metric.map(_IN_OUR_DEFINITION).fillna(1.0)
    converted = pd.DataFrame(
        {
            "reynolds": rows["reynolds"],
            "forecaster": training.map({True: "training", False: "esn"}),
            "neurons": rows["neurons"],
            "validation": rows["validation"].mask(training),
            "prediction_time_lt": rows["prediction_time"],
            "metric": metric,
            **{name: rows[name] * factor for name in _PERCENTILES},
        }
    )
    return converted[~metric.isin(_NOT_COMPARABLE)].reset_index(drop=True)


def published_beside(
    ours: pd.DataFrame, published: pd.DataFrame | None, table: str
) -> pd.DataFrame:
    """Published percentiles at the Reynolds numbers of one of our tables; none if none are wanted.

    ``ours``: Our table; without the column ``reynolds``, nothing can stand beside it.
    """
    if published is None or "reynolds" not in ours:  # as of a system without one
        return ours.iloc[:0]
    values = published_percentiles(published, table)
    return values[values["reynolds"].isin(ours["reynolds"])]


def published_reductions(exceedances: pd.DataFrame, ours: pd.DataFrame) -> pd.DataFrame:
    """Published exceedances with control as reductions, of ours without control.

    How much of the exceedance there was without control is not published. Returns the rows that we
    have as well: one minus the published exceedance over the median of ours without control.
    """
    keys = ["forecaster", "neurons", "validation", "prediction_time_lt"]
    without = ours[(ours["metric"] == "exceedance_uncontrolled") & (ours["p50"] > 0)]
    rows = exceedances.merge(
        without[[*keys, "p50"]].rename(columns={"p50": "uncontrolled"}), on=keys
    )
    left = {name: rows[name] / rows["uncontrolled"] for name in _PERCENTILES}
    return rows.drop(columns="uncontrolled").assign(
        metric="reduction", p25=1 - left["p75"], p50=1 - left["p50"], p75=1 - left["p25"]
    )


def compare(
    published: pd.DataFrame,
    percentiles: Mapping[str, pd.DataFrame],
    intervals: Mapping[str, pd.DataFrame],
) -> pd.DataFrame:
    """Our value beside each published value, and whether they agree.

    ``percentiles``: Our percentile tables by name; others than the published are ignored.
    ``intervals``: Bootstrap intervals of single networks under the same names, where there are any:
    the same keys, ``seed``, ``low``, ``high``. Returns a row for each published value and each of
    our cases with the same Reynolds number: its keys, ``published_p25``, ``published_p50``,
    ``published_p75``, our ``p25``, ``p50``, ``p75`` over ``networks``, and ``low`` and ``high``,
    each end the median over the networks of the bootstrap interval of one network.

    ``inside`` says that the published median lies in our bootstrap interval, or between our
    quartiles where these are of two networks or more: it is no farther from ours than another test
    set, or other seeds, would move ours. Missing where there is neither. It knows nothing of the
    paper's own sampling error, which is as large as ours, nor of another choice of training series:
    were there no difference but these, a sixth or so of all published values would still lie
    outside, many of them together, since all networks and prediction times share one test set.
    """
    parts = [
        _compared(name, published_percentiles(published, name), percentiles[name], intervals)
        for name in published["kind"].map(_TABLES).dropna().unique()
        if name in percentiles
    ]
    columns = ["kind", "case", *_KEYS, *(f"published_{name}" for name in _PERCENTILES)]
    columns += [*_PERCENTILES, "networks", "low", "high", "inside"]
    return pd.concat(parts, ignore_index=True)[columns] if parts else pd.DataFrame(columns=columns)


def _compared(
    name: str, theirs: pd.DataFrame, ours: pd.DataFrame, intervals: Mapping[str, pd.DataFrame]
) -> pd.DataFrame:
    theirs = theirs.rename(columns={column: f"published_{column}" for column in _PERCENTILES})
    rows = _with_keys(theirs).merge(_with_keys(ours)[["case", *_KEYS, *_PERCENTILES, "networks"]])
    if name in intervals:
        single = _with_keys(intervals[name]).groupby(["case", *_KEYS], dropna=False)
        rows = rows.merge(single[["low", "high"]].median().reset_index(), how="left")
    else:
        rows = rows.assign(low=float("nan"), high=float("nan"))
    several = rows["networks"] > 1
    value = rows["published_p50"]
    inside = value.between(rows["low"], rows["high"])
    inside |= several & value.between(rows["p25"], rows["p75"])
    decided = rows["low"].notna() | (several & rows["p50"].notna())
    return rows.assign(kind=name, inside=inside.astype("boolean").where(decided))


def _with_keys(table: pd.DataFrame) -> pd.DataFrame:
    """All keys, of types that can be compared; prediction times equal but for rounding are one."""
    if "prediction_time_lt" not in table:
        table = table.assign(prediction_time_lt=float("nan"))
    numbers = {name: table[name].astype("float64").round(9) for name in _NUMBERS}
    return table.assign(**numbers, validation=table["validation"].astype("string"))


def intervals_of_control(strategies: pd.DataFrame, control: pd.DataFrame) -> pd.DataFrame:
    """Bootstrap intervals of the exceedance under the paper's control.

    The paper's strategy may have been run under other conditions, too: of its runs in
    ``strategies`` (``control_strategies.csv``), those are meant that ``control`` (``control.csv``)
    has with the same value.
    """
    metric = "exceedance_controlled"
    ours = strategies[
        (strategies["strategy"] == "prediction_triggered") & (strategies["metric"] == metric)
    ]
    keys = ["case", "forecaster", "neurons", "validation", "seed", "prediction_time_lt"]
    both = _with_keys(ours).merge(_with_keys(control)[[*keys, metric]], on=keys)
    same = (both["value"] - both[metric]).abs() <= 1e-9 * both[metric].abs()
    columns = ["case", *_KEYS[:4], "seed", *_KEYS[4:], "low", "high"]
    return both.loc[same, columns].drop_duplicates(ignore_index=True)

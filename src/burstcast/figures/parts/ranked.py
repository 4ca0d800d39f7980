"""Rows of the table ``ranking`` as people are shown them."""

from dataclasses import replace

import pandas as pd

from burstcast.base.names import parsed
from burstcast.forecasts.points import BASELINES
from burstcast.forecasts.scores import PRECURSOR

SAME_EVERYWHERE = (*BASELINES, PRECURSOR)
"""Alarms that are the same in all cases of a flow."""


def shown_once(ranking: pd.DataFrame) -> pd.DataFrame:
    """Rows with committees of networks in place of their members, and common alarms once.

    ``ranking``: Rows of one event and one metric. Members of a filter's or of analogues' ensembles,
    which rank as their forecaster does, are left out. A network without a committee stands for
    itself.
    """
    there = set(zip(ranking["case"], ranking["alarm"], strict=True))
    shown = []
    for case, alarm in zip(ranking["case"], ranking["alarm"], strict=True):
        name = parsed(alarm)
        committee = replace(name, seed=None, role="committee").identifier
        is_member = name.seed is not None and (case, committee) in there
        shown.append(not is_member and (name.role is None or name.neurons is not None))
    rows = ranking[shown]
    again = rows["alarm"].isin(SAME_EVERYWHERE) & rows.duplicated(["alarm", "prediction_time_lt"])
    return rows[~again]

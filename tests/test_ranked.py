"""Rows of the table ranking as people are shown them, chosen by hand."""

import pandas as pd

from burstcast.tables.ranked import shown_once


def test_committees_stand_for_their_members_and_common_alarms_are_shown_once():
    alarms = {
        "flow": ["equations", "observable_now", "published_precursor"],
        "modes": [
            *("analogues", "analogues-committee", "climatology", "observable_now"),
            *("esn-N50-RV-seed0", "esn-N50-RV-seed1", "esn-N50-RV-committee"),
            *("esn-N90-RV-seed0", "esn-N50-SSV-seed0"),
        ],
    }
    rows = pd.DataFrame(
        [
            {"case": case, "alarm": alarm, "prediction_time_lt": time}
            for case, names in alarms.items()
            for alarm in names
            for time in (0.5, 1.0)
        ]
    )
    shown = shown_once(rows)
    # at each prediction time
    for _, part in shown.groupby("prediction_time_lt"):
        assert list(zip(part["case"], part["alarm"], strict=True)) == [
            *(("flow", alarm) for alarm in alarms["flow"]),
            ("modes", "analogues"),
            ("modes", "climatology"),
            ("modes", "esn-N50-RV-committee"),
            ("modes", "esn-N90-RV-seed0"),
            ("modes", "esn-N50-SSV-seed0"),
        ]
